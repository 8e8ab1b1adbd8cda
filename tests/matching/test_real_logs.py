"""The SE1 logs: seven S-Graphs against six A-Graphs, whose frames agree but for 2.48 m in x."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from situgraph.geometry.poses import Placement
from situgraph.io.g2o import read_g2o
from situgraph.matching import PlanIndex
from situgraph.matching.matcher import match
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.mirror import mirrored
from situgraph.scenegraph.transform import transformed

SEEN = ("R3", "R4", "R5", "R6", "R7", "R8", "RAll")
PLANS = ("T0", "T1", "T2", "T3", "T4", "T5")
FRAMES = 20  # random ones of each pair
FOREIGN = ("R3", "R4", "R5", "R7", "R8")  # their FIXed part is another building

pytestmark = pytest.mark.external


@pytest.fixture(scope="module")
def plans(shared_data: Path) -> dict[str, PlanIndex]:
    folder = shared_data / "sgraphs" / "SE1" / "A-Graphs"
    return {t: PlanIndex(read_g2o(folder / t / "graph.g2o", prefer="fixed")) for t in PLANS}


@pytest.fixture(scope="module")
def seen(shared_data: Path) -> dict[str, SceneGraph]:
    folder = shared_data / "sgraphs" / "SE1" / "S-Graphs"
    return {r: read_g2o(folder / r / "graph.g2o", "free") for r in SEEN}


def is_right(at: Placement) -> bool:
    """Whether a placement is the true one."""
    turned = abs(math.remainder(at.yaw, 2 * math.pi))
    return abs(at.x - 2.48) < 0.3 and abs(at.y) < 0.3 and turned < math.radians(5)


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("name", SEEN)
def test_the_truth_is_a_solution_and_nothing_else_is_unique(
    seen: dict[str, SceneGraph], plans: dict[str, PlanIndex], name: str, plan: str
) -> None:
    result = match(seen[name], plans[plan])
    assert any(is_right(s.transform) for s in result.solutions)
    assert not result.unique or is_right(result.best.transform)  # type: ignore[union-attr]


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("name", SEEN)
def test_the_answer_does_not_depend_on_the_frame(
    seen: dict[str, SceneGraph], plans: dict[str, PlanIndex], name: str, plan: str
) -> None:
    straight = match(seen[name], plans[plan])
    rng = np.random.default_rng([SEEN.index(name), PLANS.index(plan)])
    for _ in range(FRAMES):
        x, y, z = rng.uniform(-30.0, 30.0, 3)
        motion = Placement(x, y, z, rng.uniform(-math.pi, math.pi))
        turned = match(transformed(seen[name], motion), plans[plan])
        assert (turned.verdict, turned.count) == (straight.verdict, straight.count)
        for one, two in zip(straight.solutions, turned.solutions):
            assert one.rooms == two.rooms
            assert one.probability == pytest.approx(two.probability, abs=1e-6)


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("name", SEEN)
def test_a_mirrored_plan_is_never_unique(
    seen: dict[str, SceneGraph], plans: dict[str, PlanIndex], name: str, plan: str
) -> None:
    result = match(seen[name], mirrored(plans[plan].prior))
    assert not result.unique


def test_a_half_turned_rival_keeps_the_verdict_open(
    seen: dict[str, SceneGraph], plans: dict[str, PlanIndex]
) -> None:
    result = match(seen["R3"], plans["T4"])
    assert result.verdict == "ambiguous"
    assert abs(abs(result.solutions[1].transform.yaw) - math.pi) < 0.1


@pytest.mark.parametrize("name", FOREIGN)
def test_another_building_is_none(
    seen: dict[str, SceneGraph], shared_data: Path, name: str
) -> None:
    path = shared_data / "sgraphs" / "SE1" / "S-Graphs" / name / "graph.g2o"
    assert match(seen[name], PlanIndex(read_g2o(path, "fixed"))).verdict == "none"


def test_moved_walls_are_named(seen: dict[str, SceneGraph], plans: dict[str, PlanIndex]) -> None:
    best = match(seen["RAll"], plans["T1"]).best
    assert best is not None
    assert best.deviations
    assert all(0.1 < abs(d.offset) <= 0.4 for d in best.deviations)
