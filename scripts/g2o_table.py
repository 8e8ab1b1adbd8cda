"""Print what each .g2o log under a folder holds, as a Markdown table (used by docs/g2o.md)."""

from __future__ import annotations

import sys
from pathlib import Path

from situgraph.errors import InputError
from situgraph.io.g2o import Part, read_g2o


def cells(path: Path, part: Part) -> list[str]:
    try:
        graph = read_g2o(path, part)
    except InputError:
        return ["0", "0", "0", "0"]
    corridors = sum(len(room.planes) == 2 for room in graph.rooms)
    bounding = {plane for room in graph.rooms for plane in room.planes}
    return [
        str(len(graph.rooms)),
        str(corridors),
        f"{len(graph.planes)} ({len(bounding)} bound a room)",
        str(len(graph.keyframes)),
    ]


folder = Path(sys.argv[1])
print("| log | part | rooms | of them corridors | planes | keyframes |\n|---|---|---|---|---|---|")
for log in sorted(folder.rglob("*.g2o")):
    for part in ("free", "fixed"):
        row = cells(log, part)
        if row[0] != "0":
            print("| " + " | ".join([str(log.parent.relative_to(folder)), part, *row]) + " |")
