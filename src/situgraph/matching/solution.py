"""One solution: where the map lies in the building, and what corresponds to what."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.geometry.poses import Placement
from situgraph.matching.posterior import Posterior
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import FIT, MOVED, Floats, View

if TYPE_CHECKING:
    from situgraph.matching.bent_solution import Answer

LEAST_DEPTH = 0.3  # metres; how far inside a room a centre must lie to be covered by it
LEAST_DEVIATION = 0.1  # metres; smaller ones are not worth telling (DESIGN section 3)


class Deviation(msgspec.Struct, frozen=True):
    """How a wall was built against its plan.

    Attributes:
        plane: the online plane.
        offset: how far it lies along the planned inward normal, metres.
        tilt: how far it is turned in the plan, radians.
        sigma: standard deviation of ``offset``, metres.
    """

    plane: str
    offset: float
    tilt: float
    sigma: float


class Solution:
    """A candidate that the evidence cannot rule out.

    Attributes:
        transform: map to building.
        probability: against all other candidates and 'not in this plan'.
    """

    def __init__(self, inputs: Inputs, posterior: Posterior, rank: int) -> None:
        """The candidate of this rank."""
        self._inputs = inputs
        self._rank = rank
        z, yaw, x, y, height = posterior.candidate[rank].tolist()
        self._at = (yaw, x, y)
        self._shift = int(posterior.shift[rank])
        self.log_likelihood = height
        self.probability = float(posterior.probability[rank])
        c, s = math.cos(yaw), math.sin(yaw)
        mx, my = inputs.middle.tolist()
        ox, oy = inputs.index.origin.tolist()
        self.transform = Placement(x + ox - c * mx + s * my, y + oy - s * mx - c * my, z, yaw)

    @cached_property
    def view(self) -> View:
        """The correspondences as tables."""
        views = self._inputs.views(np.array([self._shift]), np.array([self._at]))
        return View(*(field[0] for field in views))

    @cached_property
    def rooms(self) -> dict[str, str]:
        """Explained online rooms and the prior rooms they are."""
        i, view = self._inputs, self.view
        return {
            i.online.rooms[k].id: i.index.room_ids[a]
            for k, a in zip(i.kept.tolist(), view.room.tolist())
            if a >= 0
        }

    @cached_property
    def storeys(self) -> dict[str, str]:
        """Online storeys and the prior storeys they are, by the rooms explained."""
        i = self._inputs
        found: dict[str, str] = {}
        for one, two in self.rooms.items():
            u, v = i.online.room_by_id[one].storey, i.index.prior.room_by_id[two].storey
            if u and v and u not in found and v not in found.values():
                found[u] = v
        return found

    @cached_property
    def _best_rows(self) -> dict[int, int]:
        """For each online plane with a counterpart its best row: fitting, moved; then nearest."""
        view, source = self.view, self._inputs.source
        order = sorted(
            np.flatnonzero((view.state == FIT) | (view.state == MOVED)).tolist(),
            key=lambda k: (view.state[k], abs(view.offset[k]), k),
        )
        rows: dict[int, int] = {}
        taken: set[int] = set()
        for k in order:
            prior = int(self._inputs.index.source[view.row[k]])
            if int(source[k]) not in rows and prior not in taken:
                rows[int(source[k])] = k
                taken.add(prior)
        return rows

    @cached_property
    def planes(self) -> dict[str, str]:
        """Online planes and the prior planes they are, moved ones too; one to one."""
        i = self._inputs
        prior = i.index.prior.planes
        return {
            i.online.planes[p].id: prior[int(i.index.source[self.view.row[k]])].id
            for p, k in sorted(self._best_rows.items())
        }

    @cached_property
    def objects(self) -> dict[str, str]:
        """Online objects and the prior objects they most likely are."""
        i = self._inputs
        if not i.weighs_objects:
            return {}
        _, claims = i.evidence(np.array([self._shift]), np.array([self._at]))
        planned = i.index.objects.ids
        pairs = zip(i.object_ids, claims[0].tolist())
        return {mine: planned[theirs] for mine, theirs in pairs if theirs >= 0}

    @cached_property
    def also_covers(self) -> dict[str, list[str]]:
        """Further prior rooms whose centres lie within an explained online room."""
        i, taken = self._inputs, set(self.rooms.values())
        turned = Placement(self._at[1], self._at[2], 0.0, self._at[0])
        found: dict[str, list[str]] = {}
        for k in np.flatnonzero(self.view.room >= 0).tolist():
            normal, offset = self._walls(k, turned)
            if not _enclosed(normal):
                continue
            storey = i.index.table.storey[self.view.room[k]]
            inside = (i.index.center @ normal.T + offset > LEAST_DEPTH).all(axis=1)
            inside &= i.index.table.storey == storey
            covered = [r for a in np.flatnonzero(inside) if (r := i.index.room_ids[a]) not in taken]
            if covered:
                found[i.online.rooms[int(i.kept[k])].id] = covered
        return found

    def _walls(self, room: int, at: Placement) -> tuple[Floats, Floats]:
        """The walls of a countable online room in the plan: normals (n, 2), offsets (n,)."""
        seen = self._inputs.seen
        rows = slice(int(seen.first[room]), int(seen.first[room + 1]))
        angle = seen.angle[rows] + at.yaw
        normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        center = at.points(seen.center[room])
        return normal, seen.distance[rows] - normal @ center

    @property
    def moved(self) -> int:
        """How many distinct online planes lie off their plan by more than fitting allows."""
        best = self._best_rows
        return sum(1 for k in best.values() if self.view.state[k] == MOVED)

    @cached_property
    def _fits(self) -> Floats:
        fits: Floats = self.view.offset[self.view.state == FIT]
        return fits

    @property
    def rms(self) -> float:
        """Root mean square of the offsets of the planes that fit, metres."""
        return float(np.sqrt(np.mean(self._fits**2)))

    @property
    def score(self) -> float:
        """How well the online planes agree, 0 to 1: the mean over all rows of the online rooms.

        A plane that fits counts between 0.6 and 1 by its offset, a moved one 0.25, others nothing.
        """
        fit = self._inputs.config.plane_offset_tolerance
        moved = int((self.view.state == MOVED).sum())
        good = float(np.exp(-0.5 * (self._fits / fit) ** 2).sum())
        return (good + 0.25 * moved) / len(self.view.state)

    @cached_property
    def deviations(self) -> tuple[Deviation, ...]:
        """Walls that lie off their plan by more than 0.1 m and three standard deviations."""
        return tuple(self._deviations())

    def _deviations(self) -> list[Deviation]:
        i, view = self._inputs, self.view
        covariance = self._covariance()
        c, s = math.cos(self._at[0]), math.sin(self._at[0])
        room = np.repeat(np.arange(len(i.kept)), np.diff(i.seen.first))
        found = []
        for p, k in sorted(self._best_rows.items()):
            n = i.index.table.row[view.row[k], :2]
            x, y = i.seen.center[room[k]]
            arm = np.array([c * x - s * y, s * x + c * y])
            slope = np.array([n[1] * arm[0] - n[0] * arm[1], n[0], n[1]])
            sigma = math.sqrt(i.sigma**2 + float(slope @ covariance @ slope))
            if abs(view.offset[k]) > max(LEAST_DEVIATION, 3 * sigma):
                found.append(
                    Deviation(
                        i.online.planes[p].id, -float(view.offset[k]), float(view.bend[k]), sigma
                    )
                )
        return found

    def _covariance(self) -> Floats:
        """Covariance (yaw, x, y) of the placement by the planes that fit."""
        i, view = self._inputs, self.view
        room = np.repeat(np.arange(len(i.kept)), np.diff(i.seen.first))
        rows = np.flatnonzero(view.state == FIT)
        n = i.index.table.row[view.row[rows], :2]
        arm = Placement(yaw=self._at[0]).vectors(i.seen.center[room[rows]])
        slope = np.stack([n[:, 1] * arm[:, 0] - n[:, 0] * arm[:, 1], n[:, 0], n[:, 1]], axis=1)
        information = slope.T @ slope / i.sigma**2
        information[0, 0] += len(rows) / i.config.angle_sigma**2
        covariance: Floats = np.asarray(np.linalg.inv(information), dtype=float)
        return covariance

    def to_dict(self) -> dict[str, Any]:
        """A solution of the match JSON."""
        return written(self)


def written(solution: Answer) -> dict[str, Any]:
    """What every solution of the match JSON has."""
    return {
        "transform": msgspec.to_builtins(solution.transform),
        "storeys": solution.storeys,
        "rooms": solution.rooms,
        "also_covers": solution.also_covers,
        "planes": solution.planes,
        "objects": solution.objects,
        "score": solution.score,
        "probability": solution.probability,
        "rms": solution.rms,
        "deviations": [msgspec.to_builtins(d) for d in solution.deviations],
    }


def _enclosed(normals: Floats) -> bool:
    """Whether walls with these normals (n, 2) bound a room on all sides."""
    angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
    gaps = np.diff(angles, append=angles[0] + 2 * math.pi)
    return bool(gaps.max() < math.pi - 0.2)
