"""What ``situgraph match --explain`` says: what each stage kept, and how two rooms compare."""

from __future__ import annotations

import difflib
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from situgraph.cli.console import console, print_table
from situgraph.errors import InputError

if TYPE_CHECKING:
    from situgraph.scenegraph.graph import Room, SceneGraph

OPPOSITE = -0.95  # dot product of the normals of two walls that face each other (within 18 degrees)


def find_room(graph: SceneGraph, key: str, source: Path) -> Room:
    """The room of that id.

    Raises:
        InputError: there is none; the nearest id is named.
    """
    room = graph.room_by_id.get(key)
    if room is None:
        near = difflib.get_close_matches(key, graph.room_by_id, n=1)
        remedy = f"the nearest is {near[0]}" if near else f"the first is {graph.rooms[0].id}"
        raise InputError(source, f'no room has the id "{key}"', remedy)
    return room


def widths(graph: SceneGraph, room: Room) -> list[float]:
    """Distances (m) between walls of the room that face each other, longest first."""
    import numpy as np

    normals, offsets = graph.plane_arrays(room.planes)
    reach = normals @ np.array(room.center) + offsets
    first, second = np.nonzero(np.triu(normals @ normals.T < OPPOSITE))
    return sorted((reach[first] + reach[second]).tolist(), reverse=True)


def print_stages(stats: dict[str, Any]) -> None:
    """How many pairs each stage of the search kept."""
    stages = ("type", "semantic", "geometric")
    rows = [
        ("room pairs", *(stats["room_candidates"].get(s) for s in stages)),
        ("plane pairs", *(stats["plane_candidates"].get(s) for s in stages)),
    ]
    print_table("What each stage kept", ("", "by type", "semantic", "geometric"), rows)
    text = f"hypotheses {stats['hypotheses']}, candidates {stats['candidates']}, "
    console().print(text + ("search complete" if stats["complete"] else "search cut short"))


def print_pair(
    match: dict[str, Any], online: SceneGraph, prior: SceneGraph, seen: Room, planned: Room
) -> None:
    """Two rooms side by side, and in how many solutions they are matched."""
    rows = [
        ("walls", len(seen.planes), len(planned.planes)),
        ("widths m", _metres(widths(online, seen)), _metres(widths(prior, planned))),
        *_contents(online, prior, seen, planned),
    ]
    columns = ("", f"online {seen.id}", f"prior {planned.id}")
    print_table("The two rooms", columns, [tuple(map(str, row)) for row in rows])
    partners = Counter(s["rooms"].get(seen.id) for s in match["solutions"])
    listed = len(match["solutions"])
    others = ", ".join(f"{room or 'no room'} in {n}" for room, n in partners.most_common(5))
    text = f"matched in {partners[planned.id]} of {listed} solutions; online {seen.id} is {others}"
    console().print(text if listed else "no placement explains enough rooms", soft_wrap=True)


def _metres(values: list[float]) -> str:
    return " x ".join(f"{v:.2f}" for v in values[:4]) or "unknown"


def _contents(
    online: SceneGraph, prior: SceneGraph, seen: Room, planned: Room
) -> list[tuple[str, int, int]]:
    """Objects by category in both rooms."""
    counts = [
        Counter(item.category for item in graph.objects_by_room.get(room.id, ()))
        for graph, room in ((online, seen), (prior, planned))
    ]
    return [(name, counts[0][name], counts[1][name]) for name in sorted(counts[0] | counts[1])]
