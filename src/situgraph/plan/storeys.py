"""Storeys as the floors of their rooms show them; the declared elevation is only compared."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.plan.building import Level
from situgraph.plan.config import PlanConfig
from situgraph.plan.digits import metres
from situgraph.plan.rooms import RoomShape
from situgraph.scenegraph.graph import Scalar, Storey, Warning


class Storeys(msgspec.Struct, frozen=True):
    """Storeys from low to high, the number of each room's storey, and what was odd."""

    storeys: tuple[Storey, ...]
    of_room: tuple[int, ...]
    warnings: tuple[Warning, ...]


class _Group(msgspec.Struct):
    """Rooms on one floor: the level they were declared on, if any, and their numbers."""

    level: Level | None
    rooms: list[int]


def find_storeys(
    levels: Sequence[Level], rooms: Sequence[RoomShape], config: PlanConfig
) -> Storeys:
    """Group rooms to storeys: by the storey they are declared in, unless their floors disagree.

    Rooms of one declared storey whose floors lie more than ``storey_split`` apart are told apart.
    Rooms without a storey join the one nearest to their floor, or make a new one.
    """
    by_key = {level.key: level for level in levels}
    floors = [room.bottom for room in rooms]
    areas = [room.outline.area for room in rooms]
    declared: dict[int, list[int]] = {}
    loose: list[int] = []
    for number, room in enumerate(rooms):
        level = room.element.level
        declared.setdefault(level, []).append(number) if level in by_key else loose.append(number)
    groups: list[_Group] = []
    stray: list[int] = []
    for key, members in declared.items():
        first, *others = _clusters(members, floors, areas, config.storey_split)
        groups.append(_Group(by_key[key], first))
        stray += [number for cluster in others for number in cluster]
    for cluster in _clusters(stray + loose, floors, areas, config.storey_split):
        _settle(cluster, groups, floors, areas, config.storey_split)
    groups.sort(key=lambda g: (round(_floor(g.rooms, floors, areas), 3), min(g.rooms)))
    of_room = {number: i for i, g in enumerate(groups) for number in g.rooms}
    storeys = _storeys(groups, rooms, floors, areas)
    warnings = list(_warnings(groups, storeys, levels, stray, loose, config))
    return Storeys(storeys, tuple(of_room[n] for n in range(len(rooms))), tuple(warnings))


def _clusters(
    members: Sequence[int], floors: Sequence[float], areas: Sequence[float], split: float
) -> list[list[int]]:
    """Members with floors near each other, the cluster with the largest area first."""
    out: list[list[int]] = []
    for number in sorted(members, key=lambda n: (floors[n], n)):
        if out and floors[number] - floors[out[-1][-1]] <= split:
            out[-1].append(number)
        else:
            out.append([number])
    return sorted(out, key=lambda c: (-sum(areas[n] for n in c), floors[c[0]]))


def _settle(
    cluster: list[int],
    groups: list[_Group],
    floors: Sequence[float],
    areas: Sequence[float],
    split: float,
) -> None:
    """Join the group with the nearest floor when it is near enough, else make a new one."""
    floor = _floor(cluster, floors, areas)
    distances = [abs(_floor(g.rooms, floors, areas) - floor) for g in groups]
    if distances and min(distances) <= 0.5 * split:
        groups[int(np.argmin(distances))].rooms.extend(cluster)
    else:
        groups.append(_Group(None, list(cluster)))


def _floor(members: Sequence[int], floors: Sequence[float], areas: Sequence[float]) -> float:
    """The floor height above and below which half of the area lies."""
    order = sorted(members, key=lambda n: (floors[n], n))
    reached = np.cumsum([areas[n] for n in order])
    return floors[order[int(np.searchsorted(reached, 0.5 * reached[-1]))]]


def _storeys(
    groups: Sequence[_Group],
    rooms: Sequence[RoomShape],
    floors: Sequence[float],
    areas: Sequence[float],
) -> tuple[Storey, ...]:
    elevations = [_floor(g.rooms, floors, areas) for g in groups]
    out = []
    for i, group in enumerate(groups):
        above = [e for e in elevations if e > elevations[i] + 0.5]
        ceiling = float(np.median([rooms[n].top for n in group.rooms])) - elevations[i]
        attributes: dict[str, Scalar] = {}
        if group.level is not None:
            attributes = {"guid": group.level.guid, "declared_elevation": group.level.elevation}
        out.append(
            Storey(
                id=f"s{i}",
                name=group.level.name if group.level is not None else None,
                elevation=metres(elevations[i]),
                height=metres(min(above) - elevations[i] if above else ceiling),
                attributes=attributes,
            )
        )
    return tuple(out)


def _warnings(
    groups: Sequence[_Group],
    storeys: Sequence[Storey],
    levels: Sequence[Level],
    stray: Sequence[int],
    loose: Sequence[int],
    config: PlanConfig,
) -> list[Warning]:
    found = []
    for storey in storeys:
        declared = storey.attributes.get("declared_elevation")
        if not isinstance(declared, float):
            continue
        if abs(declared - storey.elevation) > config.storey_tolerance:
            message = (
                f"storey {storey.name or storey.id} is declared at {declared:.2f} m, its floors "
                f"are at {storey.elevation:.2f} m; the floors count"
            )
            found.append(Warning("storey-elevation", message, (storey.id,)))
    used = {g.level.key for g in groups if g.level is not None}
    empty = [level for level in levels if level.key not in used]
    if empty:
        names = ", ".join(level.name or level.guid for level in empty)
        message = f"{len(empty)} declared storeys have no rooms and are left out: {names}"
        found.append(Warning("storey-without-rooms", message, tuple(level.guid for level in empty)))
    for numbers, code, why in (
        (stray, "room-off-storey", "stand far from the floor of the storey they are declared in"),
        (loose, "room-without-storey", "name no storey"),
    ):
        if numbers:
            message = f"{len(numbers)} rooms {why} and are grouped by their floors"
            found.append(Warning(code, message, tuple(f"r{n}" for n in sorted(numbers))))
    return found
