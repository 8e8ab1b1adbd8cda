"""What was expensive to make, kept in the user's cache folder: bytes by key, bounded, disposable.

Parallel processes may share the folder: entries appear by rename and may vanish at any time. Where
the folder cannot be written, entries live in memory as long as the process.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import shutil
import time
from collections import OrderedDict
from pathlib import Path

import msgspec

from situgraph.errors import InputError
from situgraph.scenegraph.files import write_atomic

MAX_BYTES = 1 << 30  # 1 GiB on disk: a thousand plans
MAX_MEMORY_BYTES = 1 << 26  # 64 MiB where the folder is read-only
STALE_SECONDS = 86_400.0  # an unfinished file this old was left by a process that died
KINDS = ("plans", "compiled")  # the folders that are ours to fill and to clear


class CacheUse(msgspec.Struct, frozen=True):
    """How much is cached of one kind."""

    kind: str
    folder: str
    files: int
    bytes: int


def cache_root() -> Path:
    """The cache folder: ``$SITUGRAPH_CACHE``, else the place the platform has for caches."""
    chosen = os.environ.get("SITUGRAPH_CACHE")
    if chosen:
        return Path(chosen)
    import platformdirs

    return Path(platformdirs.user_cache_dir("situgraph", appauthor=False))


def content_key(path: Path, *context: str) -> str:
    """A key for something made from a file: changes with the file's bytes and every context word.

    Raises:
        OSError: the file cannot be read.
    """
    digest = hashlib.sha256("\0".join(context).encode())
    with open(path, "rb") as file:
        digest.update(hashlib.file_digest(file, "sha256").digest())
    return digest.hexdigest()


@functools.cache
def code_key(*packages: str) -> str:
    """A key that changes with the source of these packages of situgraph.

    Results of code that is being worked on must not outlive it, and it keeps its version number.
    """
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for package in packages:
        for path in sorted((here / package).glob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


class Cache:
    """Entries of one kind in one folder, the oldest removed when they grow over ``max_bytes``."""

    def __init__(self, folder: Path, max_bytes: int = MAX_BYTES) -> None:
        self.folder = folder
        self.max_bytes = max_bytes
        self._memory: OrderedDict[str, bytes] = OrderedDict()

    def get(self, key: str) -> bytes | None:
        """The bytes kept under the key, or None."""
        if key in self._memory:
            return self._memory[key]
        path = self.folder / key
        try:
            data = path.read_bytes()
        except OSError:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # recently used entries are the last to be removed
        return data

    def put(self, key: str, data: bytes) -> None:
        """Keep the bytes; a folder that is read-only or full is no error."""
        try:
            write_atomic(self.folder / key, data)
        except InputError:
            self._remember(key, data)
        else:
            self._shrink()

    def _remember(self, key: str, data: bytes) -> None:
        self._memory[key] = data
        while sum(map(len, self._memory.values())) > MAX_MEMORY_BYTES:
            self._memory.popitem(last=False)

    def _shrink(self) -> None:
        entries = []
        for path in self.folder.iterdir():
            with contextlib.suppress(OSError):
                status = path.stat()
                if not path.name.startswith("."):
                    entries.append((status.st_mtime, status.st_size, path))
                elif time.time() - status.st_mtime > STALE_SECONDS:
                    path.unlink()
        total = sum(size for _, size, _ in entries)
        for _, size, path in sorted(entries)[:-1]:
            if total <= self.max_bytes:
                return
            with contextlib.suppress(OSError):
                path.unlink()
            total -= size


@functools.lru_cache(maxsize=8)
def _cache_in(folder: Path) -> Cache:
    return Cache(folder)


def plan_cache() -> Cache:
    """The cache of building models read before."""
    return _cache_in(cache_root() / "plans")


def cache_use() -> list[CacheUse]:
    """What the cache folder holds, kind by kind."""
    found = []
    for kind in KINDS:
        folder = cache_root() / kind
        sizes = []
        for path in folder.rglob("*"):
            with contextlib.suppress(OSError):
                if path.is_file():
                    sizes.append(path.stat().st_size)
        found.append(CacheUse(kind, str(folder), len(sizes), sum(sizes)))
    return found


def clear_cache() -> list[CacheUse]:
    """Remove every entry; return what was there.

    Raises:
        OSError: an entry cannot be removed.
    """
    before = cache_use()
    for kind in KINDS:
        with contextlib.suppress(FileNotFoundError):
            shutil.rmtree(cache_root() / kind)
    _cache_in.cache_clear()
    return before
