"""The evidence of objects at one placement (section 6 of the definition, policy ``likelihood``)."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from situgraph.experiments.oracle.explained import View
from situgraph.experiments.oracle.problem import Problem
from situgraph.geometry.poses import Array, rotation2
from situgraph.scenegraph.graph import Object


@dataclass(frozen=True, eq=False)
class Scene:
    """The correspondences a placement implies, as objects need them."""

    problem: Problem
    view: View
    rooms: dict[str, str]
    planes: frozenset[tuple[str, str]]
    shares: dict[str, float]

    def moved(self, point: tuple[float, float, float]) -> Array:
        """A map point in the plan of the building (2,)."""
        motion = self.view.motion
        turned = rotation2(motion.yaw) @ (np.array(point[:2]) - self.problem.middle)
        return np.asarray(turned + motion.point)


def object_evidence(problem: Problem, seen: View) -> float:
    """Sum of the events of the likeliest assignment of online to prior objects.

    A graph without any object says nothing: nobody looked for them.
    """
    if not problem.online.objects:
        return 0.0
    scene = _scene(problem, seen)
    online = [
        o
        for o in problem.online.objects
        if o.category in problem.modelled and any(r in scene.rooms for r in o.rooms)
    ]
    matched = set(scene.rooms.values())
    prior = [
        q
        for q in problem.prior.objects
        if q.category in problem.modelled and any(a in matched for a in q.rooms)
    ]
    total, claimed = _assigned(scene, online, prior)
    return total + _missed(scene, prior, claimed)


def most_object_evidence(problem: Problem) -> float:
    """No assignment says more: every online object lies exactly where it should, none is missed."""
    c = problem.constants
    peak = (1 - c.object_tail_share) / (2 * math.pi * c.object_sigma**2)
    near = math.log(
        c.clutter_area * (peak + c.object_tail_share / math.pi / c.object_tail_radius**2)
    )
    shares = _shares(problem)
    return sum(
        max(
            math.log(max(1 - c.miss_of(o.category), c.confusion, c.duplicate_of(o.category)))
            - math.log(shares[o.category])
            + near,
            math.log(c.false_of(o.category)),
        )
        for o in problem.online.objects
        if o.category in problem.modelled
    )


def _scene(problem: Problem, seen: View) -> Scene:
    rooms, planes = {}, set()
    for pair in seen.pairs:
        mine, theirs = problem.seen[pair.r], problem.planned[pair.a]
        rooms[mine.room.id] = theirs.room.id
        planes |= {(mine.planes[p.i], theirs.planes[p.j]) for p in pair.planes if p.j is not None}
    return Scene(problem, seen, rooms, frozenset(planes), _shares(problem))


def _shares(problem: Problem) -> dict[str, float]:
    """The share of each modelled category among the prior's objects."""
    counts = Counter(q.category for q in problem.prior.objects if q.category in problem.modelled)
    floor, everything = problem.constants.least_share, max(1, sum(counts.values()))
    return {c: max(floor, counts[c] / everything) for c in problem.modelled}


def _assigned(scene: Scene, online: list[Object], prior: list[Object]) -> tuple[float, set[int]]:
    """The largest sum over online objects, and the prior objects that are claimed.

    A first sight of a prior object is worth more than a second, so each online object may choose
    freely between a claim of its own and the best of the rest: a second sight, or a false one.
    """
    c = scene.problem.constants
    rest = [
        max([math.log(c.false_of(o.category)), *(_second_sight(scene, o, q) for q in prior)])
        for o in online
    ]
    if not online or not prior:
        return sum(rest), set()
    gain = np.array(
        [[max(_first_sight(scene, o, q) - f, 0.0) for q in prior] for o, f in zip(online, rest)]
    )
    rows, columns = linear_sum_assignment(-gain)
    claims = [(i, j) for i, j in zip(rows, columns) if gain[i, j] > 0]
    return sum(rest) + sum(float(gain[i, j]) for i, j in claims), {int(j) for _, j in claims}


def _can_be(scene: Scene, o: Object, q: Object) -> bool:
    return any(scene.rooms.get(r) in q.rooms for r in o.rooms if r in scene.rooms)


def _first_sight(scene: Scene, o: Object, q: Object) -> float:
    c = scene.problem.constants
    if not _can_be(scene, o, q):
        return -math.inf
    rate = 1 - c.miss_of(o.category) if o.category == q.category else c.confusion
    value = math.log(rate / scene.shares[o.category]) + _nearness(scene, o, q)
    if o.planes and q.planes:
        same = any((p, w) in scene.planes for p in o.planes for w in q.planes)
        value += math.log(1 - c.wrong_wall if same else c.wrong_wall)
    return value


def _second_sight(scene: Scene, o: Object, q: Object) -> float:
    if o.category != q.category or not _can_be(scene, o, q):
        return -math.inf
    rate = scene.problem.constants.duplicate_of(o.category)
    return math.log(rate / scene.shares[o.category]) + _nearness(scene, o, q)


def _nearness(scene: Scene, o: Object, q: Object) -> float:
    """Ln G: where the object is, against anywhere in its room."""
    c = scene.problem.constants
    distance = float(np.linalg.norm(scene.moved(o.center) - np.array(q.center[:2])))
    bell = math.exp(-(distance**2) / (2 * c.object_sigma**2)) / (2 * math.pi * c.object_sigma**2)
    disc = (distance <= c.object_tail_radius) / (math.pi * c.object_tail_radius**2)
    density = (1 - c.object_tail_share) * bell + c.object_tail_share * disc
    return math.log(c.clutter_area * density) if density > 0 else -math.inf


def _missed(scene: Scene, prior: list[Object], claimed: set[int]) -> float:
    """Prior objects that no online object claims, room by room, each room perhaps seen in part."""
    c, total, counted = scene.problem.constants, 0.0, set[int]()
    for room in scene.rooms.values():
        mine = [j for j, q in enumerate(prior) if room in q.rooms and j not in counted]
        counted.update(mine)
        rates = [c.miss_of(prior[j].category) for j in mine]
        hit = [j in claimed for j in mine]

        def chance(share: float, rates: list[float] = rates, hit: list[bool] = hit) -> float:
            return math.prod(
                share * (1 - p) if h else (1 - share) + share * p for p, h in zip(rates, hit)
            )

        part = float(np.mean([chance(share) for share in c.seen_shares]))
        whole = c.seen_whole * chance(1.0) + (1 - c.seen_whole) * part
        total += math.log(whole) - sum(math.log(1 - p) for p, h in zip(rates, hit) if h)
    return total
