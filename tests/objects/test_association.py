from __future__ import annotations

import numpy as np
import pytest

from situgraph.geometry.poses import Placement
from situgraph.objects.association import ObjectMap, Observation
from situgraph.objects.clusters import clusters, thin
from situgraph.objects.config import ObjectsConfig

ONCE = ObjectsConfig(min_seen=1)


def panel(x: float, seed: int = 0, count: int = 400) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.uniform((x - 0.45, -0.02, 0.0), (x + 0.45, 0.02, 2.1), (count, 3))


def observed(points: np.ndarray, pose: np.ndarray, category: str = "door") -> Observation:
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    return Observation(category, 0.9, local)


def pose(x: float, y: float, yaw: float) -> np.ndarray:
    return Placement(x, y, 0.0, yaw).matrix()


def test_two_views_of_one_door_are_one_object() -> None:
    world = ObjectMap(ONCE)
    for k, p in enumerate((pose(0, -2, 0.3), pose(1, -3, -0.4))):
        world.add(f"k{k}", p, [observed(panel(0.0, k), p)])
    (door,) = world.objects()
    assert np.allclose(door.center, (0.0, 0.0, 1.05), atol=0.06)
    assert door.attributes["seen"] == 2


def test_other_categories_and_other_places_stay_apart() -> None:
    world = ObjectMap(ONCE)
    p = pose(0, 0, 0)
    panels = [observed(panel(x), p, c) for x, c in ((0.0, "door"), (0.1, "window"), (3.0, "door"))]
    world.add("k0", p, panels)
    assert sorted(o.category for o in world.objects()) == ["door", "door", "window"]


def test_objects_follow_their_keyframe_when_it_is_corrected() -> None:
    world = ObjectMap(ONCE)
    world.add("k0", pose(0, 0, 0), [observed(panel(2.0), pose(0, 0, 0))])
    correction = Placement(0.5, -0.2, 0.0, 0.1)
    before = np.array(world.objects()[0].center)
    world.correct({"k0": correction.matrix()})
    assert np.allclose(world.objects()[0].center, correction.points(before), atol=1e-9)


def test_duplicates_merge_when_a_correction_brings_them_together() -> None:
    world = ObjectMap(ONCE)
    world.add("k0", pose(0, 0, 0), [observed(panel(0.0), pose(0, 0, 0))])
    drifted = pose(3, 0, 0)
    true = pose(0, 0, 0)
    world.add("k1", drifted, [observed(panel(0.0, 1), true)])
    assert len(world.objects()) == 2
    world.correct({"k1": true})
    (door,) = world.objects()
    assert door.id == "o0"


def test_an_object_that_is_never_seen_again_loses_confidence() -> None:
    world = ObjectMap(ONCE)
    p = pose(0, 0, 0)
    tracks = world.add("k0", p, [observed(panel(0.0), p)])
    first = world.objects()[0].confidence
    world.expect(tracks)
    for _ in range(9):
        world.expect(tracks)
    assert world.objects() == ()
    assert tracks[0].confidence < 0.25 < first


def test_memory_is_bounded_by_the_objects_not_by_the_frames() -> None:
    config = ObjectsConfig(max_object_points=500)
    world = ObjectMap(config)
    for k in range(30):
        p = pose(0.1 * k, -2, 0.0)
        world.add(f"k{k}", p, [observed(panel(0.0, k), p)])
    (track,) = world.tracks
    assert len(track.points) <= 500
    assert len(world._poses) == 1


