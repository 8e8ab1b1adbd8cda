"""Reading and writing graphs: 10,000 rooms are to load in less than a second."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import situgraph as sg
from situgraph.scenegraph.codec import encode
from situgraph.scenegraph.graph import Plane, Room


def grid(side: int) -> sg.SceneGraph:
    """``side`` x ``side`` rooms of 4 x 4 m with walls of 0.2 m between them."""
    rooms, planes = [], []
    for number in range(side * side):
        x, y = 4.2 * (number % side), 4.2 * (number // side)
        faces = ((1.0, 0.0, -x), (-1.0, 0.0, x + 4.0), (0.0, 1.0, -y), (0.0, -1.0, y + 4.0))
        ids = tuple(f"p{number}.{i}" for i in range(4))
        planes += [Plane(key, (nx, ny, 0.0), d) for key, (nx, ny, d) in zip(ids, faces)]
        outline = ((x, y), (x + 4.0, y), (x + 4.0, y + 4.0), (x, y + 4.0))
        rooms.append(Room(f"r{number}", (x + 2.0, y + 2.0, 1.4), ids, footprint=outline))
    return sg.SceneGraph(name="grid", rooms=tuple(rooms), planes=tuple(planes))


@pytest.mark.parametrize("side", [10, 100])
def test_load(benchmark: Any, tmp_path: Path, side: int) -> None:
    sg.save(grid(side), tmp_path / "grid.json")
    loaded = benchmark(sg.load, tmp_path / "grid.json")
    assert len(loaded.rooms) == side * side


def test_encode(benchmark: Any) -> None:
    graph = grid(100)
    assert benchmark(encode, graph).startswith(b"{")


@pytest.mark.external
def test_load_log(benchmark: Any, shared_data: Path) -> None:
    log = shared_data / "sgraphs/SE1/S-Graphs/R8/graph.g2o"
    assert len(benchmark(sg.load, log).rooms) == 6
