"""The sieve counts marked rooms for all cells at once: it keeps every place where enough are."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry
from situgraph.matching.preparation import prepare
from situgraph.matching.records import record_at
from situgraph.matching.sieve import sift
from situgraph.matching.sifted import sift_for
from situgraph.matching.tables import KEPT, NEEDED, PARTED, SIFTED, Case
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN, REALISTIC, SamplerConfig


@entry
def sifted(place):  # type: ignore[no-untyped-def]
    """Run the sieve of a case."""
    sift(record_at(place, Case))


@entry
def sifted_for(place):  # type: ignore[no-untyped-def]
    """What the sieve of a case leaves to the first group."""
    sift_for(record_at(place, Case), 0)


FEW, MANY = (12, 100, REALISTIC), (900, 1000, CLEAN)  # rooms seen, planned, errors


def drawn(rooms: int, planned: int, errors: SamplerConfig) -> tuple[Block, Any]:
    """A case of so many rooms, whose maps are drawn and have no marks; and what it is made of."""
    plan = make_layout("random", planned, 0)
    inputs = prepare(
        sample_online(plan, rooms, 0, errors).online, PlanIndex(plan), "none", MatchingConfig()
    )
    case = Block(Case, inputs.tables.sizes(peaks=8, maps=True), **inputs.tables.given(inputs.aim))
    case.array("ground.drawn")[:] = 1
    case.array("found.alike")[:] = case.array("groups.told")[0] = planned
    return case, inputs


def mark(case: Block, index: PlanIndex, r: int, quarter: int, x: float, y: float) -> None:
    """Mark the cell of a place and those beside it, the nearest of the map for each."""
    wide, tall = index.table.cells.tolist()
    maps = case.array("ground.marks").view(np.uint64).reshape(-1, 2, wide, tall)
    corner = index.table.corner
    column, row = (math.floor((v - o) * corner[2]) for v, o in zip((x, y), corner))
    for c in range(column - 1, column + 2):
        at = min(max(c, 0), 64 * wide - 1)
        low, high = (min(max(v, 0), tall - 1) for v in (row - 1, row + 1))
        maps[r, quarter % 2, at // 64, low : high + 1] |= np.uint64(1 << (at % 64))


def left(case: Block) -> set[tuple[int, int, int]]:
    """Quarter, column and row of the cells that are left."""
    told = case.array("sieve.told")
    found = set()
    for part, x, y, bits in case.array("sieve.left")[: told[KEPT]].tolist():
        found |= {(part // int(told[PARTED]), x + b, y) for b in range(64) if bits >> b & 1}
    return found


@pytest.mark.parametrize(("size", "seed"), [*((FEW, k) for k in range(40)), (MANY, 0)])
def test_where_enough_rooms_are_marked_the_mean_is_left(
    size: tuple[int, int, SamplerConfig], seed: int
) -> None:
    case, inputs = drawn(*size)
    sifted(case.place)
    told = case.array("sieve.told")
    assert told[SIFTED] == 1
    assert left(case) == set()
    rng, index, center = np.random.default_rng(seed), inputs.index, inputs.seen.center
    corner, cells = index.table.corner, index.table.cells
    quarter = int(rng.integers(4))
    low, half = case.array("sieve.turn").tolist()
    turn = inputs.tables.turn + quarter * math.pi / 2
    yaw = turn + low + rng.uniform(0, 2 * half * int(told[PARTED]))
    c, s = math.cos(yaw), math.sin(yaw)
    size = np.array([64 * cells[0], cells[1]]) / corner[2]
    middle = corner[:2] + rng.uniform(-0.05, 1.05, 2) * size  # rooms may be beyond the map
    rooms = rng.permutation(np.flatnonzero(case.array("sieve.counted")))
    for k, r in enumerate(rooms):
        if k == told[NEEDED] - 1:
            sifted(case.place)
            assert left(case) == set()
        if k == told[NEEDED]:
            break
        x, y = middle + np.array([[c, -s], [s, c]]) @ center[r]
        mark(case, index, int(r), quarter, x, y)
    sifted(case.place)
    column, row = np.floor((middle - corner[:2]) * corner[2]).astype(int)
    assert not case.array("sieve.told")[SIFTED] or (quarter, column, row) in left(case)


@pytest.mark.parametrize("seed", range(40))
def test_the_anchor_is_marked_where_it_is_left(seed: int) -> None:
    case, inputs = drawn(*FEW)
    rng, index = np.random.default_rng(seed), inputs.index
    wide, tall = (index.table.cells * (64, 1)).tolist()
    told, kept, parts = case.array("sieve.told"), int(rng.integers(1, 30)), 3
    told[SIFTED], told[KEPT], told[PARTED] = 1, kept, parts
    case.array("sieve.turn")[:] = -0.08, 0.03
    case.array("groups.first")[1] = 1
    anchor = case.array("groups.member")[0] = int(rng.integers(len(inputs.kept)))
    left = case.array("sieve.left")[:kept]
    left[:, 0] = np.sort(rng.integers(4 * parts, size=kept))
    left[:, 1] = rng.integers(-80, wide + 20, size=kept)
    left[:, 2] = rng.integers(-5, tall + 5, size=kept)
    left[:, 3] = rng.integers(-(2**63), 2**63, size=kept) & rng.integers(-(2**63), 2**63, size=kept)
    sifted_for(case.place)
    words, blocks = np.zeros((4, wide // 64, tall), np.uint64), set()
    for part, x, y, bits in left.tolist():
        quarter, turn = part // parts, 0.03 * (2 * (part % parts) + 1) - 0.08
        yaw = inputs.tables.turn + quarter * math.pi / 2 + turn
        c, s = math.cos(yaw) * index.table.corner[2], math.sin(yaw) * index.table.corner[2]
        ax, ay = inputs.seen.center[anchor]
        x, y = x + math.floor(c * ax - s * ay + 0.5), y + math.floor(s * ax + c * ay + 0.5)
        for b in (b for b in range(64) if bits >> b & 1):
            for column in np.clip(np.arange(x + b - 1, x + b + 2), 0, wide - 1).tolist():
                for row in np.clip(np.arange(y - 1, y + 2), 0, tall - 1).tolist():
                    words[quarter, column // 64, row] |= np.uint64(1 << (column % 64))
                    blocks.add((column // 8, row // 8))
    assert (case.array("sieve.word").view(np.uint64) == words.reshape(-1)).all()
    lines, found = tall // 8 + 1, set()
    for k, bits in enumerate(case.array("sieve.block").tolist()):
        found |= {(64 * (k // lines) + b, k % lines) for b in range(64) if bits >> b & 1}
    assert found == blocks
