"""The worst runs come first, and say what was made difficult."""

from __future__ import annotations

from typing import Any

from situgraph.experiments.worst import case_of, made, worst


def run(outcome: str, error: float | None, seed: int, **more: Any) -> dict[str, Any]:
    return {"building": "grid", "seed": seed, "rooms": 3, "outcome": outcome,
            "placement_error_m": error, "located_s": None, **more}  # fmt: skip


def test_wrong_first_then_lost_then_the_largest_error() -> None:
    rows = [
        run("right", 0.01, 0), run("right", 0.05, 1), run("ambiguous", None, 2),
        run("wrong", 0.4, 3), run("never", None, 4),
    ]  # fmt: skip
    found = worst([{"name": "system", "rows": rows}], 4)
    assert [c.seed for c in found] == [3, 4, 2, 1]


def test_of_equal_ones_the_one_that_changed_its_mind() -> None:
    event = {"s": 3.0, "rooms": 1, "what": "withdrawn", "why": "it does not fit"}
    rows = [run("ambiguous", None, 0), run("ambiguous", None, 1, events=[event])]
    found = worst([{"name": "system", "rows": rows}])
    assert [c.seed for c in found] == [1, 0]
    assert found[0].story == ("3.0 s, 1 room, withdrawn: it does not fit",)


def test_what_was_made_difficult() -> None:
    row = run("right", 0.0, 0, moved_walls=1, fault="corrupt scans", detector="none")
    assert made(row) == "a wall moved, corrupt scans, no camera"
    assert case_of("localization", run("right", 0.0, 0, moved_by=0.05)).made == (
        "walls moved by 5 cm"
    )
