"""Why an online room was, or was not, matched to a prior room: the stage that decided, and why."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import msgspec
import numpy as np

from situgraph.geometry.poses import Placement
from situgraph.matching.bent_result import BentResult
from situgraph.matching.bent_solution import Answer
from situgraph.matching.preparation import Inputs
from situgraph.matching.result import MatchResult
from situgraph.matching.tables import explaining
from situgraph.scenegraph.graph import Object, Room, SceneGraph

Stage = Literal["type", "semantic", "geometric", "placement", "likelihood", "matched"]
MOST_PLACES = 40  # placements of the pair alone that are tried for all rooms


class Explanation(NamedTuple):
    """The stage at which a pair of rooms was dropped, or ``matched``, and a sentence."""

    stage: Stage
    sentence: str


class _Attempt(NamedTuple):
    """Two walls of each room laid onto each other: what becomes of the others."""

    good: int  # walls with a counterpart
    worst: str  # the online wall that is farthest off
    offset: float | None  # by how much, metres; None when no wall has its direction


def explain_pair(result: MatchResult, mine: str, theirs: str) -> Explanation:
    """What became of the pair of an online and a prior room (ids), stage by stage.

    Raises:
        KeyError: there is no such room.
    """
    inputs = result.inputs
    one, two = inputs.online.room_by_id[mine], inputs.index.prior.room_by_id[theirs]
    for k, solution in enumerate(_all_solutions(result)):
        if solution.rooms.get(mine) == theirs:
            chance = f"{100 * solution.probability:.3g} %"
            return Explanation("matched", f"matched in solution {k + 1} ({chance})")
    dropped = _by_type(inputs, one, two) or _by_objects(inputs, one, two)
    if dropped is not None:
        return dropped
    if isinstance(result, BentResult) and (left := result.left_out(mine)):
        text = f"it is in a part of the map ({left} rooms) that fits nowhere beside the other parts"
        return Explanation("placement", text)
    places = _alone(inputs, one, two)
    if not places:
        held = _by_faces(inputs, one, two)
        return held or Explanation("geometric", _misfit(inputs, one, two))
    return _by_placement(result, one, two, places)


def _all_solutions(result: MatchResult) -> Iterator[Answer]:
    """Listed or not."""
    yield from result.solutions
    for rank in range(len(result.solutions), result.count):
        solution = result.candidate(rank)
        assert solution is not None
        yield solution


def _by_type(inputs: Inputs, one: Room, two: Room) -> Explanation | None:
    """Rooms with fewer than two walls that can be used do not count."""
    counted = {inputs.online.rooms[k].id for k in inputs.kept.tolist()}
    for room, known in ((one, counted), (two, set(inputs.index.room_ids))):
        if room.id not in known:
            text = f"room {room.id} has fewer than two walls that can be used"
            return Explanation("type", text)
    return None


def _by_objects(inputs: Inputs, one: Room, two: Room) -> Explanation | None:
    """The paper's filter at room level."""
    if inputs.semantics != "containment":
        return None
    online, prior = inputs.online, inputs.index.prior
    seen, planned = online.objects_by_room.get(one.id, ()), prior.objects_by_room.get(two.id, ())
    lacking = _lacking(seen, planned, prior)
    return Explanation("semantic", lacking) if lacking else None


def _by_faces(inputs: Inputs, one: Room, two: Room) -> Explanation | None:
    """The paper's filter at plane level, where it alone keeps the rooms' walls from each other."""
    from situgraph.matching.index import PlanIndex
    from situgraph.matching.matcher import match

    if inputs.semantics != "containment":
        return None
    online, prior = inputs.online, inputs.index.prior
    index = PlanIndex(prior.replace(rooms=(two,)), inputs.config)
    bare = match(online.replace(rooms=(one,)), index, semantics="none")
    told: list[list[str]] = []
    for rank in range(bare.candidates):
        walls: list[str] = []
        for mine, theirs in bare.candidate(rank).planes.items():  # type: ignore[union-attr]
            seen = [o for o in online.objects_by_plane.get(mine, ()) if one.id in o.rooms]
            planned = [o for o in prior.objects_by_plane.get(theirs, ()) if two.id in o.rooms]
            lacking = _lacking(seen, planned, prior)
            walls += [f"wall {mine}: {lacking} on {theirs}"] if lacking else []
        told.append(walls)
    fewest = min(told, key=len, default=[])
    return Explanation("semantic", "; ".join(fewest)) if fewest else None


def _lacking(seen: Sequence[Object], planned: Sequence[Object], prior: SceneGraph) -> str:
    """Of which categories that the prior models more were seen than planned, in words."""
    need, have = Counter(o.category for o in seen), Counter(o.category for o in planned)
    return ", ".join(
        f"{category} count {count} > {have[category]}"
        for category, count in sorted(need.items())
        if category in prior.modelled and count > have[category]
    )


