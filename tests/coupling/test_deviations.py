"""What differs from the plan is told, and nothing else."""

from __future__ import annotations

import json
import math

import msgspec
import numpy as np
import pytest
from tests.coupling.plans import MAP, PRIOR, all_pairs, seen

from situgraph.coupling.association import associate_planes
from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.lines import WallLines
from situgraph.coupling.located import Located, locate
from situgraph.coupling.openings import Missed
from situgraph.scenegraph.graph import Ellipsoid, Object, Plane, SceneGraph
from situgraph.scenegraph.transform import transformed

CONFIG = CouplingConfig(plane_sigma=0.01, plane_angle_sigma=0.003)
LINES = WallLines(PRIOR)


def located(online: SceneGraph, prior: SceneGraph = PRIOR, missed: Missed | None = None) -> Located:
    pairs = all_pairs(online)
    known = {r.id for r in prior.rooms}, {p.id for p in prior.planes}, {o.id for o in prior.objects}
    pairs = type(pairs)(
        pairs.placement,
        {k: v for k, v in pairs.rooms.items() if v in known[0]},
        {k: v for k, v in pairs.planes.items() if v in known[1]},
        {k: v for k, v in pairs.objects.items() if v in known[2]},
        pairs.storeys,
    )
    return locate(online, prior, pairs, missed=missed, config=CONFIG)


def test_a_building_as_planned_has_none() -> None:
    assert located(seen(PRIOR)).deviations == ()


def test_a_door_that_is_not_there_is_told() -> None:
    online = seen(PRIOR)
    less = online.replace(objects=tuple(o for o in online.objects if o.id != "o3"))
    (found,) = located(less).deviations
    assert (found.kind, found.category, found.prior) == ("missing-object", "door", "o3")


@pytest.mark.parametrize(("images", "told"), [(0, False), (2, False), (3, True)])
def test_what_no_image_should_have_shown_is_not_missing(images: int, told: bool) -> None:
    online, asked = seen(PRIOR), []
    less = online.replace(objects=tuple(o for o in online.objects if o.id != "o3"))

    def missed(category: str, place: np.ndarray, normal: np.ndarray, half: float) -> int:
        asked.append((category, place, half))
        return images

    found = located(less, missed=missed).deviations
    assert [d.prior for d in found] == ["o3"] * told
    category, place, half = asked[0]
    there = next(o for o in online.objects if o.id == "o3")
    assert category == "door"
    assert np.allclose(place, there.center, atol=0.02)
    assert half == pytest.approx(there.ellipsoid.axes[0], abs=0.01)


def test_a_door_that_was_seen_too_seldom_is_not_extra() -> None:
    prior = PRIOR.replace(objects=tuple(o for o in PRIOR.objects if o.id != "o3"))
    for often, told in ((2, False), (3, True)):
        online = seen(PRIOR)
        objects = tuple(
            msgspec.structs.replace(o, attributes={"seen": often}) for o in online.objects
        )
        assert bool(located(online.replace(objects=objects), prior).deviations) is told


@pytest.mark.parametrize(("confidence", "told"), [(0.75, False), (0.85, True), (None, True)])
@pytest.mark.parametrize("kind", ["extra-object", "moved-object"])
def test_a_door_that_was_seen_unsurely_is_not_told(
    kind: str, confidence: float | None, told: bool
) -> None:
    """A detector takes a piece of wall for a door in three of four images."""
    online, prior, shift = seen(PRIOR), PRIOR, np.zeros(3)
    if kind == "extra-object":
        prior = PRIOR.replace(objects=tuple(o for o in PRIOR.objects if o.id != "o3"))
    else:
        shift = MAP.inverse().vectors([0.0, 0.7, 0.0])
    objects = tuple(
        msgspec.structs.replace(
            o, confidence=confidence, center=tuple((np.array(o.center) + shift).tolist())
        )
        if o.id == "o3"
        else o
        for o in online.objects
    )
    found = located(online.replace(objects=objects), prior).deviations
    assert [d.kind for d in found] == [kind] * told


def test_the_door_at_the_place_is_the_planned_one_whatever_the_match_says() -> None:
    online = seen(PRIOR)
    door = online.object_by_id["o3"]
    shift = MAP.inverse().vectors([0.0, 0.7, 0.0])
    beside = msgspec.structs.replace(
        door, id="beside", center=tuple((np.array(door.center) + shift).tolist()), confidence=0.6
    )
    both = online.replace(objects=(*online.objects, beside))
    pairs = all_pairs(online)
    wrong = type(pairs)(
        pairs.placement, pairs.rooms, pairs.planes,
        {k: v for k, v in pairs.objects.items() if k != "o3"} | {"beside": "o3"}, pairs.storeys,
    )  # fmt: skip
    assert locate(both, PRIOR, wrong, config=CONFIG).deviations == ()


