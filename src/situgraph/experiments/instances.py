"""How well found instances agree with the true ones: in the building, and in single pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.objects.detections import Detection
from situgraph.scenegraph.graph import Object

NEAR = 0.5  # m in the plan; an object whose centre is farther from the true one is another
LEVEL = 0.8  # m; so far its height may be off: images seldom show a door from sill to lintel
SHARED = 0.5  # intersection over union from which a mask is that of a true instance
SMALL = 400  # px of 640 x 480; smaller true masks are neither asked for nor held against anybody


def matched(found: Sequence[Object], true: Sequence[Object]) -> list[tuple[int, int]]:
    """Pairs (found, true) one to one: same category, centres near, the least sum of distances."""
    from scipy.optimize import linear_sum_assignment

    if not found or not true:
        return []
    a, b = (np.array([o.center for o in side]) for side in (found, true))
    apart = np.linalg.norm(a[:, None, :2] - b[None, :, :2], axis=2)
    same = np.array([[f.category == t.category for t in true] for f in found])
    good = same & (apart < NEAR) & (np.abs(a[:, None, 2] - b[None, :, 2]) < LEVEL)
    rows, columns = linear_sum_assignment(np.where(good, apart, 1e3))
    return [(int(i), int(j)) for i, j in zip(rows, columns) if good[i, j]]


def counts(
    found: Sequence[Object], true: Sequence[Object], asked: set[str], categories: Iterable[str]
) -> dict[str, dict[str, int]]:
    """By category: found objects, those of them that are right, true ones asked for, of them found.

    ``asked`` names the true objects that the drive should have found; another one that was found
    all the same is right, but nobody is blamed for missing it.
    """
    out = {}
    pairs = matched(found, true)
    for category in categories:
        right = [j for i, j in pairs if found[i].category == category]
        wanted = {o.id for o in true if o.category == category and o.id in asked}
        out[category] = {
            "found": sum(o.category == category for o in found),
            "right": len(right),
            "true": len(wanted),
            "recalled": len(wanted & {true[j].id for j in right}),
        }
    return out


def rates(parts: Iterable[dict[str, int]]) -> dict[str, Any]:
    """Precision, recall and F1 of added-up counts; None where there is nothing to divide by."""
    total = {"found": 0, "right": 0, "true": 0, "recalled": 0}
    for part in parts:
        for key in total:
            total[key] += part[key]
    precision = total["right"] / total["found"] if total["found"] else None
    recall = total["recalled"] / total["true"] if total["true"] else None
    f1 = None
    if precision is not None and recall is not None:
        f1 = 2 * precision * recall / (precision + recall) if precision + recall else 0.0
    return {"precision": precision, "recall": recall, "f1": f1, **total}


@dataclass(eq=False)
class FrameScores:
    """Masks of one detector against the true ones, over many pictures."""

    shared: dict[str, int] = field(default_factory=dict)  # px
    either: dict[str, int] = field(default_factory=dict)  # px
    hits: dict[str, list[tuple[float, bool]]] = field(default_factory=dict)  # score, right
    true: dict[str, int] = field(default_factory=dict)  # instances

    def add(
        self,
        detections: Sequence[Detection],
        instances: Sequence[tuple[str, NDArray[np.bool_]]],
        categories: Iterable[str],
    ) -> None:
        """Count one picture: detections against true (category, mask (h, w)) instances."""
        for category in categories:
            ours = sorted((d for d in detections if d.category == category), key=lambda d: -d.score)
            theirs = [m for c, m in instances if c == category]
            if not ours and not theirs:
                continue
            shape = (ours[0].mask if ours else theirs[0]).shape
            empty = np.zeros(shape, dtype=bool)
            a = np.logical_or.reduce([empty, *(d.mask for d in ours)])
            b = np.logical_or.reduce([empty, *theirs])
            _add(self.shared, category, int((a & b).sum()))
            _add(self.either, category, int((a | b).sum()))
            _add(self.true, category, sum(int(m.sum()) >= SMALL for m in theirs))
            self.hits.setdefault(category, []).extend(_claims(ours, theirs))

    def row(self) -> dict[str, Any]:
        """By category: pixel counts and claims, ready to be added up over drives."""
        return {
            c: {
                "shared": self.shared[c], "either": self.either[c], "true": self.true[c],
                "hits": [[round(s, 4), h] for s, h in self.hits[c]],
            }
            for c in self.shared
        }  # fmt: skip


def _claims(
    ours: Sequence[Detection], theirs: Sequence[NDArray[np.bool_]]
) -> list[tuple[float, bool]]:
    """Score and right or wrong of each detection, the surest first to choose."""
    free = set(range(len(theirs)))
    out = []
    for detection in ours:
        overlap = {
            k: int((detection.mask & theirs[k]).sum())
            / max(1, int((detection.mask | theirs[k]).sum()))
            for k in sorted(free)
        }
        best = max(overlap, key=lambda k: overlap[k], default=None)
        right = best is not None and overlap[best] >= SHARED
        if right and best is not None:
            free.discard(best)
            if int(theirs[best].sum()) < SMALL:
                continue
        out.append((float(detection.score), right))
    return out


def _add(table: dict[str, int], key: str, value: int) -> None:
    table[key] = table.get(key, 0) + value


def mask_iou(parts: Iterable[dict[str, Any]]) -> float | None:
    """Intersection over union of all pixels of a category."""
    parts = list(parts)
    either = sum(p["either"] for p in parts)
    return sum(p["shared"] for p in parts) / either if either else None


def average_precision(parts: Iterable[dict[str, Any]]) -> float | None:
    """Area under precision over recall at a mask overlap of 0.5, over all pictures together."""
    parts = list(parts)
    true = sum(p["true"] for p in parts)
    hits = sorted(((s, h) for p in parts for s, h in p["hits"]), key=lambda c: -c[0])
    if not true:
        return None
    if not hits:
        return 0.0
    right = np.cumsum([h for _, h in hits])
    precision = right / np.arange(1, len(hits) + 1)
    best_from_here = np.maximum.accumulate(precision[::-1])[::-1]
    return float(sum(best_from_here[k] for k, (_, h) in enumerate(hits) if h) / true)
