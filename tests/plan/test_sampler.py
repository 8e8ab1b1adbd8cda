"""What sampled S-Graphs must be, and that the truth about them is true."""

from __future__ import annotations

import math
import typing

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement, wrap_angle
from situgraph.plan.layout_config import Kind, LayoutConfig
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_prefix import first_rooms
from situgraph.plan.sample_truth import OnlineSample, truth_from_json, truth_to_json
from situgraph.plan.sampler import Sampler, sample_online
from situgraph.plan.sampler_config import CLEAN, REALISTIC, DetectionRates, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.scenegraph.validation import validate

priors = st.builds(
    make_layout,
    kind=st.sampled_from(typing.get_args(Kind)),
    rooms=st.integers(2, 20),
    seed=st.integers(0, 1000),
)
ALL_ERRORS = DetectionRates(missed=0.2, false=0.2, duplicated=0.2, confused=0.2, wrong_wall=0.2)
ROUGH = msgspec.structs.replace(REALISTIC, moved_walls=0.2, detection_default=ALL_ERRORS)


def plane_errors(prior: SceneGraph, sample: OnlineSample) -> tuple[np.ndarray, np.ndarray]:
    """Offsets at each face's middle (m) and angles (rad) of the moved online planes."""
    moved = transformed(sample.online, sample.truth.placement)
    offsets, angles = [], []
    for online_id, prior_id in sample.truth.planes.items():
        seen, planned = moved.plane_by_id[online_id], prior.plane_by_id[prior_id]
        assert planned.extent is not None
        middle = np.append(np.mean(planned.extent, axis=0), 0.0)
        room = prior.room_by_id[prior.rooms_by_plane[prior_id][0]]
        middle[2] = room.center[2]
        offsets.append(np.dot(seen.normal, middle) + seen.offset)
        angles.append(math.acos(min(1.0, float(np.dot(seen.normal, planned.normal)))))
    return np.array(offsets), np.array(angles)


@given(priors, st.integers(1, 12), st.integers(0, 1000))
@settings(max_examples=40)
def test_the_true_placement_takes_a_clean_sample_onto_the_prior(
    prior: SceneGraph, rooms: int, seed: int
) -> None:
    sample = sample_online(prior, rooms, seed)
    truth, moved = sample.truth, transformed(sample.online, sample.truth.placement)
    assert len(sample.online.rooms) == min(rooms, len(prior.rooms)) == len(truth.rooms)
    offsets, angles = plane_errors(prior, sample)
    assert np.max(np.abs(offsets)) < 1e-8
    assert np.max(angles) < 1e-6
    for online_id, prior_id in truth.rooms.items():
        np.testing.assert_allclose(
            moved.room_by_id[online_id].center, prior.room_by_id[prior_id].center, atol=1e-8
        )
    for online_id, prior_id in truth.objects.items():
        seen, there = moved.object_by_id[online_id], prior.object_by_id[prior_id]
        np.testing.assert_allclose(seen.center, there.center, atol=1e-8)
        assert seen.category == there.category
        assert seen.ellipsoid is not None
        assert there.ellipsoid is not None
        turn = abs(np.dot(seen.ellipsoid.rotation, there.ellipsoid.rotation))
        assert turn == pytest.approx(1.0)
        assert {truth.planes[p] for p in seen.planes} <= set(there.planes)
    for online_id, prior_id in truth.storeys.items():
        assert moved.storey_by_id[online_id].elevation == pytest.approx(
            prior.storey_by_id[prior_id].elevation
        )


@given(priors, st.integers(1, 12), st.integers(0, 1000), st.sampled_from([CLEAN, ROUGH]))
@settings(max_examples=40)
def test_samples_are_valid_and_hold_nothing_of_rooms_not_entered(
    prior: SceneGraph, rooms: int, seed: int, config: SamplerConfig
) -> None:
    sample = sample_online(prior, rooms, seed, config)
    online, truth = sample.online, sample.truth
    assert online.kind == "online"
    assert validate(online, "sample").rooms == online.rooms
    seen = set(truth.rooms.values())
    for online_id, prior_id in truth.objects.items():
        there = prior.object_by_id[prior_id]
        assert set(there.rooms) & seen
        assert {truth.rooms[r] for r in online.object_by_id[online_id].rooms} == (
            set(there.rooms) & seen
        )
    named = {*truth.rooms, *truth.false_rooms}
    assert named == set(online.room_by_id)
    assert {*truth.planes, *truth.false_planes} == set(online.plane_by_id)
    counted = {*truth.objects, *truth.duplicates, *truth.false_objects}
    assert counted == set(online.object_by_id)
    for part in (truth.rooms, truth.planes, truth.objects):
        assert len(set(part.values())) == len(part)
    in_view = {o.id for r in seen for o in prior.objects_by_room.get(r, ())}
    assert set(truth.objects.values()) | set(truth.missed_objects) == in_view


