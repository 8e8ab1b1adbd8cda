"""Symmetric layouts are what they claim to be, and broken ones are not."""

from __future__ import annotations

import math
import typing
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement
from situgraph.plan.layout_changes import Change, break_symmetry
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.mirror import mirrored
from situgraph.scenegraph.transform import transformed
from situgraph.scenegraph.validation import validate

KINDS = typing.get_args(Kind)


def half_turned(graph: SceneGraph) -> SceneGraph:
    """The graph turned by 180 degrees about the middle of its footprints."""
    corners = np.concatenate([np.array(r.footprint) for r in graph.rooms])
    x, y = corners.min(axis=0) + corners.max(axis=0)
    return transformed(graph, Placement(float(x), float(y), 0.0, math.pi))


def described(graph: SceneGraph) -> Counter[tuple[object, ...]]:
    """All a graph says but ids, rounded to a hundredth of a millimetre."""

    def near(values: typing.Iterable[float]) -> tuple[float, ...]:
        return tuple(round(v, 5) + 0.0 for v in values)

    def room(name: str) -> tuple[float, ...]:
        return near(graph.room_by_id[name].center)

    def plane(name: str) -> tuple[float, ...]:
        p = graph.plane_by_id[name]
        assert p.extent is not None
        return near((*p.normal, p.offset, *p.extent[0], *p.extent[1]))

    rooms = [("room", room(r.id), tuple(sorted(plane(p) for p in r.planes))) for r in graph.rooms]
    objects = [
        (
            o.category,
            near(o.center),
            near(o.ellipsoid.axes) if o.ellipsoid else (),
            tuple(sorted(room(r) for r in o.rooms)),
            tuple(sorted(plane(p) for p in o.planes)),
        )
        for o in graph.objects
    ]
    return Counter([*rooms, *objects])


symmetric = st.builds(
    make_layout,
    kind=st.sampled_from(KINDS),
    rooms=st.integers(1, 30).map(lambda n: n * 2),
    seed=st.integers(0, 5000),
    symmetry=st.just("global"),
    object_density=st.none() | st.floats(0.0, 0.7),
    frame=st.just(Placement()),
)
odd = st.builds(
    make_layout,
    kind=st.sampled_from([k for k in KINDS if k != "storeys"]),
    rooms=st.integers(0, 15).map(lambda n: n * 2 + 1),
    seed=st.integers(0, 5000),
    symmetry=st.just("global"),
    frame=st.just(Placement()),
)


@given(symmetric | odd)
@settings(max_examples=80)
def test_global_symmetry_maps_geometry_and_objects_onto_themselves(graph: SceneGraph) -> None:
    assert described(half_turned(graph)) == described(graph)


@given(st.sampled_from(KINDS), st.integers(0, 200))
@settings(max_examples=20)
def test_no_symmetry_is_none(kind: Kind, seed: int) -> None:
    graph = make_layout(kind, 12, seed, frame=Placement())
    assert described(half_turned(graph)) != described(graph)


@given(symmetric, st.integers(0, 100), st.sampled_from(["object", "wall"]))
@settings(max_examples=40)
def test_symmetry_can_be_broken(graph: SceneGraph, seed: int, change: Change) -> None:
    try:
        broken = break_symmetry(graph, seed, change)
    except InputError:
        assert not graph.objects
        return
    assert validate(broken, "broken") == broken
    assert described(half_turned(broken)) != described(broken)


def arrangement(graph: SceneGraph, room_id: str, turn: int) -> Counter[tuple[object, ...]]:
    """The objects of a rectangular room in its own frame: fractions along its longer walls."""
    room = graph.room_by_id[room_id]
    assert room.footprint is not None
    corners = np.array(room.footprint)
    south, east = np.linalg.norm(np.diff(corners[:3], axis=0), axis=1)
    longer = int(east > south + 1e-6)
    order = np.roll(np.arange(4), -(longer + turn))
    a, b, _, d = corners[order]
    u, v = b - a, d - a
    found = []
    for item in graph.objects_by_room.get(room_id, ()):
        away = np.array(item.center[:2]) - a
        x, y = float(away @ u / (u @ u)), float(away @ v / (v @ v))
        walls = [order.tolist().index(room.planes.index(p)) for p in item.planes]
        # Objects on a wall keep their distance from it, which is no fraction of the room.
        if walls:
            x, y = (round(x, 6), -1.0) if walls[0] % 2 == 0 else (-1.0, round(y, 6))
        found.append((item.category, round(x, 6), round(y, 6), tuple(walls)))
    return Counter(found)


@given(
    st.sampled_from(["random", "modular", "grid", "corridor", "storeys"]),
    st.integers(2, 20),
    st.integers(0, 500),
    st.sampled_from([None, 0.2, 0.5]),
)
@settings(max_examples=30)
def test_local_symmetry_is_the_same_arrangement_in_every_room_and_its_own_half_turn(
    kind: Kind, rooms: int, seed: int, density: float | None
) -> None:
    graph = make_layout(kind, rooms, seed, "local", density)
    first = arrangement(graph, graph.rooms[0].id, 0)
    assert sum(first.values()) >= 1
    for room in graph.rooms:
        assert arrangement(graph, room.id, 0) == first
        assert arrangement(graph, room.id, 2) == first


def test_mirror_images_are_buildings_of_the_other_hand() -> None:
    graph = make_layout("lshaped", 20, seed=3)
    image = mirrored(graph)
    assert validate(image, "mirror") == image
    for room in image.rooms:
        polygon = Polygon(room.footprint)
        assert polygon.exterior.is_ccw
        assert room.footprint is not None
        for k, plane_id in enumerate(room.planes):
            extent = image.plane_by_id[plane_id].extent
            assert extent is not None
            assert extent[0] == room.footprint[k]
            assert extent[1] == room.footprint[(k + 1) % len(room.planes)]
    assert described(mirrored(image)) == described(graph)
    for yaw in np.linspace(-math.pi, math.pi, 8, endpoint=False):
        turned = transformed(graph, Placement(yaw=float(yaw)))
        assert described(turned) != described(image)


def test_mirrored_objects_keep_their_shape() -> None:
    graph = make_layout("random", 6, seed=3, frame=Placement(yaw=0.4))
    image = mirrored(graph)
    for before, after in zip(graph.objects, image.objects, strict=True):
        assert before.ellipsoid is not None
        assert after.ellipsoid is not None
        yaw = 2.0 * math.atan2(before.ellipsoid.rotation[2], before.ellipsoid.rotation[3])
        other = 2.0 * math.atan2(after.ellipsoid.rotation[2], after.ellipsoid.rotation[3])
        assert math.cos(2.0 * (other + yaw)) == pytest.approx(1.0)
