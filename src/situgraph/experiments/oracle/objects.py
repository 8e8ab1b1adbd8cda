"""The evidence of objects at one placement (section 6 of the definition, policy ``likelihood``)."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from situgraph.experiments.oracle.explained import View
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.shared_errors import log_ratio, most_log_ratio, wall_groups
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
    total, claims = _assigned(scene, online, prior)
    sights = {i: _sight_again(scene, o, prior) for i, o in enumerate(online)}
    sights |= {i: prior[j] for i, j in claims}
    total += _shared(scene, [(online[i], q) for i, q in sights.items() if q is not None])
    return total + _missed(scene, prior, {j for _, j in claims})


def most_object_evidence(problem: Problem) -> float:
    """No assignment says more: every online object lies exactly where it should, none is missed."""
    c = problem.constants
    peak = (1 - c.object_tail_share) / (2 * math.pi * c.object_sigma**2)
    near = math.log(
        c.clutter_area * (peak + c.object_tail_share / math.pi / c.object_tail_radius**2)
    )
    shares = _shares(problem)
    bounds = {plane for shape in problem.seen for plane in shape.planes}
    told = [o for o in problem.online.objects if o.category in problem.modelled]
    groups = wall_groups({k: bounds & set(o.planes) for k, o in enumerate(told)})
    return sum(most_log_ratio(len(group), c) for group in groups) + sum(
        max(
            math.log(max(1 - c.miss_of(o.category), c.confusion, c.duplicate_of(o.category)))
            - math.log(shares[o.category])
            + near,
            math.log(c.false_of(o.category)),
        )
        for o in told
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


def _assigned(
    scene: Scene, online: list[Object], prior: list[Object]
) -> tuple[float, list[tuple[int, int]]]:
    """The largest sum over online objects, and which of them claim which prior objects.

    A first sight of a prior object is worth more than a second, so each online object may choose
    freely between a claim of its own and the best of the rest: a second sight, or a false one.
    """
    c = scene.problem.constants
    rest = [
        max([math.log(c.false_of(o.category)), *(_second_sight(scene, o, q) for q in prior)])
        for o in online
    ]
    if not online or not prior:
        return sum(rest), []
    gain = np.array(
        [[max(_first_sight(scene, o, q) - f, 0.0) for q in prior] for o, f in zip(online, rest)]
    )
    rows, columns = linear_sum_assignment(-gain)
    claims = [(int(i), int(j)) for i, j in zip(rows, columns) if gain[i, j] > 0]
    return sum(rest) + sum(float(gain[i, j]) for i, j in claims), claims


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
    return value + math.log(_join(scene, o, q))


def _join(scene: Scene, o: Object, q: Object) -> float:
    """The probability that a sight of ``q`` is in the rooms ``o`` is in, of those that matched."""
    c = scene.problem.constants
    mine = {scene.rooms[r] for r in o.rooms if r in scene.rooms}
    theirs = set(q.rooms) & set(scene.rooms.values())
    if len(mine | theirs) == 1:
        return 1.0
    if mine - theirs:
        return c.wrong_join
    return (1 - c.wrong_join) * (1 - c.half_seen if mine == theirs else c.half_seen)


def _shared(scene: Scene, sights: list[tuple[Object, Object]]) -> float:
    """What the objects of one wall say together, beyond what each says alone."""
    walls = {
        k: {(p, w) for p in o.planes for w in q.planes if (p, w) in scene.planes}
        for k, (o, q) in enumerate(sights)
    }
    errors = [scene.moved(o.center) - np.array(q.center[:2]) for o, q in sights]
    constants = scene.problem.constants
    return sum(log_ratio([errors[k] for k in group], constants) for group in wall_groups(walls))


def _second_sight(scene: Scene, o: Object, q: Object) -> float:
    if o.category != q.category or not _can_be(scene, o, q):
        return -math.inf
    rate = scene.problem.constants.duplicate_of(o.category)
    return math.log(rate / scene.shares[o.category]) + _nearness(scene, o, q)


def _sight_again(scene: Scene, o: Object, prior: list[Object]) -> Object | None:
    """What it is a second sight of, if it is no first one; None where it is rather false."""
    best = max(prior, key=lambda q: _second_sight(scene, o, q), default=None)
    least = math.log(scene.problem.constants.false_of(o.category))
    return best if best is not None and _second_sight(scene, o, best) > least else None


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
