"""What is odd about the doors and windows: no room, or a space boundary that says otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec

from situgraph.plan.contents import Placed
from situgraph.plan.rooms import RoomShape
from situgraph.scenegraph.graph import Scalar, Warning


class Audit(msgspec.Struct, frozen=True):
    """Agreement with space boundaries: ``checked`` and ``agreed`` by category, and the odd ones.

    ``differing`` gives, for each object number, the names of the rooms the boundaries say.
    """

    checked: Mapping[str, int]
    agreed: Mapping[str, int]
    differing: Mapping[int, tuple[str, ...]]

    def attributes(self) -> dict[str, Scalar]:
        """As attributes of the graph."""
        out: dict[str, Scalar] = {}
        for category in sorted(self.checked):
            out[f"boundaries_{category}_checked"] = self.checked[category]
            out[f"boundaries_{category}_agreed"] = self.agreed[category]
        return out


def audit(
    boundaries: Mapping[int, Sequence[int]], placed: Sequence[Placed], rooms: Sequence[RoomShape]
) -> Audit:
    """Compare the rooms found by geometry with those the file's space boundaries name.

    A door or window is checked when at least one space boundary names it. ``boundaries`` gives the
    spaces (keys) by the key of the door or window.
    """
    names = {room.element.key: room.element.name or room.element.guid for room in rooms}
    checked: dict[str, int] = {}
    agreed: dict[str, int] = {}
    differing: dict[int, tuple[str, ...]] = {}
    for number, item in enumerate(placed):
        said = boundaries.get(item.source.key)
        if said is None or item.category not in ("door", "window"):
            continue
        known = {key for key in said if key in names}
        found = {rooms[r].element.key for r in item.rooms}
        checked[item.category] = checked.get(item.category, 0) + 1
        agreed[item.category] = agreed.get(item.category, 0) + (known == found)
        if known != found:
            differing[number] = tuple(names[key] for key in sorted(known))
    return Audit(checked, agreed, differing)


def boundary_warnings(
    audited: Audit, placed: Sequence[Placed], rooms: Sequence[RoomShape]
) -> Iterator[Warning]:
    """One warning for each door or window whose space boundaries name other rooms."""
    for number, said in audited.differing.items():
        item = placed[number]
        found = [rooms[r].element.name or rooms[r].element.guid for r in item.rooms]
        message = (
            f"{item.category} {item.source.name or item.source.guid} stands in "
            f"{_names(found)} by geometry, in {_names(said)} by its space boundaries; "
            "geometry counts"
        )
        yield Warning("boundary-differs", message, (f"o{number}", *(f"r{r}" for r in item.rooms)))


def homeless(placed: Sequence[Placed]) -> Iterator[Warning]:
    """Objects in no room, and doors and windows that are in a room but on none of its faces."""
    for code, what, lost in (
        ("without-room", "in no room", [not p.rooms for p in placed]),
        ("on-no-plane", "in a room, on none of its faces", [_is_loose(p) for p in placed]),
    ):
        for category in sorted({p.category for p, flag in zip(placed, lost, strict=True) if flag}):
            if category not in ("door", "window") and code == "on-no-plane":
                continue
            numbers = [i for i, p in enumerate(placed) if lost[i] and p.category == category]
            guids = ", ".join(placed[i].source.guid for i in numbers)
            message = f"{len(numbers)} {category} objects are {what}: {guids}"
            yield Warning(f"{category}-{code}", message, tuple(f"o{i}" for i in numbers))


def _is_loose(item: Placed) -> bool:
    return bool(item.rooms) and not item.faces


def _names(names: Sequence[str]) -> str:
    return " and ".join(sorted(names)) if names else "no room"
