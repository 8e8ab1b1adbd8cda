from __future__ import annotations

import msgspec
import numpy as np
from tests.objects.world import two_rooms

from situgraph.geometry.poses import Placement
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.detections import Camera, Detection
from situgraph.objects.doorways import doorways
from situgraph.objects.gaps import WallGap, in_walls
from situgraph.objects.reconcile import backed, reconciled, without_leaves
from situgraph.objects.stage import ObjectStage, View
from situgraph.scenegraph.graph import Ellipsoid, Object, Plane, SceneGraph

ONCE = ObjectsConfig(min_seen=1, min_seen_roomless=1)
CAMERA = Camera(386.0, 386.0, 319.5, 239.5)
OPTICAL = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)
DOOR = ((4.0, 1.55, 0.0), (4.0, 2.45, 2.1))  # on the wall x = 4 of room a


class Painted:
    """Finds what the test painted red."""

    name = "painted"
    categories = frozenset({"door"})

    def detect(self, rgb, stamp):
        mask = rgb[..., 0] > 200
        return [Detection(mask, "door", 0.9)] if mask.any() else []


def view(key: str, x: float, y: float, yaw: float, blind: bool = False) -> View:
    """A camera at (x, y, 1) in room a that looks at the wall x = 4: depth and a painted door."""
    pose = Placement(x, y, 1.0, yaw).matrix()
    v, u = np.mgrid[:480, :640]
    rays = np.stack(
        [(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones(u.shape)], -1
    )
    world = rays @ (pose[:3, :3] @ OPTICAL[:3, :3]).T
    depth = (4.0 - x) / world[..., 0]
    hit = np.array([x, y, 1.0]) + depth[..., None] * world
    inside = np.all((hit > np.array(DOOR[0]) - 1e-6) & (hit < np.array(DOOR[1]) + 1e-6), axis=-1)
    rgb = np.zeros((480, 640, 3), np.uint8)
    if not blind:
        rgb[inside, 0] = 255
    depth = np.where(depth > 0, depth, 0).astype(np.float32)
    return View(key, 0.0, rgb, depth, CAMERA, pose, OPTICAL)


def test_a_door_seen_from_two_sides_is_one_object_with_both_rooms() -> None:
    stage = ObjectStage(Painted(), ONCE)
    assert stage.feed(view("k0", 1.5, 2.0, 0.0)) == 1
    assert stage.feed(view("k1", 1.8, 2.8, -0.3)) == 1
    (door,) = stage.annotated(two_rooms(), np.zeros((0, 3))).objects
    assert set(door.rooms) == {"a", "b"}
    assert set(door.planes) == {"a1", "b0"}
    assert np.allclose(door.center, (4.0, 2.0, 1.05), atol=0.15)


def test_the_passage_and_the_picture_of_a_door_are_one_object() -> None:
    stage = ObjectStage(Painted(), ONCE)
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    path = np.array([[2.0, 2.1, 0.5], [6.0, 2.1, 0.5]])
    (door,) = stage.annotated(two_rooms(), path).objects
    assert door.attributes["evidence"] == "vision,trajectory"
    assert np.allclose(door.center[:2], (4.1, 2.1))


def test_one_sighting_alone_is_no_object() -> None:
    stage = ObjectStage(Painted())
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    assert stage.annotated(two_rooms(), np.zeros((0, 3))).objects == ()
    stage.feed(view("k1", 1.5, 2.1, 0.0))
    assert len(stage.annotated(two_rooms(), np.zeros((0, 3))).objects) == 1


def test_a_gap_confirms_a_door_and_makes_none() -> None:
    gap = WallGap(np.array([[4.2, 2.4], [4.2, 1.6]]), 0.0)
    nowhere = np.zeros((0, 3))
    stage = ObjectStage(Painted())
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    assert stage.annotated(two_rooms(), nowhere, [gap]).objects == ()
    stage.feed(view("k1", 1.5, 2.1, 0.0))
    (bare,) = stage.annotated(two_rooms(), nowhere).objects
    (door,) = stage.annotated(two_rooms(), nowhere, [gap]).objects
    assert door.attributes["evidence"] == "vision,gap"
    assert msgspec.structs.replace(door, attributes=bare.attributes) == bare
    elsewhere = (
        WallGap(np.array([[1.0, 5.0], [2.0, 5.0]]), 0.0),  # another wall
        WallGap(np.array([[4.0, 4.0], [4.0, 5.0]]), 0.0),  # another place
        WallGap(np.array([[3.6, 2.0], [4.4, 2.0]]), 0.0),  # across the wall
        WallGap(np.array([[4.2, 2.4], [4.2, 1.6]]), 3.2),  # another storey
    )
    assert stage.annotated(two_rooms(), nowhere, elsewhere).objects == (bare,)


def test_a_door_seen_once_is_one_where_the_robot_passed() -> None:
    stage = ObjectStage(Painted())
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    gap = WallGap(np.array([[4.0, 1.6], [4.0, 2.4]]), 0.0)
    path = np.array([[2.0, 2.1, 0.5], [6.0, 2.1, 0.5]])
    (door,) = stage.annotated(two_rooms(), path, [gap]).objects
    assert door.attributes["evidence"] == "vision,trajectory,gap"


def test_a_passage_confirms_one_door() -> None:
    graph = two_rooms()
    (passage,) = doorways(np.array([[2.0, 2.1, 0.5], [6.0, 2.1, 0.5]]), graph)
    near, next_to_it = (
        Object(key, "door", (4.1, y, 1.0), rooms=("a", "b"), planes=("a1", "b0"))
        for key, y in (("o1", 2.2), ("o2", 2.7))
    )
    assert backed([near, next_to_it], [], [passage], graph, ONCE) == [near]
    assert backed([next_to_it], [near], [passage], graph, ONCE) == []
    assert backed([near], [next_to_it], [passage], graph, ONCE) == []


def test_an_extinguisher_flat_in_its_wall_is_a_picture_and_said_to_be_left_out() -> None:
    y, z = (v.ravel() for v in np.meshgrid(np.arange(1.0, 1.2, 0.04), np.arange(0.9, 1.5, 0.04)))
    for before, there in ((0.02, False), (0.16, True)):
        stage = ObjectStage(Painted())
        points = np.stack([np.full(y.size, 4.0 - before), y, z], axis=1)
        for key in ("k0", "k1"):
            seen = stage.map.observations({"extinguisher": [(0.9, points)]})
            stage.map.add(key, np.eye(4), seen, np.array([1.5, 1.5, 0.7]))
        graph = stage.annotated(two_rooms(), np.zeros((0, 3)))
        assert len(graph.objects) == there
        assert [w.code for w in graph.warnings] == ([] if there else ["object-flat"])
        assert stage.left_out == graph.warnings


def test_without_a_camera_doorways_are_still_found() -> None:
    stage = ObjectStage(None)
    assert stage.feed(view("k0", 1.5, 2.0, 0.0)) == 0
    (door,) = stage.annotated(two_rooms(), np.array([[2.0, 2, 0.5], [6.0, 2, 0.5]])).objects
    assert door.attributes["evidence"] == "trajectory"


def test_an_object_that_frames_should_show_and_do_not_fades() -> None:
    stage = ObjectStage(Painted(), ONCE)
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    for _ in range(8):
        stage.feed(view("k0", 1.5, 2.0, 0.0, blind=True))
    assert stage.annotated(two_rooms(), np.zeros((0, 3))).objects == ()


def test_looking_elsewhere_takes_nothing_away() -> None:
    stage = ObjectStage(Painted(), ONCE)
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    for _ in range(8):
        stage.feed(view("k1", 1.5, 2.0, 1.2, blind=True))
    assert len(stage.annotated(two_rooms(), np.zeros((0, 3))).objects) == 1


def test_objects_move_with_their_keyframes() -> None:
    stage = ObjectStage(Painted(), ONCE)
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    before = np.array(stage.map.objects()[0].center)
    shift = Placement(0.1, 0.3, 0.0, 0.0)
    stage.correct({"k0": shift.matrix() @ view("k0", 1.5, 2.0, 0.0).pose})
    assert np.allclose(stage.map.objects()[0].center, before + np.array([0.1, 0.3, 0.0]))


def test_a_leaf_at_rest_on_a_wall_across_belongs_to_the_passage_beside_it() -> None:
    graph = two_rooms()
    leaf = Object("o3", "door", (3.5, 0.0, 1.0), rooms=("a",), planes=("a2",), confidence=0.7)
    (passage,) = doorways(np.array([[3.0, 0.6, 0.5], [6.0, 0.6, 0.5]]), graph)
    (door,) = reconciled([leaf], [passage], graph, ONCE)
    assert (door.id, set(door.planes)) == ("o3", {"a1", "b0"})
    assert np.allclose(door.center[:2], (4.1, 0.6))
    far = Object("o4", "door", (2.0, 0.0, 1.0), rooms=("a",), planes=("a2",), confidence=0.7)
    assert len(reconciled([far], [passage], graph, ONCE)) == 2


def test_where_no_room_is_known_only_what_stands_upright_is_a_door() -> None:
    stage = ObjectStage(Painted(), ONCE)
    stage.feed(view("k0", 1.5, 2.0, 0.0))
    empty = SceneGraph(kind="online")
    assert len(stage.annotated(empty, np.zeros((0, 3))).objects) == 1
    (track,) = stage.map.tracks
    track.shape = np.diag([0.5, 0.5, 0.05]) ** 2
    assert stage.annotated(empty, np.zeros((0, 3))).objects == ()


def test_an_open_leaf_that_became_a_piece_of_wall_is_no_second_door() -> None:
    wall = Plane("w", (0.6, 0.8, 0.0), -3.8, extent=((4.0, 1.75), (3.28, 2.29)))
    graph = two_rooms()
    graph = graph.replace(planes=(*graph.planes, wall))
    half = Ellipsoid((0.45, 0.1, 1.0), (0.0, 0.0, 0.0, 1.0))
    door = Object("o1", "door", (4.0, 1.3, 1.0), half, planes=("a1", "b0"))
    leaf = Object("o2", "door", (3.64, 2.02, 1.0), half, rooms=("a",), planes=("w",))
    other = Object("o3", "door", (0.0, 4.0, 1.0), half, rooms=("a",), planes=("a0",))
    assert without_leaves([door, leaf, other], graph) == (door, other)
    passed = msgspec.structs.replace(leaf, attributes={"evidence": "vision,trajectory"})
    assert passed in without_leaves([door, passed], graph)


def test_who_passes_the_end_of_a_wall_passes_no_door() -> None:
    graph = two_rooms()
    seen = tuple(
        msgspec.structs.replace(p, extent=((p.offset, 0.0), (p.offset, 1.0)))
        if p.id == "a1"
        else msgspec.structs.replace(p, extent=((4.2, 0.0), (4.2, 1.0)))
        if p.id == "b0"
        else p
        for p in graph.planes
    )
    half = graph.replace(planes=seen)
    passages = {
        y: doorways(np.array([[3.0, y, 0.5], [6.0, y, 0.5]]), graph, ONCE) for y in (1.4, 3.0)
    }
    assert in_walls(passages[1.4], (), half, ONCE) == [*passages[1.4]]  # up to the doorway
    assert in_walls(passages[3.0], (), half, ONCE) == []
    assert in_walls(passages[3.0], (), graph, ONCE) == [*passages[3.0]]  # ends not known
    gap = WallGap(np.array([[4.0, 2.5], [4.0, 3.5]]), 0.0)
    assert in_walls(passages[3.0], [gap], half, ONCE) == [*passages[3.0]]


def test_a_place_that_images_show_without_an_object_is_counted() -> None:
    stage, half = ObjectStage(Painted()), 0.45
    normal, here, up = np.array([-1.0, 0.0, 0.0]), np.array([4.0, 2.0, 1.0]), np.array([0, 0, 3.0])
    for k in range(3):
        stage.feed(view(f"k{k}", 1.5, 2.0, 0.0, blind=True))
    stage.feed(view("k3", 1.5, 2.0, 1.5, blind=True))  # looks elsewhere
    stage.feed(view("k4", 3.3, 0.5, 1.1, blind=True))  # looks along the wall
    assert stage.missed("door", here, normal, half) == 3
    assert stage.missed("door", here + up, normal, half) == 0  # over the image
    assert stage.missed("door", here + np.array([1.5, 0.0, 0.0]), normal, half) == 0  # hidden
    stage.feed(view("k5", 1.5, 2.0, 0.0))
    assert stage.missed("door", here, normal, half) == 4  # once may be by chance
    stage.feed(view("k6", 1.5, 2.1, 0.0))
    assert stage.missed("door", here, normal, half) == 0
    assert stage.missed("window", here, normal, half) == 5
    beside = np.array([4.0, 3.0, 1.0])
    assert stage.missed("door", beside, normal, half) == 0  # a part of it was seen
    assert stage.missed("door", beside, normal, 0.2) > 0
