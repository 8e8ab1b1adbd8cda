"""Both graphs in one: the map comes out in the building, moved walls tell by how much."""

from __future__ import annotations

import math

import gtsam
import msgspec
import numpy as np
import pytest
from tests.coupling.plans import MAP, PRIOR, all_pairs, seen

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import couple, deviation
from situgraph.coupling.evidence import Evidence, from_scene
from situgraph.coupling.lines import WallLines
from situgraph.coupling.located import locate
from situgraph.coupling.trajectory import Carrier
from situgraph.coupling.walls import grouped, walls
from situgraph.geometry.poses import Placement, pose_to_matrix, wrap_angle
from situgraph.scenegraph.graph import Keyframe

CONFIG = CouplingConfig(plane_sigma=0.01, plane_angle_sigma=0.003)

LINES = WallLines(PRIOR)


def off(found: Placement, true: Placement = MAP) -> tuple[float, float]:
    """Distance in the midst of the building, and turn."""
    middle = true.inverse().points([10.0, 5.0, 1.4])
    away = np.linalg.norm(found.points(middle) - true.points(middle))
    return float(away), abs(float(wrap_angle(found.yaw - true.yaw)))


def test_a_perfect_view_comes_out_where_it_is() -> None:
    rough = Placement(MAP.x + 0.1, MAP.y - 0.1, MAP.z, MAP.yaw + 0.02)
    online = seen(PRIOR)
    found = locate(online, PRIOR, all_pairs(online, rough), config=CONFIG)
    assert off(found.placement) == pytest.approx((0.0, 0.0), abs=1e-4)
    assert not [d for d in found.deviations if d.category == "wall"]
    for keyframe, room in zip(found.graph.keyframes, PRIOR.rooms):
        assert keyframe.pose[:3] == pytest.approx(room.center, abs=1e-3)


@pytest.mark.parametrize("by", [0.05, 0.12, 0.30, 0.40])
def test_moved_walls_are_measured_and_pull_nothing_along(by: float) -> None:
    moved = {"p1": by, "p7": -by, "p10": by}
    online = seen(PRIOR, moved, noise=0.005)
    found = locate(online, PRIOR, all_pairs(online), config=CONFIG)
    assert off(found.placement)[0] < 0.01
    told = {d.prior: d for d in found.deviations if d.kind == "moved-wall"}
    assert set(told) == set(moved)
    for name, true in moved.items():
        assert told[name].offset == pytest.approx(true, abs=0.02)
        assert told[name].sigma < 0.02


def test_errors_are_of_the_size_of_their_standard_deviations() -> None:
    ratios = []
    for seed in range(8):
        online = seen(PRIOR, {"p5": 0.2}, noise=CONFIG.plane_sigma, seed=seed)
        found = locate(online, PRIOR, all_pairs(online), config=CONFIG)
        wall = next(w for w in found.coupled.walls if w.prior == "p5")
        ratios.append((wall.offset - 0.2) / wall.offset_sigma)
    assert 0.3 < float(np.sqrt(np.mean(np.square(ratios)))) < 2.0


def test_a_wall_built_askew_is_measured() -> None:
    turn = math.radians(1.5)
    online = seen(PRIOR)
    planes = list(online.planes)
    at = next(i for i, p in enumerate(planes) if p.id == "p5")
    n, (a, b) = np.array(planes[at].normal[:2]), planes[at].extent
    middle = (np.array(a) + np.array(b)) / 2
    turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]) @ n
    planes[at] = msgspec.structs.replace(
        planes[at], normal=(*turned.tolist(), 0.0), offset=float(-turned @ middle)
    )
    built = online.replace(planes=tuple(planes))
    found = locate(built, PRIOR, all_pairs(built), config=CONFIG)
    wall = next(w for w in found.coupled.walls if w.prior == "p5")
    assert wall.tilt == pytest.approx(turn, abs=0.004)
    assert wall.offset == pytest.approx(0.0, abs=0.01)


def test_a_deviation_and_its_derivative_are_right() -> None:
    """Against planes made by hand, in a building that is turned at will."""
    rng = np.random.default_rng(3)
    building = gtsam.Pose3.Expmap(rng.normal(0, 0.5, 6))
    planned = gtsam.Pose3.Expmap(np.array([0.0, 0.0, 0.7, 3.0, -2.0, 1.0])).matrix()
    frame = building.matrix() @ planned
    turn, away = 0.02, 0.15
    n = frame[:3, :3] @ np.array([math.cos(turn), math.sin(turn), 0.0])
    point = frame[:3, 3] + away * frame[:3, 0]
    plane = gtsam.OrientedPlane3(np.array([*n, -n @ point]))
    (offset, tilt), slope = deviation(building, plane, planned)
    assert (offset, tilt) == pytest.approx((away, turn), abs=1e-9)
    # The building moves along the normal: the face stays behind by as much.
    along = gtsam.Pose3(planned).rotation().matrix()[:, 0]
    assert slope[:, 3:6] @ along == pytest.approx([-1.0, 0.0], abs=1e-6)
    # The building turns about the vertical through the face: the face turns back.
    about = np.array([0.0, 0.0, 1.0])
    lever = np.cross(planned[:3, 3], about)  # so that the point on the face stays
    turned = slope[:, :3] @ about + slope[:, 3:6] @ lever
    assert turned[1] == pytest.approx(-1.0, abs=1e-3)
    # The face moves along its normal.
    assert slope[0, 8] == pytest.approx(-1.0 / math.cos(turn), abs=1e-3)