def test_a_door_of_the_next_face_in_a_wall_is_the_planned_one() -> None:
    """Seen beyond the end of a face in one line with its own, which was not seen."""
    door = next(o for o in PRIOR.objects if o.category == "door")
    (mine, *_) = door.planes
    line = [p for p in PRIOR.planes if LINES.of(p.id) == LINES.of(mine) and p.id not in door.planes]
    other = line[0].id
    online = seen(PRIOR)
    objects = tuple(
        msgspec.structs.replace(o, planes=(other,)) if o.id == door.id else o
        for o in online.objects
    )
    pairs = all_pairs(online)
    less = type(pairs)(pairs.placement, pairs.rooms, pairs.planes, {}, pairs.storeys)
    assert locate(online.replace(objects=objects), PRIOR, less, config=CONFIG).deviations == ()


@pytest.mark.parametrize(("narrow", "by", "told"), [(0.5, 0.5, False), (0.5, 0.9, True)])
def test_half_a_door_is_not_a_door_that_was_moved(narrow: float, by: float, told: bool) -> None:
    online = seen(PRIOR)
    shift = MAP.inverse().vectors([0.0, by, 0.0])
    objects = tuple(
        msgspec.structs.replace(
            o,
            center=tuple(a + float(b) for a, b in zip(o.center, shift)),
            ellipsoid=msgspec.structs.replace(
                o.ellipsoid, axes=(narrow * o.ellipsoid.axes[0], *o.ellipsoid.axes[1:])
            ),
        )
        if o.id == "o3"
        else o
        for o in online.objects
    )
    found = located(online.replace(objects=objects)).deviations
    assert [d.kind for d in found] == ["moved-object"] * told


@pytest.mark.parametrize(("by", "told"), [(-0.13, False), (0.13, True), (-0.35, True)])
def test_panes_and_shut_doors_in_a_face_are_not_its_wall(by: float, told: bool) -> None:
    """A glass front: its panes stand 0.1 m behind the wall's face, which is hardly seen."""
    face = next(p for p in PRIOR.planes if p.id == "p0")
    (ax, ay), (bx, by_) = face.extent
    front = Object(
        "front", "window", ((ax + bx) / 2, (ay + by_) / 2, 1.0), None, ("r1",), (face.id,)
    )
    n = np.array(face.normal)
    length = float(np.hypot(bx - ax, by_ - ay))
    yaw = math.atan2(n[1], n[0]) - math.pi / 2
    front = msgspec.structs.replace(
        front,
        center=tuple(float(v) for v in np.array(front.center) - 0.1 * n),
        ellipsoid=Ellipsoid((0.4 * length, 0.1, 1.0), (0, 0, math.sin(yaw / 2), math.cos(yaw / 2))),
    )
    prior = PRIOR.replace(objects=(*PRIOR.objects, front))
    online = seen(prior, {face.id: by})
    found = [d.prior for d in located(online, prior).deviations]
    assert found == [face.id] * told


def test_a_door_that_was_not_planned_is_told() -> None:
    prior = PRIOR.replace(objects=tuple(o for o in PRIOR.objects if o.id != "o3"))
    (found,) = located(seen(PRIOR), prior).deviations
    assert (found.kind, found.category, found.online) == ("extra-object", "door", "o3")


def test_a_door_beside_its_place_is_moved() -> None:
    online = seen(PRIOR)
    # Along the wall between rooms 1 and 4, which runs along y in the building.
    shift = MAP.inverse().vectors([0.0, 0.7, 0.0])
    moved = tuple(
        msgspec.structs.replace(o, center=tuple(a + float(b) for a, b in zip(o.center, shift)))
        if o.id == "o3"
        else o
        for o in online.objects
    )
    (found,) = located(online.replace(objects=moved)).deviations
    assert (found.kind, found.prior, found.online) == ("moved-object", "o3", "o3")
    assert abs(found.offset or 0.0) == pytest.approx(0.7, abs=0.02)


def run_together(online: SceneGraph, faces: set[str]) -> SceneGraph:
    """Rooms 1 and 4 as one, without the faces between them."""
    inside = [transformed_footprint(r, online) for r in ("r1", "r4")]
    (x0, y0), (x1, y1) = inside[0][0], inside[1][2]
    outline = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    back = MAP.inverse()
    rooms = tuple(
        msgspec.structs.replace(
            r,
            planes=tuple(p for p in r.planes if p not in faces),
            footprint=tuple((float(x), float(y)) for x, y in back.points(outline)),
        )
        if r.id in ("r1", "r4")
        else r
        for r in online.rooms
    )
    objects = tuple(o for o in online.objects if not faces & set(o.planes))
    planes = tuple(p for p in online.planes if p.id not in faces)
    return online.replace(rooms=rooms, planes=planes, objects=objects)


