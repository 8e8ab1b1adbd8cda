"""Importing and asking for help is quick, because nothing heavy is loaded; GPL code never is."""

from __future__ import annotations

import itertools
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {
    "PIL", "dask", "distributed", "embreex", "gtsam", "ifcopenshell", "llvmlite", "matplotlib",
    "moderngl", "networkx", "numba", "numpy", "onnxruntime", "rich", "rosbags", "scipy", "shapely",
    "small_gicp", "torch", "trimesh", "yaml",
}  # fmt: skip
GPL = ("evo", "igraph")
SOURCES = Path(__file__).resolve().parents[2] / "src" / "situgraph"


def loaded_after(code: str) -> set[str]:
    script = f"import sys\n{code}\nprint('\\n'.join(sys.modules))"
    output = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    return {name.split(".")[0] for name in output.stdout.split()}


@pytest.mark.parametrize(
    "code",
    [
        "import situgraph",
        "import situgraph; situgraph.SituGraphError; situgraph.load; situgraph.__version__",
        "import situgraph.cli.app as a\ntry: a.main(['--help'])\nexcept SystemExit: pass",
        "import situgraph.cli.app as a\ntry: a.main(['--version'])\nexcept SystemExit: pass",
        "import situgraph.cli.app as a\ntry: a.main(['match', '--help'])\nexcept SystemExit: pass",
    ],
)
def test_nothing_heavy_is_loaded(code: str) -> None:
    assert not loaded_after(code) & HEAVY


def test_settings_load_no_building_reader_no_optimiser_and_no_pictures() -> None:
    loaded = loaded_after("from situgraph.config import describe; describe()")
    assert not loaded & {
        "gtsam",
        "ifcopenshell",
        "matplotlib",
        "moderngl",
        "onnxruntime",
        "embreex",
    }


def test_the_package_imports_no_gpl_code() -> None:
    for path in SOURCES.rglob("*.py"):
        words = path.read_text().split()
        named = {b.split(".")[0] for a, b in itertools.pairwise(words) if a in ("import", "from")}
        assert not named & set(GPL), path