def test_both_faces_of_a_wall_are_one_witness() -> None:
    """Of three walls across x one moved; its two faces are no majority over the other two."""
    graph = seen(PRIOR)
    faces = {p: p for p in ("p1", "p15", "p3", "p21")}  # wall of rooms 1 and 4; west; east
    parts = grouped(walls(graph, PRIOR, faces.items(), MAP, LINES))
    assert sorted(sorted(f.prior for f in wall) for wall in parts) == [
        ["p1", "p15"],
        ["p21"],
        ["p3"],
    ]


def test_faces_in_one_line_are_one_wall() -> None:
    graph = seen(PRIOR)
    south = ["p0", "p12", "p16"]  # of rooms 1, 4 and 5
    (wall,) = grouped(walls(graph, PRIOR, [(p, p) for p in south], MAP, LINES))
    assert sorted(face.prior for face in wall) == south


def test_few_moved_walls_do_not_win_by_being_near() -> None:
    """The match starts where the moved wall of room 1 fits; three others say otherwise."""
    online = seen(PRIOR, {"p1": 0.3, "p15": -0.3}, noise=0.003)
    rough = MAP.compose(Placement(*MAP.inverse().vectors([-0.25, 0.1, 0.0]).tolist(), 0.01))
    found = locate(online, PRIOR, all_pairs(online, rough), config=CONFIG)
    assert off(found.placement)[0] < 0.01
    told = {d.prior for d in found.deviations if d.kind == "moved-wall"}
    assert told == {"p1", "p15"}


def test_a_map_that_drifts_is_bent_straight() -> None:
    """Keyframes in a row with biased odometry; each sees the walls of its room."""
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    online = seen(PRIOR)
    true = [pose_to_matrix(k.pose) for k in online.keyframes]
    bias = gtsam.Pose3.Expmap(np.array([0.0, 0.0, 0.02, 0.15, 0.05, 0.0]))
    moving = gtsam.noiseModel.Isotropic.Sigma(6, 0.1)
    sharp = gtsam.noiseModel.Isotropic.Sigma(3, 0.005)
    pose = gtsam.Pose3(true[0])
    factors.push_back(gtsam.PriorFactorPose3(gtsam.symbol("x", 0), pose, moving))
    planes, first = {}, {}
    for i, room in enumerate(online.rooms):
        key = gtsam.symbol("x", i)
        if i:
            step = gtsam.Pose3(np.linalg.inv(true[i - 1]) @ true[i]).compose(bias)
            pose = pose.compose(step)
            between = gtsam.BetweenFactorPose3(gtsam.symbol("x", i - 1), key, step, moving)
            factors.push_back(between)
        values.insert(key, pose)
        for name in room.planes:
            p = online.plane_by_id[name]
            measured = gtsam.OrientedPlane3(np.array([*p.normal, p.offset])).transform(
                gtsam.Pose3(true[i])
            )
            coefficients = measured.planeCoefficients()
            planes[name] = gtsam.symbol("p", len(planes))
            back = gtsam.OrientedPlane3(coefficients).transform(pose.inverse())
            values.insert(planes[name], back)
            first[name] = back
            factors.push_back(gtsam.OrientedPlane3Factor(coefficients, sharp, key, planes[name]))
    frames = {f"k{i}": gtsam.symbol("x", i) for i in range(len(true))}
    evidence = Evidence(factors, values, planes, frames)
    faces = walls(online, PRIOR, [(p, p) for p in planes], MAP, LINES)
    found = couple(evidence, faces, MAP, CONFIG)
    for i, room in enumerate(PRIOR.rooms):
        assert found.frames[f"k{i}"][:3, 3] == pytest.approx(room.center, abs=0.02)
    worst = values.atPose3(frames["k5"]).matrix()[:3, 3] - true[5][:3, 3]
    assert np.linalg.norm(worst) > 0.5


def test_planes_without_pairs_and_no_pairs_at_all() -> None:
    online = seen(PRIOR)
    evidence = from_scene(online, CONFIG)
    found = couple(evidence, (), MAP, CONFIG)
    assert found.walls == ()
    assert off(found.placement)[0] < 1e-6
    assert len(found.planes) == len(online.planes)


def test_the_latest_pose_is_the_last_of_the_trajectory() -> None:
    """What is told live is what the trajectory says afterwards."""
    keyframes = [
        Keyframe("k0", 0.0, (0, 0, 0, 0, 0, 0, 1)),
        Keyframe("k1", 1.0, (1, 0, 0, 0, 0, 0, 1)),
    ]
    frames = {"k0": np.eye(4), "k1": Placement(2.0, 0.5, 0.1, 0.2).matrix()}
    pose = np.array([1.5, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0])
    for known in (frames, {}):
        carrier = Carrier(keyframes, known, Placement(3.0, 1.0, 0.0, 0.4).matrix())
        assert np.allclose(carrier.latest(pose), carrier.trajectory([9.0], pose[None])[0])