def test_a_wall_that_is_not_there_is_told() -> None:
    """Rooms 1 and 4 are one: no wall between them, one outline."""
    faces = {"p1", "p15"}  # east of room 1, west of room 4
    built = run_together(seen(PRIOR), faces)
    found = {d.prior for d in located(built).deviations if d.kind == "missing-wall"}
    assert found == faces


def test_a_wall_that_is_all_door_is_not_missed() -> None:
    """Rooms 1 and 4 ran together where a door as wide as the wall was planned."""
    faces = {"p1", "p15"}
    (ax, ay), (bx, by) = PRIOR.plane_by_id["p1"].extent
    half = math.dist((ax, ay), (bx, by)) / 2 - 0.1
    wide = tuple(
        msgspec.structs.replace(
            o,
            center=((ax + bx) / 2, (ay + by) / 2, o.center[2]),
            ellipsoid=msgspec.structs.replace(o.ellipsoid, axes=(half, *o.ellipsoid.axes[1:])),
        )
        if faces <= set(o.planes)
        else o
        for o in PRIOR.objects
    )
    assert wide != PRIOR.objects
    built = run_together(seen(PRIOR), faces)
    assert {d.prior for d in located(built).deviations if d.kind == "missing-wall"} == faces
    told = located(built, PRIOR.replace(objects=wide)).deviations
    assert not [d for d in told if d.kind == "missing-wall"]


def transformed_footprint(name: str, online: SceneGraph) -> list[tuple[float, float]]:
    return list(transformed(online, MAP).room_by_id[name].footprint or ())


@pytest.mark.parametrize(("length", "told"), [(None, True), (4.0, True), (1.8, False), (3.0, True)])
def test_a_wall_that_was_not_planned_is_told(length: float | None, told: bool) -> None:
    """Unless it is two pieces that may be door leaves."""
    online = seen(PRIOR)
    new = transformed(
        SceneGraph(planes=(Plane("new", (0.0, 1.0, 0.0), -2.0, ((1.0, 2.0), (5.0, 2.0))),)),
        MAP.inverse(),
    ).planes[0]
    rooms = tuple(
        msgspec.structs.replace(r, planes=(*r.planes, "new")) if r.id == "r1" else r
        for r in online.rooms
    )
    if length is not None:
        new = msgspec.structs.replace(new, attributes={"length": length})
    found = located(online.replace(rooms=rooms, planes=(*online.planes, new))).deviations
    assert [(d.kind, d.online, d.rooms) for d in found] == [("extra-wall", "new", ("r1",))] * told


@pytest.mark.parametrize(("length", "told"), [(1.0, False), (1.6, True)])
def test_the_open_leaf_of_a_planned_door_is_no_wall(length: float, told: bool) -> None:
    """It hangs at the side of the door between rooms 1 and 4, which lies along y."""
    online, door = seen(PRIOR), PRIOR.object_by_id["o3"]
    x, y = door.center[0] - 0.1, door.center[1] - door.ellipsoid.axes[0]
    ends = ((x, y), (x - length, y - 0.1 * length))
    n = np.array([-0.1, 1.0]) / math.hypot(0.1, 1.0)
    leaf = Plane("leaf", (*n.tolist(), 0.0), -float(n @ (x, y)), ends)
    leaf = transformed(SceneGraph(planes=(leaf,)), MAP.inverse()).planes[0]
    rooms = tuple(
        msgspec.structs.replace(r, planes=(*r.planes, "leaf")) if r.id == "r1" else r
        for r in online.rooms
    )
    found = located(online.replace(rooms=rooms, planes=(*online.planes, leaf))).deviations
    assert [(d.kind, d.online) for d in found] == [("extra-wall", "leaf")] * told


def test_later_rooms_and_walls_are_associated_by_their_place() -> None:
    online = seen(PRIOR)
    first = all_pairs(online)
    only = type(first)(
        first.placement,
        {"r1": "r1"},
        {p: p for p in PRIOR.room_by_id["r1"].planes},
        {},
        first.storeys,
    )
    found = locate(online, PRIOR, only, config=CONFIG)
    assert dict(found.rooms) == {r.id: r.id for r in PRIOR.rooms}
    assert {(p.id, p.id) for p in PRIOR.planes} <= set(found.planes)


@pytest.mark.parametrize("by", [0.2, -0.3, 0.41])
def test_all_planes_of_a_moved_wall_are_its_face(by: float) -> None:
    face = PRIOR.room_by_id["r1"].planes[0]
    online = seen(PRIOR, {face: by})
    wall = online.plane_by_id[face]
    pairs = all_pairs(online)
    nearer = 0.01 if by > 0 else -0.01
    for name, apart, same in (("half", nearer, True), ("pane", -0.1, False)):
        further = msgspec.structs.replace(wall, id=name, offset=wall.offset + apart)
        more = online.replace(planes=(*online.planes, further))
        found = associate_planes(more, PRIOR, MAP, pairs.storeys, {}, CONFIG)
        assert (face, face) in found
        assert ((name, face) in found) is same


