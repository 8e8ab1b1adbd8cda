"""Standard deviations are honest, whatever the sensor is worth and how well the house is built."""

from __future__ import annotations

import gtsam
import numpy as np
import pytest
from tests.coupling.plans import MAP, PRIOR, seen

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import WallEstimate, couple
from situgraph.coupling.evidence import Evidence
from situgraph.coupling.lines import WallLines
from situgraph.coupling.walls import walls
from situgraph.geometry.poses import pose_to_matrix

CONFIG = CouplingConfig()
LINES = WallLines(PRIOR)
STATED = 0.006  # m; what a sighting states as its error
VISITS = 4  # keyframes a room


def drive(
    noise: float, built: float, seed: int
) -> tuple[tuple[WallEstimate, ...], dict[str, float]]:
    """All rooms one after the other, each wall of a room seen by its keyframes.

    Sightings err by ``noise`` m and half as many radians, those of one face by ``fit_bias`` alike,
    motions by thrice the noise; walls stand ``built`` m from their plan, and one of them 0.2 m.
    Returns the faces and their true offsets.
    """
    rng = np.random.default_rng(seed)
    true = {p.id: float(rng.normal(0.0, built)) for p in PRIOR.planes}
    true["p5"] = 0.2
    online = seen(PRIOR, true)
    biases = {p.id: float(rng.normal(0.0, CONFIG.fit_bias)) for p in online.planes}
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    diagonal = gtsam.noiseModel.Diagonal.Sigmas
    sight = diagonal(np.array([STATED / 2, STATED / 2, STATED]))
    moving = diagonal(np.full(6, 3 * STATED))
    frames: dict[str, int] = {}
    planes: dict[str, int] = {}
    before: tuple[int, gtsam.Pose3] | None = None
    for keyframe, room in zip(online.keyframes, online.rooms):
        for _visit in range(VISITS):
            pose = pose_to_matrix(keyframe.pose)
            pose[:2, 3] += rng.uniform(-0.8, 0.8, 2)
            here, key = gtsam.Pose3(pose), gtsam.symbol("x", len(frames))
            frames[f"k{len(frames)}"] = key
            values.insert(key, here)
            if before is None:
                factors.push_back(gtsam.PriorFactorPose3(key, here, diagonal(np.full(6, 1e-3))))
            else:
                step = before[1].between(here).retract(rng.normal(0.0, 3 * noise, 6))
                factors.push_back(gtsam.BetweenFactorPose3(before[0], key, step, moving))
            before = key, here
            for name in room.planes:
                plane = online.plane_by_id[name]
                face = gtsam.OrientedPlane3(np.array([*plane.normal, plane.offset]))
                if name not in planes:
                    planes[name] = gtsam.symbol("p", len(planes))
                    values.insert(planes[name], face)
                off = rng.normal(0.0, noise, 3) * (0.5, 0.5, 1.0)
                off[2] += biases[name]
                measured = face.transform(here).retract(off).planeCoefficients()
                factors.push_back(gtsam.OrientedPlane3Factor(measured, sight, key, planes[name]))
    evidence = Evidence(factors, values, planes, frames)
    pairs = [(p.id, p.id) for p in PRIOR.planes]
    return couple(evidence, walls(online, PRIOR, pairs, MAP, LINES), MAP, CONFIG).walls, true


@pytest.mark.parametrize("noise", [0.002, 0.006, 0.012])
@pytest.mark.parametrize("built", [0.0, 0.003, 0.01])
def test_normalised_errors_are_about_one(noise: float, built: float) -> None:
    errors = []
    for seed in range(6):
        found, true = drive(noise, built, seed)
        errors += [(w.offset - true[w.prior]) / w.offset_sigma for w in found]
    assert 0.65 < float(np.sqrt(np.mean(np.square(errors)))) < 1.5


def test_a_better_sensor_states_smaller_errors() -> None:
    small, large = (np.mean([w.offset_sigma for w in drive(s, 0.0, 1)[0]]) for s in (0.002, 0.012))
    assert small < 0.5 * large
