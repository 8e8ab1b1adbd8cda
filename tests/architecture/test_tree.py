"""What must not stand in the repository, whoever wrote it."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

# Spelled so that this file does not find itself.
MACHINE_PATHS = re.compile(r"/(?:wor[k]|far[m])/|/roo[t]/\.|/hom[e]/[a-z]|/op[t]/(?:whe|pyp)")
REGISTRIES = re.compile(r"(?i)--(?:extra-)?index-ur[l]|--find-link[s]|py[p]i\.org|pythonhoste[d]")
UNSAFE = re.compile(
    r"^\s*(?:import|from) (?:pickle|marshal|shelve|dill|cloudpickle|lxml)\b"
    r"|^\s*import xml\b|^\s*from xml\S* import (?!Element\b|ParseError\b)"
    r"|(?<![\w.])(?:eval|exec)\(|yaml\.(?:unsafe_)?load\(|allow_pickle=True|shell=True",
    re.MULTILINE,
)
LONGEST_FILE = 400


@pytest.fixture(scope="module")
def tracked() -> list[Path]:
    root = Path(__file__).resolve().parents[2]
    listing = subprocess.run(
        ["git", "-C", str(root), "ls-files", "-z"], capture_output=True, check=False, timeout=60
    )
    names = listing.stdout.decode().split("\0") if listing.returncode == 0 else []
    # A source archive has no git: look at the folders that are in it.
    found = [root / n for n in names if n] or [
        p for top in ("src", "tests", "docs", "examples") for p in (root / top).rglob("*")
    ]
    return [p for p in found if p.is_file()]


def text_of(path: Path) -> str:
    data = path.read_bytes()
    return "" if b"\0" in data[:8192] else data.decode("utf-8", "replace")


def test_no_path_of_a_machine_and_no_registry(tracked: list[Path]) -> None:
    for path in tracked:
        for pattern in (MACHINE_PATHS, REGISTRIES):
            hit = pattern.search(text_of(path))
            assert hit is None, f"{path}: {hit and hit.group()}"


def test_input_is_never_trusted(tracked: list[Path]) -> None:
    for path in tracked:
        if path.suffix == ".py" and "src" in path.parts:
            hit = UNSAFE.search(text_of(path))
            assert hit is None, f"{path}: {hit and hit.group()}"


def test_files_are_short_and_small(tracked: list[Path]) -> None:
    for path in tracked:
        assert path.stat().st_size <= 4 << 20, path
        if path.suffix == ".py" and "src" in path.parts:
            assert text_of(path).count("\n") <= LONGEST_FILE, path


def test_the_locks_are_pinned_hashed_and_free_of_torch(repository: Path) -> None:
    for name in ("base.txt", "dev.txt"):
        text = (repository / "requirements" / name).read_text()
        entries = [s for s in text.replace("\\\n", "").splitlines() if s and s[0] not in "# "]
        assert entries
        for entry in entries:
            assert re.match(r"[a-z0-9.-]+==\S+", entry), entry
            assert "--hash=sha256:" in entry, entry
            assert not re.match(r"(torch|igraph|nvidia)\b", entry), entry
        if name == "base.txt":
            assert not re.search(r"^evo==", text, re.MULTILINE)


def test_versions_agree(repository: Path) -> None:
    import tomllib

    import situgraph

    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    assert project["version"] == situgraph.__version__
    assert f"## [{situgraph.__version__}]" in (repository / "CHANGELOG.md").read_text()