@pytest.mark.parametrize(("behind", "counts"), [(0.13, False), (0.0, True)])
def test_a_shut_door_or_a_pane_is_not_its_wall(behind: float, counts: bool) -> None:
    """The leaf of a shut door in the depth of the wall, of which nothing else was seen."""
    door = next(o for o in PRIOR.objects if o.category == "door")
    face = PRIOR.plane_by_id[door.planes[0]]
    n = np.array([face.normal[0], face.normal[1]])
    along = np.array([-n[1], n[0]])
    foot = (door.center[:2] @ along) * along - (face.offset + behind) * n
    ends = tuple(tuple((foot + k * along).tolist()) for k in (-0.4, 0.4))
    leaf = Plane("leaf", face.normal, face.offset + behind, ends)
    online = seen(instead(PRIOR, face.id, leaf))
    pairs = all_pairs(online)
    for matched in ({}, {"leaf": face.id}):
        found = associate_planes(online, PRIOR, MAP, pairs.storeys, matched, CONFIG)
        assert (("leaf", face.id) in found) is counts


@pytest.mark.parametrize(
    ("share", "off", "counts"), [(0.3, 0.2, False), (0.3, 0.02, True), (0.7, 0.2, True)]
)
def test_a_piece_before_a_wall_is_a_thing(share: float, off: float, counts: bool) -> None:
    """What bounds no room and is much shorter than the face that was planned behind it."""
    face = PRIOR.plane_by_id["p0"]
    (ax, ay), (bx, by) = face.extent
    ends = ((ax, ay), (ax + share * (bx - ax), ay + share * (by - ay)))
    piece = Plane("piece", face.normal, face.offset - off, ends)
    online = seen(instead(PRIOR, "p0", piece))
    pairs = all_pairs(online)
    found = associate_planes(online, PRIOR, MAP, pairs.storeys, {}, CONFIG)
    assert (("piece", "p0") in found) is counts


def instead(graph: SceneGraph, name: str, plane: Plane) -> SceneGraph:
    """The graph with another plane, which bounds no room, in place of one."""
    change = msgspec.structs.replace
    rest = lambda planes: tuple(p for p in planes if p != name)  # noqa: E731
    return graph.replace(
        planes=(*(p for p in graph.planes if p.id != name), plane),
        rooms=tuple(change(r, planes=rest(r.planes)) for r in graph.rooms),
        objects=tuple(change(o, planes=rest(o.planes)) for o in graph.objects),
    )


def test_a_leaf_askew_before_a_wall_is_not_its_surface() -> None:
    """Its line crosses that of the wall in the wall's middle, where the leaf is not."""
    face = PRIOR.plane_by_id["p0"]
    (ax, ay), (bx, by) = face.extent
    middle, n = np.array([(ax + bx) / 2, (ay + by) / 2]), np.array(face.normal[:2])
    along = np.array([bx - ax, by - ay]) / math.dist((ax, ay), (bx, by))
    turned = math.cos(0.05) * n + math.sin(0.05) * along
    across = np.array([turned[1], -turned[0]])
    ends = tuple(tuple((middle + k * across).tolist()) for k in (1.5, 2.7))
    leaf = Plane("leaf", (*turned.tolist(), 0.0), -float(turned @ middle), ends)
    online = seen(PRIOR.replace(planes=(*PRIOR.planes, leaf)))
    pairs = all_pairs(online)
    matched = {p.id: p.id for p in PRIOR.planes}
    found = associate_planes(online, PRIOR, MAP, pairs.storeys, matched, CONFIG)
    assert [pair for pair in found if pair[0] == "leaf"] == []


def test_no_wall_stands_where_a_face_is_virtual() -> None:
    face = PRIOR.room_by_id["r1"].planes[0]
    planes = tuple(
        msgspec.structs.replace(p, virtual=True) if p.id == face else p for p in PRIOR.planes
    )
    online = seen(PRIOR, {face: 0.1})
    pairs = all_pairs(online)
    plan = PRIOR.replace(planes=planes)
    found = associate_planes(online, plan, MAP, pairs.storeys, {face: face}, CONFIG)
    assert face not in {planned for _, planned in found}


def test_the_answer_is_strict_json() -> None:
    document = located(seen(PRIOR, {"p5": 0.2})).to_dict()
    again = json.loads(json.dumps(document, allow_nan=False))
    assert again["format"] == "situgraph/located"
    assert [d["prior"] for d in again["deviations"]] == ["p5"]
