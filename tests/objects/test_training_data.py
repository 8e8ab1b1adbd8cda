"""What the shipped network was trained on, and above all what it was not."""

from __future__ import annotations

import ast
import importlib.util
from itertools import combinations
from pathlib import Path

import pytest

from situgraph.objects.network import NetworkDetector
from situgraph.plan.six_rooms import ROOM

SPLITS = ("train", "validation", "test")
# Seeds that experiments, demo and tests use for layouts, paints and drives.
ELSEWHERE = range(0, 900_000)


@pytest.fixture(scope="module")
def generator(repository: Path):
    file = repository / "training" / "generate.py"
    if not file.is_file():
        pytest.skip("the training scripts are not in this archive")
    spec = importlib.util.spec_from_file_location("generate", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def ranges() -> list[range]:
    card = NetworkDetector().card.frames["splits"]
    return [range(*card[s][kind]) for s in SPLITS for kind in ("layout_seeds", "texture_seeds")]


def test_no_layout_and_no_paint_is_in_two_splits_or_in_any_experiment() -> None:
    for a, b in combinations([*ranges(), ELSEWHERE], 2):
        assert max(a.start, b.start) >= min(a.stop, b.stop)


def test_the_card_of_the_shipped_model_is_that_of_the_generator(generator) -> None:
    card = NetworkDetector().card
    assert list(card.names) == generator.NAMES
    for name, (layout, texture, count, frames) in generator.SPLITS.items():
        split = card.frames["splits"][name]
        assert split["layout_seeds"] == [layout, layout + count]
        assert split["texture_seeds"] == [texture, texture + count]
        assert split["frames"] == count * frames


def test_the_generator_reads_no_building(generator, repository: Path) -> None:
    for file in (repository / "training").glob("*.py"):
        tree = ast.parse(file.read_text())
        imported = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
        assert not {m for m in imported if m and ("six_rooms" in m or "ifc" in m or "api" in m)}
        words = {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant)}
        assert not [w for w in words if isinstance(w, str) and "shared/data" in w]


def test_no_training_layout_has_the_rooms_of_the_six_room_building(generator) -> None:
    from shapely import Polygon

    first, texture, _, _ = generator.SPLITS["train"]
    for k in range(0, 24, 3):
        graph = generator.layout_world(first + k, texture + k).graph
        areas = [Polygon(r.footprint).area for r in graph.rooms if r.footprint]
        assert sum(abs(a - ROOM[0] * ROOM[1]) < 0.05 for a in areas) < len(areas) / 2


def test_the_model_card_lists_the_seeds(repository: Path) -> None:
    card = repository / "docs" / "model-card.md"
    if not card.is_file():
        pytest.skip("the docs are not in this archive")
    for seeds in ranges():
        assert f"{seeds.start} to {seeds.stop - 1}" in card.read_text()
