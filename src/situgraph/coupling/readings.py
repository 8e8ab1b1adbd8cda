"""Placements near the match's that explain the walls about as well: readings of one view.

A room that is 0.3 m wider than planned says that one of two walls was moved, not which. The match
answers with one placement for all that lie within 0.3 m, and counts faces; here each wall counts
once, with all its faces (``WallLines``), and objects speak along their walls. Each two shifts along
directions that are not parallel propose a placement; all are judged by one likelihood, in which a
wall stands where it was planned, or was moved, or is none of the plan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.deviation import names_of
from situgraph.coupling.evidence import place_of
from situgraph.coupling.lines import WallLines
from situgraph.coupling.reading_options import FaceOptions, ObjectOptions, median_turn
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import SceneGraph

PARALLEL = 0.5  # sine; directions that differ less propose nothing together
SAME_SHIFT = 0.05  # m; shifts this near propose the same
FAMILIES = 4  # wall directions that propose: wings at an angle, and hardly more
REFINED = 24  # proposals that are moved to where their fitting walls agree best
FITS = 0.1  # m


@dataclass(frozen=True)
class Reading:
    """A placement and what speaks against it.

    ``cost`` is the negative log likelihood (nats, against everything in its place); ``moved`` are
    planned faces, one of each wall that was moved if it is right; ``shift`` (m) is where the rooms
    lie then against where the match puts them.
    """

    placement: Placement
    cost: float = 0.0
    moved: tuple[str, ...] = ()
    shift: tuple[float, float] = (0.0, 0.0)


def readings(
    online: SceneGraph,
    prior: SceneGraph,
    placement: Placement,
    storeys: Mapping[str, str],
    lines: WallLines,
    config: CouplingConfig,
) -> tuple[Reading, ...]:
    """The placements near the given one that cannot be told apart, the most probable first.

    Each lies ``config.reading_apart`` and more from those before it and has at least
    ``config.reading_ratio`` of the first one's probability. There is always one.

    Args:
        online: the S-Graph, map frame.
        prior: the plan.
        placement: the match's, map to building.
        storeys: online storey -> planned storey.
        lines: the walls of ``prior``.
        config: how far to look, and how walls and objects are weighed.
    """
    placement = median_turn(online, placement, lines, config)
    faces = FaceOptions(online, placement, storeys, lines, config)
    objects = ObjectOptions(online, prior, placement, config)
    if not faces.count:
        return (Reading(placement),)
    moves = _proposals(faces, config)
    cost = faces.cost(moves) + objects.cost(moves)
    first = np.argsort(cost, kind="stable")[:REFINED]
    moves = np.concatenate([moves[first], faces.fitted(moves[first], FITS)])
    cost = faces.cost(moves) + objects.cost(moves)
    found: list[int] = []
    for k in np.argsort(cost, kind="stable").tolist():
        if found and cost[k] > cost[found[0]] - math.log(config.reading_ratio):
            break
        if all(np.hypot(*(moves[k] - moves[i])) >= config.reading_apart for i in found):
            found.append(k)
    return tuple(
        Reading(
            Placement(placement.x + x, placement.y + y, placement.z, placement.yaw),
            float(cost[k]),
            faces.moved(moves[k], FITS),
            (x, y),
        )
        for k in found
        for x, y in [moves[k].tolist()]
    )


def spread(found: Sequence[Reading]) -> float:
    """How far (m) the readings are apart at most; 0 where there is one."""
    at = np.array([r.shift for r in found])
    return float(max(np.linalg.norm(at - a, axis=1).max() for a in at)) if len(at) else 0.0


def doubt(found: Sequence[Reading], prior: SceneGraph) -> str:
    """What the readings say, in a sentence."""
    best = found[0].cost
    said = []
    for one in found[:3]:
        odds = "" if one is found[0] else f" (1:{math.exp(one.cost - best):.0f})"
        walls = " and ".join(_wall(name, prior) for name in one.moved[:3])
        said.append((f"moved is {walls}" if walls else "no wall was moved") + odds)
    more = "" if len(found) <= 3 else f", and {len(found) - 3} more"
    return (
        f"the walls have {len(found)} readings up to {spread(found):.2f} m apart: "
        f"{', or '.join(said)}{more}"
    )


def _wall(name: str, prior: SceneGraph) -> str:
    x, y, _ = place_of(prior, prior.plane_by_id[name])
    rooms = names_of(prior, prior.rooms_by_plane.get(name, ()))
    return f"the wall of {rooms} at ({x:.1f}, {y:.1f})"


def _proposals(faces: FaceOptions, config: CouplingConfig) -> Array:
    """Shifts (p, 2) of the building under which walls of two directions fit; the first is none."""
    families: list[tuple[Array, list[float]]] = []
    for normal, shift in faces.shifts():
        if abs(shift) > config.reading_reach:
            continue
        for direction, known in families:
            cosine = float(direction @ normal)
            if abs(cosine) > math.cos(config.same_angle):
                known.append(math.copysign(shift, shift * cosine))
                break
        else:
            families.append((normal, [shift]))
    families = sorted(families, key=lambda f: -len(f[1]))[:FAMILIES]
    merged = [(direction, _merged(known)) for direction, known in families]
    found = [np.zeros(2)]
    for i, (a, shifts) in enumerate(merged):
        found += [s * a for s in shifts]
        for b, others in merged[:i]:
            pair = np.array([a, b])
            if abs(float(np.linalg.det(pair))) > PARALLEL:
                both = np.array([(s, t) for s in shifts for t in others])
                found += list(np.linalg.solve(pair, both.T).T)
    moves = np.array(found)
    return np.asarray(moves[np.hypot(*moves.T) <= config.reading_reach])


def _merged(shifts: list[float]) -> list[float]:
    """Mean shifts of those that lie together, and none."""
    means: list[list[float]] = []
    for shift in sorted(shifts):
        if means and shift - means[-1][0] <= SAME_SHIFT:
            means[-1].append(shift)
        else:
            means.append([shift])
    return [0.0, *(sum(m) / len(m) for m in means)]