def _alone(inputs: Inputs, one: Room, two: Room) -> list[Placement]:
    """The placements at which the prior room explains the online room, all others aside."""
    from situgraph.matching.candidates import Known
    from situgraph.matching.index import PlanIndex
    from situgraph.matching.preparation import prepare

    config = msgspec.structs.replace(inputs.config, rival_ratio=0.0)
    index = PlanIndex(inputs.index.prior.replace(rooms=(two,)), config)
    pair = prepare(inputs.online.replace(rooms=(one,)), index, inputs.semantics, config)
    place = Known().find(pair, explaining(1, pair.count)).place
    best = place[np.argsort(-place[:, 4], kind="stable")][:MOST_PLACES]
    found = []
    for z, yaw, x, y, _ in best.tolist():
        c, s = math.cos(yaw), math.sin(yaw)
        mx, my = pair.middle.tolist()
        ox, oy = index.origin.tolist()
        found.append(Placement(x + ox - c * mx + s * my, y + oy - s * mx - c * my, z, yaw))
    return found


def _by_placement(
    result: MatchResult, one: Room, two: Room, places: list[Placement]
) -> Explanation:
    """No placement that is good for the pair is good for enough other rooms, or likely enough."""
    inputs = result.inputs
    most = max(_explained(inputs, places))
    least, rooms, _ = result.figures
    if most < least:
        text = (
            f"the two are alike, but where they are put onto each other at most {most} of {rooms} "
            f"rooms are explained, and {least} are needed"
        )
        return Explanation("placement", text + _where(result, one, two))
    for rank in range(result.count, result.candidates):
        candidate = result.candidate(rank)
        if candidate is not None and candidate.rooms.get(one.id) == two.id:
            short = _best_likelihood(result) - candidate.log_likelihood
            text = (
                f"candidate {rank + 1} matches them; its log-likelihood is {-short:.1f} to the best"
            )
            return Explanation("likelihood", text)
    text = "the two are alike, but each candidate explains the online room better by another room"
    return Explanation("likelihood", text + _where(result, one, two))


def _best_likelihood(result: MatchResult) -> float:
    best = result.candidate(0)
    return best.log_likelihood if best is not None else math.nan


def _explained(inputs: Inputs, places: list[Placement]) -> Iterator[int]:
    """How many online rooms each placement explains."""
    at = np.empty((len(places), 3))
    shift = np.empty(len(places), dtype=np.int64)
    for k, place in enumerate(places):
        x, y = Placement(place.x, place.y, 0.0, place.yaw).points(inputs.middle)
        at[k] = place.yaw, x - inputs.index.origin[0], y - inputs.index.origin[1]
        shift[k] = int(np.abs(inputs.shifts - place.z).argmin())
    views = inputs.views(shift, at)
    yield from (views.room >= 0).sum(axis=1).tolist()


def _where(result: MatchResult, one: Room, two: Room) -> str:
    """Where the best solution has the online room."""
    if result.best is None:
        return ""
    x, y, _ = result.best.transform.points(np.array(one.center)).tolist()
    apart = math.hypot(x - two.center[0], y - two.center[1])
    there = result.best.rooms.get(one.id)
    text = f"; the best solution has it {apart:.2f} m from there"
    return f"{text}, as {there}" if there else text


def _misfit(inputs: Inputs, one: Room, two: Room) -> str:
    """Which wall keeps the prior room from explaining the online room."""
    online, prior, config = inputs.online, inputs.index.prior, inputs.config
    mine, reach = online.plane_arrays(one.planes)
    theirs, offset = prior.plane_arrays(two.planes)
    reach = (mine @ np.array(one.center) + reach) / np.hypot(*mine[:, :2].T)
    offset = offset + theirs[:, 2] * two.center[2]
    offset = offset / np.hypot(*theirs[:, :2].T)
    first, second = np.arctan2(mine[:, 1], mine[:, 0]), np.arctan2(theirs[:, 1], theirs[:, 0])
    best: _Attempt | None = None
    for i in range(len(first)):
        for j in range(len(second)):
            turned = np.arctan2(
                np.sin(first[:, None] + second[j] - first[i] - second[None]),
                np.cos(first[:, None] + second[j] - first[i] - second[None]),
            )
            same = np.abs(turned) <= config.angle_tolerance
            for k, m in zip(*np.nonzero(same & (np.abs(np.sin(first - first[i])) > 0.3)[:, None])):
                lines = np.array(
                    [[np.cos(second[j]), np.sin(second[j])], [np.cos(second[m]), np.sin(second[m])]]
                )
                if abs(np.linalg.det(lines)) < config.parallel_sine / 2:
                    continue
                at = np.linalg.solve(lines, [reach[i] - offset[j], reach[k] - offset[m]])
                normals = np.stack([np.cos(second), np.sin(second)], axis=1)
                off = np.where(same, np.abs(reach[:, None] - (normals @ at + offset)), np.inf)
                nearest = off.min(axis=1)
                worst = int(nearest.argmax())
                good = int((nearest <= config.moved_limit).sum())
                value = float(nearest[worst])
                tried = _Attempt(good, one.planes[worst], value if np.isfinite(value) else None)
                if best is None or (tried.good, -value) > (
                    best.good,
                    -(math.inf if best.offset is None else best.offset),
                ):
                    best = tried
    if best is None:
        return "no two walls of the one meet like two of the other"
    how = "has no wall of its direction" if best.offset is None else f"is {best.offset:.2f} m off"
    return (
        f"at best {best.good} of {len(first)} walls have a counterpart; {best.worst} {how} "
        f"(fits up to {config.plane_offset_tolerance:g} m, moved up to {config.moved_limit:g} m)"
    )
