"""The house has floors: a module imports only from floors below its own."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

FLOORS: dict[str, float] = {
    "errors": 0,
    "setting": 0,
    "geometry": 1,
    "scenegraph": 2,
    "cache": 2.5,
    "plan": 3,
    "io": 3,
    "slam": 3,
    "objects": 3,
    "matching": 3,
    "view": 3,
    "coupling": 4,
    "sim": 4,
    "config": 5,
    "api": 5,
    "pipeline": 5,
    "demo": 5,
    "demo_drive": 5,
    "detectors": 5,
    "judging": 5,
    "run": 5,
    "run_folder": 5,
    "side_by_side": 5,
    "run_building": 5,
    "experiments": 6,
    "cli": 7,
    "__main__": 8,
}
# Floor 5 is not a set of independent stages: these lean on each other in one direction.
NEIGHBOURS: set[tuple[str, str]] = {
    ("api", "config"),
    ("pipeline", "api"),
    ("pipeline", "config"),
    ("judging", "pipeline"),
    ("side_by_side", "pipeline"),
    ("judging", "run"),
    ("run", "config"),
    ("run", "judging"),
    ("run", "pipeline"),
    ("run_folder", "config"),
    ("run_folder", "pipeline"),
    ("run_folder", "run"),
    ("run_folder", "run_building"),
    ("run_building", "config"),
    ("run_building", "pipeline"),
    ("run_building", "run"),
    ("demo", "api"),
    ("demo", "config"),
    ("demo_drive", "config"),
    ("demo_drive", "demo"),
    ("demo_drive", "detectors"),
    ("demo_drive", "judging"),
    ("demo_drive", "pipeline"),
    ("demo_drive", "run"),
    ("demo_drive", "run_folder"),
}

# The simulator makes recordings; it must not know who will read them.
FORBIDDEN = {("sim", "slam"), ("sim", "objects"), ("sim", "matching")}

SOURCES = Path(__file__).resolve().parents[2] / "src" / "situgraph"
MODULES = sorted(SOURCES.rglob("*.py"))


def imported_rooms(text: str, package: list[str]) -> set[str]:
    """The rooms a module imports from, wherever in its text the import stands."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            names = [f"{module}.{alias.name}" for alias in node.names]
        found |= {name.split(".")[1] for name in names if name.startswith("situgraph.")}
    return found & FLOORS.keys()


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCES)))
def test_a_module_imports_only_from_below(path: Path) -> None:
    parts = path.relative_to(SOURCES).parts
    room = parts[0].removesuffix(".py")
    if room == "__init__":  # the public names, loaded on first use
        return
    package = ["situgraph", *parts[:-1]]
    for other in imported_rooms(path.read_text(), package) - {room}:
        below = FLOORS[other] < FLOORS[room] or (room, other) in NEIGHBOURS
        assert (room, other) not in FORBIDDEN, f"{'/'.join(parts)} knows {other}"
        assert below, f"{'/'.join(parts)} on floor {FLOORS[room]} imports {other}"


def test_every_module_has_a_floor() -> None:
    rooms = {path.relative_to(SOURCES).parts[0].removesuffix(".py") for path in MODULES}
    assert rooms - {"__init__"} <= FLOORS.keys()


def test_all_forms_of_import_are_seen() -> None:
    text = (
        "import situgraph.view.plan\nfrom situgraph import sim\ndef f():\n from ..slam import x\n"
    )
    assert imported_rooms(text, ["situgraph", "matching"]) == {"view", "sim", "slam"}
    assert imported_rooms("from . import plan", ["situgraph"]) == {"plan"}
