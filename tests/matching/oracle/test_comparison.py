"""The comparison itself: does it notice, is it repeatable, does it cover all kinds?"""

from __future__ import annotations

import msgspec
import pytest

from situgraph.experiments.oracle.cases import draw
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.matching import MatchingConfig


def test_the_definition_and_the_settings_say_the_same() -> None:
    here, there = Definition(), MatchingConfig()
    names = {"fit_limit": "plane_offset_tolerance"}
    shared = [n for n in Definition.__struct_fields__ if hasattr(there, names.get(n, n))]
    assert len(shared) >= 25
    for name in shared:
        assert getattr(here, name) == pytest.approx(getattr(there, names.get(name, name))), name
    for rate in (
        "miss",
        "false",
        "duplicate",
        "confusion",
        "wrong_wall",
        "wrong_join",
        "half_seen",
    ):
        assert getattr(here, rate) == getattr(there.rates, rate)


def test_the_comparison_notices_what_is_missed_and_what_is_invented(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from situgraph.experiments.oracle import comparison
    from situgraph.experiments.oracle.grids import grid

    online, prior = grid(1, 2), grid(1, 3)
    problem = Problem(online, prior, "none", Definition())
    assert compare(online, prior, problem).agrees

    class Lying:
        """A match result that moves its first solution and forgets its last."""

        def __init__(self, result: object) -> None:
            self.told = result.to_dict()  # type: ignore[attr-defined]
            self.told["solutions"][0]["transform"]["x"] += 1.0
            del self.told["solutions"][-1]

        def to_dict(self) -> dict[str, object]:
            return self.told

    real = comparison.match
    monkeypatch.setattr(comparison, "match", lambda *a, **k: Lying(real(*a, **k)))
    found = compare(online, prior, problem)
    assert found.missed == 2
    assert found.invented == 1
    assert not found.agrees


def test_cases_are_the_same_each_time_they_are_drawn() -> None:
    assert draw(7) == draw(7)
    first, second = draw(7).graphs(), draw(7).graphs()
    assert msgspec.json.encode(first[0]) == msgspec.json.encode(second[0])
    assert msgspec.json.encode(first[1]) == msgspec.json.encode(second[1])
    assert {draw(k).kind for k in range(60)} >= {"random", "modular", "grid", "wings", "storeys"}
    assert {draw(k).policy for k in range(60)} == {"none", "containment", "likelihood"}