def test_a_long_drive_keeps_objects_and_forgets_specks() -> None:
    """600 frames in eight rooms: each shows the room's two doors and something that is not."""
    rng = np.random.default_rng(5)
    config = ObjectsConfig(max_unsure=20, max_object_points=300)
    world, most, p = ObjectMap(config), 0, np.eye(4)
    for k in range(600):
        room, aside = 20.0 * (k // 25 % 8), rng.uniform(200, 900, 2)
        at, away = (room + rng.uniform(0, 10), 5.0, 1.0), (*aside, 1.0)
        real = [panel(room + x, k, 120) for x in (0.0, 3.0)]
        speck = rng.uniform(-0.05, 0.05, (15, 3)) + np.array(at)
        hidden = rng.uniform(-0.05, 0.05, (15, 3)) + np.array(away)
        seen = world.add(f"k{k}", p, [observed(c, p) for c in (*real, speck, hidden)])
        # All of a room is expected when the robot is there; what lies behind walls never is.
        here = [t for t in world.tracks if room - 1 < t.center[0] < room + 12]
        world.expect(list(dict.fromkeys([*here, *seen])))
        # Specks that met by chance are given out for a while, until they are missed.
        most = max(most, len(world.tracks))
        assert len(world.tracks) <= len(world.objects()) + config.max_unsure
        assert len(world.objects()) <= 16 + 8
    assert sum(len(t.points) for t in world.tracks) <= 16 * 300 + (20 + 8) * 15 * 4
    assert len(world._poses) <= most
    assert sum(o.attributes["seen"] > 20 for o in world.objects()) == 16
    specks = [t for t in world.tracks if t.center[1] > 4.0 and t.center[0] < 180.0]
    assert len(specks) < 20  # of six hundred


def test_pieces_of_one_frame_do_not_confirm_each_other() -> None:
    world = ObjectMap()
    p = pose(0, -2, 0)
    pieces = [observed(panel(0.0, k), p) for k in range(3)]
    (track,) = world.add("k0", p, pieces)
    assert (track.seen, track.frames) == (1, (1,))
    assert track.score == pytest.approx(0.9)
    assert world.objects() == ()
    world.add("k1", p, pieces)
    assert (track.seen, track.frames) == (2, (1, 2))
    assert len(world.objects()) == 1


def test_a_cluster_has_the_score_of_its_own_mask() -> None:
    parts = {"door": [(0.5, panel(0.0)), (0.9, panel(3.0))]}
    scores = {round(o.points[:, 0].mean()): o.score for o in ObjectMap(ONCE).observations(parts)}
    assert scores == {0: 0.5, 3: 0.9}


def test_the_order_of_categories_does_not_matter() -> None:
    parts = {"window": [(0.8, panel(3.0))], "door": [(0.9, panel(0.0)), (0.7, panel(0.3))]}
    world = ObjectMap(ONCE)
    forward = world.observations(parts)
    backward = world.observations(dict(reversed(parts.items())))
    assert [o.category for o in forward] == [o.category for o in backward] == ["door", "window"]


@pytest.mark.parametrize("gap", [0.2, 0.4])
def test_clusters_split_at_gaps(gap) -> None:
    points = thin(np.concatenate([panel(0.0), panel(0.9 + 0.3)]), 0.05)
    groups = clusters(points, gap, 5)
    assert len(groups) == (2 if gap < 0.3 else 1)
    assert sum(map(len, groups)) == len(points)


def test_thinning_keeps_one_point_a_voxel() -> None:
    points = np.array([[0.01, 0.01, 0.01], [0.03, 0.03, 0.03], [0.06, 0.0, 0.0]])
    assert np.allclose(thin(points, 0.05), [[0.02, 0.02, 0.02], [0.06, 0.0, 0.0]])
    assert thin(np.zeros((0, 3)), 0.05).shape == (0, 3)
    assert clusters(np.zeros((0, 3)), 0.2, 3) == []


def test_an_object_knows_from_where_it_was_seen_best() -> None:
    world = ObjectMap(ONCE)
    for k, p in enumerate((pose(0, -5, 0.2), pose(1, -2, 0.4), pose(-1, -4, 0.0))):
        world.add(f"k{k}", p, [observed(panel(0.0, k), p)], np.array([0.0, 0.0, 0.5]))
    (track,) = world.tracks
    assert np.allclose(world.eye(track), (1.0, -2.0, 0.5))
    world.correct({"k0": Placement(0.0, 1.0, 0.0, 0.0).matrix() @ pose(0, -5, 0.2)})
    assert np.allclose(world.eye(track), (1.0, -1.0, 0.5))


def test_one_mask_over_two_doors_is_two_objects() -> None:
    """What a network calls stuff has no instances: its one mask is split by the room between."""
    stuff = np.concatenate([panel(0.0, 1), panel(2.0, 2)])
    found = ObjectMap(ONCE).observations({"door": [(0.9, stuff)]})
    assert sorted(round(float(o.points[:, 0].mean())) for o in found) == [0, 2]
