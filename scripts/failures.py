"""Put the worst runs into docs/results/failures.md: `python scripts/failures.py`.

Run the experiments `system` and `localization` first (they leave results/NAME). The part of it
between `<!-- results -->` and `<!-- end -->` is replaced; the explanations below it are by hand.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

from situgraph.experiments.tables import Table, markdown, shown
from situgraph.experiments.worst import Case, worst

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "results" / "failures.md"
NAMES = ("system", "localization")
PART = re.compile(r"(<!-- results -->\n)(.*?)(<!-- end -->)", re.DOTALL)
COLUMNS = (
    "", "experiment", "building", "seed", "made difficult by", "rooms", "outcome",
    "placement off (cm)", "trajectory off (cm)", "located (s)",
)  # fmt: skip


def row(number: int, case: Case) -> tuple[object, ...]:
    """A line of the table."""
    return (
        number, case.experiment, case.building, case.seed, case.made, case.rooms, case.outcome,
        _cm(case.error), _cm(case.trajectory), shown(case.located),
    )  # fmt: skip


def body(results: list[dict]) -> Iterator[str]:
    """The generated part of the page."""
    counts = ", ".join(
        f"`situgraph experiment {r['name']}` ({len(r['rows'])} runs, seed {r['seed']})"
        for r in results
    )
    yield f"The worst of {counts}, situgraph {results[0]['situgraph']}.\n\n"
    cases = worst(results)
    yield markdown(Table("", COLUMNS, [row(k, c) for k, c in enumerate(cases, start=1)]))
    yield "\nWhat each of them said on its way:\n\n"
    for number, case in enumerate(cases, start=1):
        yield f"{number}. {case.building}, seed {case.seed}\n"
        yield from (f"   - {line}\n" for line in case.story or ("it said nothing: never unique",))


def _cm(metres: float | None) -> object:
    return None if metres is None else shown(round(100.0 * metres, 1))


if __name__ == "__main__":
    found = [ROOT / "results" / name / f"{name}.json" for name in NAMES]
    missing = [str(p) for p in found if not p.is_file()]
    if missing:
        raise SystemExit(f"failures: {', '.join(missing)} not there; run the experiments first")
    told = "".join(body([json.loads(p.read_text(encoding="utf-8")) for p in found]))
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(PART.sub(lambda m: m[1] + told + m[3], page), encoding="utf-8")
