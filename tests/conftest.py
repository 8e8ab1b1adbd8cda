"""Fixtures that every stage's tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

# Simple numeric kernels: one thread each keeps runs repeatable and two test processes apart.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "Agg")

# The same examples in every run, and none that fails for being slow on a busy machine.
settings.register_profile("situgraph", deadline=None, derandomize=True)
settings.load_profile("situgraph")

REPOSITORY = Path(__file__).resolve().parents[1]
# Not the user's cache, but one that outlives the run: compiling the matcher takes its time.
os.environ["SITUGRAPH_CACHE"] = str(REPOSITORY / ".pytest_cache" / "situgraph")


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the working tree."""
    return REPOSITORY


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The real inputs beside the repository; a test that asks for them is marked ``external``."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the real inputs are not beside the repository (../shared/data)")
    return folder


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache for plans, for this test only."""
    folder = tmp_path / "situgraph-cache"
    monkeypatch.setenv("SITUGRAPH_CACHE", str(folder))
    return folder