def test_rooms_come_in_an_order_of_neighbours() -> None:
    prior = make_layout("random", 60, seed=2)
    sampler = Sampler(prior)
    for seed in range(30):
        truth = sampler.sample(12, seed).truth
        assert truth.contiguous
        known = {truth.rooms[truth.order[0]]}
        for online_id in truth.order[1:]:
            room = truth.rooms[online_id]
            doors = prior.objects_by_room[room]
            assert any(known & (set(d.rooms) - {room}) for d in doors)
            known.add(room)
        assert np.all(np.diff(truth.walked) > 0.0)


def test_without_doors_rooms_behind_a_common_wall_are_taken() -> None:
    prior = make_layout("random", 40, seed=2, object_density=0.0)
    truth = sample_online(prior, 15, 3).truth
    assert truth.contiguous
    assert len(truth.rooms) == 15


def test_noise_is_as_stated() -> None:
    config = SamplerConfig(plane_offset_sigma=0.03, plane_yaw_sigma=0.01, object_sigma=0.1)
    prior = make_layout("random", 200, seed=1)
    offsets, angles = plane_errors(prior, sample_online(prior, 200, 1, config))
    assert np.std(offsets) == pytest.approx(0.03, rel=0.1)
    assert math.sqrt(np.mean(angles**2)) == pytest.approx(0.01, rel=0.1)


def test_moved_walls_are_named_with_their_offsets() -> None:
    config = SamplerConfig(moved_walls=0.1)
    prior = make_layout("modular", 100, seed=1)
    sample = sample_online(prior, 100, 1, config)
    moved = {m.prior: m for m in sample.truth.moved}
    assert 0.05 < len(moved) / len(prior.planes) < 0.2
    graph = transformed(sample.online, sample.truth.placement)
    for online_id, prior_id in sample.truth.planes.items():
        seen, planned = graph.plane_by_id[online_id], prior.plane_by_id[prior_id]
        offset = moved[prior_id].offset if prior_id in moved else 0.0
        assert offset == 0.0 or 0.1 <= abs(offset) <= 0.4
        # n.x + d = 0 moved by offset along n has d - offset.
        assert seen.offset == pytest.approx(planned.offset - offset, abs=1e-7)


def test_both_sides_of_a_wall_move_together() -> None:
    config = SamplerConfig(moved_walls=1.0)
    prior = make_layout("grid", 4, seed=1, shape=(2, 2), object_density=0.0)
    moved = {m.prior: m.offset for m in sample_online(prior, 4, 1, config).truth.moved}
    assert len(moved) == 16
    sampler = Sampler(prior)
    for a, others in sampler.links.back.items():
        for b in others:
            assert moved[a] == -moved[b]


def test_missing_planes_leave_a_corner() -> None:
    config = SamplerConfig(missing_planes=0.6)
    prior = make_layout("random", 100, seed=1)
    sample = sample_online(prior, 100, 1, config)
    for room in sample.online.rooms:
        normals = np.array([sample.online.plane_by_id[p].normal[:2] for p in room.planes])
        assert len(normals) >= 2
        cross = np.outer(normals[:, 0], normals[:, 1]) - np.outer(normals[:, 1], normals[:, 0])
        assert np.abs(cross).max() > 0.5
    lost = len(sample.truth.missing_planes)
    assert lost + len(sample.online.planes) == len(prior.planes)


def test_drift_bends_the_map_as_stated() -> None:
    config = SamplerConfig(drift=math.radians(2.0) / 50.0)
    prior = make_layout("corridor", 100, seed=1)
    truth = sample_online(prior, 40, 1, config).truth
    start = truth.room_placements[truth.order[0]]
    assert start.yaw == pytest.approx(truth.start.yaw)
    for online_id, walked in zip(truth.order, truth.walked, strict=True):
        error = float(wrap_angle(truth.room_placements[online_id].yaw - truth.start.yaw))
        assert abs(error) == pytest.approx(config.drift * walked, abs=1e-9)
    assert truth.placement != truth.start
    # The best placement lies between the first room's and the last one's.
    turn = float(wrap_angle(truth.placement.yaw - truth.start.yaw))
    last = float(wrap_angle(truth.room_placements[truth.order[-1]].yaw - truth.start.yaw))
    assert 0.0 < turn / last < 1.0


def test_detection_errors_come_at_the_stated_rates() -> None:
    rates = DetectionRates(missed=0.1, false=0.05, duplicated=0.03, confused=0.02, wrong_wall=0.04)
    config = SamplerConfig(detection={"radiator": rates})
    prior = make_layout("random", 600, seed=1, config=LayoutConfig(others_per_room=12.0))
    sample = sample_online(prior, 600, 1, config)
    online, truth = sample.online, sample.truth
    radiators = sum(o.category == "radiator" for o in prior.objects)
    found = radiators - len(truth.missed_objects)
    assert radiators > 1000
    assert len(truth.missed_objects) / radiators == pytest.approx(0.1, abs=0.03)
    assert len(truth.false_objects) / radiators == pytest.approx(0.05, abs=0.02)
    assert len(truth.duplicates) / found == pytest.approx(0.03, abs=0.02)
    assert len(truth.confused) / found == pytest.approx(0.02, abs=0.02)
    assert len(truth.wrong_wall) / found == pytest.approx(0.04, abs=0.02)
    for name in truth.confused:
        there = truth.objects.get(name) or truth.duplicates[name]
        assert online.object_by_id[name].category != prior.object_by_id[there].category
    for name in truth.wrong_wall:
        there = truth.objects.get(name) or truth.duplicates[name]
        hosts = {truth.planes[p] for p in online.object_by_id[name].planes}
        assert not hosts & set(prior.object_by_id[there].planes)
    untouched = [o for o in prior.objects if o.category != "radiator"]
    assert {o.id for o in untouched} <= set(truth.objects.values())


