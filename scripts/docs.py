"""Print the tables and figures of docs/ anew: `make docs`, or `python scripts/docs.py PAGE`.

A page says which command prints a part of it:

    <!-- output of: situgraph --help -->       the output, as a block of text
    <!-- table of: python scripts/settings_table.py -->   the output, as Markdown
    <!-- end -->

What stands before `<!-- end -->` is replaced. Only `situgraph` and `python` are run, without a
shell. A command that needs the real inputs names them by `../shared/data`; where they are absent
it is passed over.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PART = re.compile(r"(<!-- (output|table) of: (.+?) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
PROGRAMS = {
    "situgraph": [sys.executable, "-m", "situgraph.cli"],
    "python": [sys.executable],
}


def printed(command: str) -> str | None:
    """What the command prints; None when its inputs are not here."""
    program, *arguments = shlex.split(command)
    if program not in PROGRAMS:
        raise SystemExit(f"docs: {command}: only {' and '.join(PROGRAMS)} are run")
    if "../shared/data" in command and not (ROOT / "../shared/data").is_dir():
        print(f"docs: passed over, no real inputs here: {command}", file=sys.stderr)
        return None
    print(f"docs: {command}", file=sys.stderr)
    process = subprocess.run(
        [*PROGRAMS[program], *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if process.returncode != 0:
        raise SystemExit(f"docs: {command} failed: {process.stderr.strip()[-500:]}")
    return process.stdout or process.stderr


def renewed(page: str) -> str:
    def part(found: re.Match[str]) -> str:
        head, kind, command, _, end = found.groups()
        text = printed(command)
        if text is None:
            return found.group()
        body = text.rstrip() + "\n"
        return head + (f"```\n{body}```\n" if kind == "output" else body) + end

    return PART.sub(part, page)


def main() -> None:
    pages = [Path(p) for p in sys.argv[1:]] or sorted((ROOT / "docs").rglob("*.md"))
    for path in pages:
        old = path.read_text(encoding="utf-8")
        new = renewed(old)
        if new != old:
            path.write_text(new, encoding="utf-8")
            print(f"docs: {path.name} has changed", file=sys.stderr)


if __name__ == "__main__":
    main()
