"""The SE1 logs: seven S-Graphs against six A-Graphs, whose frames agree but for 2.48 m in x."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from situgraph.geometry.poses import Placement
from situgraph.io.g2o import read_g2o
from situgraph.matching import PlanIndex
from situgraph.matching.matcher import match
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed

SEEN = ("R3", "R4", "R5", "R6", "R7", "R8", "RAll")
PLANS = ("T0", "T1", "T2", "T3", "T4", "T5")
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


def is_right(found: Placement, moved: Placement = Placement()) -> bool:
    """Whether a placement, of a graph moved before, is the true one."""
    at = found.compose(moved)
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


@pytest.mark.parametrize("name", SEEN)
def test_the_answer_does_not_depend_on_the_frame(
    seen: dict[str, SceneGraph], plans: dict[str, PlanIndex], name: str
) -> None:
    straight = match(seen[name], plans["T1"])
    for k in range(4):
        motion = Placement(7.0 * k - 11.0, 31.0 - 5.0 * k, 0.0, 0.4 + 1.3 * k)
        turned = match(transformed(seen[name], motion), plans["T1"])
        assert (turned.verdict, turned.count) == (straight.verdict, straight.count)
        assert any(is_right(s.transform, motion) for s in turned.solutions)


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