def test_false_rooms_have_no_counterpart() -> None:
    config = SamplerConfig(false_rooms=0.5)
    sample = sample_online(make_layout(rooms=20, seed=1), 10, 1, config)
    assert len(sample.truth.false_rooms) == 5
    assert len(sample.truth.false_planes) == 20
    assert len(sample.online.rooms) == 15


def test_ids_and_order_say_nothing() -> None:
    prior = make_layout("random", 30, seed=1)
    same = total = 0
    for seed in range(20):
        truth = sample_online(prior, 30, seed).truth
        same += sum(a == b for a, b in truth.planes.items())
        total += len(truth.planes)
    assert same / total < 0.03


def test_same_seed_same_sample() -> None:
    prior = make_layout("storeys", 30, seed=1)
    one, again = (sample_online(prior, 12, 7, ROUGH) for _ in range(2))
    assert one == again
    sampler = Sampler(prior, ROUGH)
    sampler.sample(5, 1)
    assert sampler.sample(12, 7) == one
    assert sampler.sample(12, 8) != one


def test_samples_cross_storeys_by_the_stairs() -> None:
    prior = make_layout("storeys", 12, seed=1)
    sample = sample_online(prior, 12, 0)
    assert sample.truth.contiguous
    assert len(sample.online.storeys) == 3


def test_the_start_can_be_chosen() -> None:
    truth = sample_online(make_layout(rooms=9), 3, 0, start="r5").truth
    assert truth.rooms[truth.order[0]] == "r5"


def test_truth_survives_its_file() -> None:
    truth = sample_online(make_layout(rooms=9, seed=3), 5, 0, ROUGH).truth
    assert truth_from_json(truth_to_json(truth)) == truth


def test_requests_that_cannot_be_met_are_refused() -> None:
    prior = make_layout(rooms=4)
    with pytest.raises(InputError, match="at least one"):
        sample_online(prior, 0)
    with pytest.raises(InputError, match="start from"):
        sample_online(prior, 2, start="r9")
    with pytest.raises(InputError, match="no rooms"):
        Sampler(SceneGraph())


def test_graphs_without_footprints_and_extents_can_be_sampled() -> None:
    full = make_layout("random", 12, seed=1, object_density=0.0)
    bare = full.replace(
        rooms=tuple(msgspec.structs.replace(r, footprint=None) for r in full.rooms),
        planes=tuple(msgspec.structs.replace(p, extent=None) for p in full.planes),
    )
    sample = sample_online(bare, 6, 0)
    assert len(sample.truth.rooms) == 6
    assert not sample.truth.contiguous
    moved = transformed(sample.online, sample.truth.placement)
    for online_id, prior_id in sample.truth.planes.items():
        assert moved.plane_by_id[online_id].offset == pytest.approx(
            bare.plane_by_id[prior_id].offset, abs=1e-8
        )


def test_placements_are_spread_over_all_yaws() -> None:
    sampler = Sampler(make_layout(rooms=6))
    placements: list[Placement] = [sampler.sample(3, s).truth.placement for s in range(200)]
    yaws = np.array([p.yaw for p in placements])
    assert np.histogram(yaws, bins=4, range=(-math.pi, math.pi))[0].min() > 25


@given(priors, st.integers(0, 1000), st.integers(1, 8))
@settings(max_examples=30)
def test_the_first_rooms_of_a_sample_are_a_sample(prior: SceneGraph, seed: int, rooms: int) -> None:
    whole = sample_online(prior, 12, seed, ROUGH)
    part = first_rooms(whole, prior, rooms)
    online, truth = part.online, part.truth
    assert validate(online, "part").rooms == online.rooms
    assert truth.order == whole.truth.order[:rooms]
    assert {*truth.rooms, *truth.false_rooms} == set(online.room_by_id)
    assert {*truth.planes, *truth.false_planes} == set(online.plane_by_id)
    assert {*truth.objects, *truth.duplicates, *truth.false_objects} == set(online.object_by_id)
    seen = set(truth.rooms.values())
    in_view = {o.id for r in seen for o in prior.objects_by_room.get(r, ())}
    assert set(truth.objects.values()) | set(truth.missed_objects) == in_view
    faces = {p for r in seen for p in prior.room_by_id[r].planes}
    assert set(truth.planes.values()) | set(truth.missing_planes) == faces
    assert {m.prior for m in truth.moved} <= faces
    if rooms >= len(whole.truth.order):
        assert online == whole.online
