"""Compiling the matcher's kernels, and where the compiled code is kept.

Compiled code lives in the user's cache folder under this version, so an install that cannot be
written works; where no folder can be written, it lives in memory. ``NUMBA_CACHE_DIR``, when set,
has priority.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import numba

from situgraph import __version__
from situgraph.matching.parts import EntryCompiler, PartCompiler

F = TypeVar("F", bound=Callable[..., Any])


def compiled_folder() -> Path | None:
    """The folder of compiled kernels, None when it cannot be written."""
    import tempfile

    root = os.environ.get("SITUGRAPH_CACHE")
    if not root:
        import platformdirs

        root = platformdirs.user_cache_dir("situgraph", appauthor=False)
    folder = Path(root) / "compiled" / f"{__version__}-{_sources_key()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return None


def _sources_key() -> str:
    """Changes with any source of this stage: a kernel is compiled together with those it calls."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def part(function: F) -> F:
    """Compile a function for other kernels, as a part of the entries that use it (``parts``).

    It works on ``records`` and allocates nothing. It is compiled once, not again for each constant
    it is called with.
    """
    made = _compiled(function, **_PART)
    template = made.get_call_template  # type: ignore[attr-defined]

    def of_any_value(args: Any, kws: Any) -> Any:
        plain = {name: numba.types.unliteral(kind) for name, kind in kws.items()}
        return template(tuple(map(numba.types.unliteral, args)), plain)

    made.get_call_template = of_any_value  # type: ignore[attr-defined]
    return made


def entry(function: F) -> F:
    """Compile a function that is called from Python, with all it calls, and keep the result."""
    with _kept_in(_FOLDER) as cache:
        return _compiled(function, cache=cache, no_cfunc_wrapper=True, pipeline_class=EntryCompiler)


_PART: dict[str, Any] = {
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": PartCompiler,
    "_nrt": False,
}


def _compiled(function: F, **options: Any) -> F:
    made: F = numba.njit(nogil=True, error_model="numpy", **options)(function)
    return made


def announce_compilation(entry: Any) -> None:
    """Say on stderr, once, that the first use ever compiles."""
    if getattr(entry, "overloads", True) or (
        _FOLDER is not None and any(_FOLDER.glob(f"*/{entry.__module__.rpartition('.')[2]}.*.nbi"))
    ):
        return
    print("situgraph: compiling the matcher, once (10 to 30 s)", file=sys.stderr, flush=True)


@contextmanager
def _kept_in(folder: Path | None) -> Iterator[bool]:
    """Numba's cache folder while a function is declared; its other users keep their own."""
    before = numba.config.CACHE_DIR
    if before:
        yield True
        return
    numba.config.CACHE_DIR = str(folder or "")
    try:
        yield folder is not None
    finally:
        numba.config.CACHE_DIR = before


_FOLDER = compiled_folder()
