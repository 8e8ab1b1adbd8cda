"""Put the results of experiments into docs/results: `python scripts/results.py NAME...`.

Run the experiment first (`situgraph experiment NAME`, which leaves results/NAME). The part of
docs/results/NAME.md between `<!-- results -->` and `<!-- end -->` is replaced, the figures are
copied beside the page, and the summary is kept there as JSON with seed, number of rows and version.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path

from situgraph.experiments.tables import markdown, summary_tables

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "results"
PART = re.compile(r"(<!-- results -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def body(result: dict, pictures: list[str]) -> str:
    """The generated part of a page."""
    full = " --full" if result["full"] else ""
    machine = ", ".join(f"{key} {value}" for key, value in result["machine"].items())
    head = (
        f"Printed by `situgraph experiment {result['name']}{full} --seed {result['seed']}`: "
        f"{len(result['rows'])} rows, situgraph {result['situgraph']}; {machine}.\n\n"
    )
    tables = "\n".join(markdown(table) for table in summary_tables(result["summary"]))
    drawn = "".join(f"\n![{Path(p).stem}]({p})\n" for p in pictures)
    return head + tables + drawn


def publish(name: str) -> None:
    """Renew the page of one experiment from results/NAME."""
    folder = ROOT / "results" / name
    source = folder / f"{name}.json"
    if not source.is_file():
        raise SystemExit(f"results: {source} is not there; run `situgraph experiment {name}` first")
    result = json.loads(source.read_text(encoding="utf-8"))
    PAGES.mkdir(parents=True, exist_ok=True)
    pictures = []
    for drawing in sorted(folder.glob("*.png")):
        kept = f"{name}-{drawing.name.removeprefix(f'{name}-')}"
        shutil.copyfile(drawing, PAGES / kept)
        pictures.append(kept)
    page = PAGES / f"{name}.md"
    text = page.read_text(encoding="utf-8") if page.is_file() else f"# {name}\n\n"
    if not PART.search(text):
        text = text.rstrip() + "\n\n<!-- results -->\n<!-- end -->\n"
    generated = body(result, pictures)
    page.write_text(PART.sub(lambda found: found[1] + generated + found[3], text), encoding="utf-8")
    kept_result = {**result, "rows": len(result["rows"])}
    (PAGES / f"{name}.json").write_text(json.dumps(kept_result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    for wanted in sys.argv[1:]:
        publish(wanted)
