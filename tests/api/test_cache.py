"""The cache: bounded, shared, disposable."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from situgraph.cache import Cache, cache_use, clear_cache, content_key, plan_cache


def test_what_is_put_is_got(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "plans")
    assert cache.get("a") is None
    cache.put("a", b"1")
    assert Cache(tmp_path / "plans").get("a") == b"1"


def test_the_entry_used_longest_ago_goes_first(tmp_path: Path) -> None:
    cache = Cache(tmp_path, max_bytes=250)
    for age, key in enumerate("abc"):
        cache.put(key, bytes(80))
        os.utime(tmp_path / key, (1000 + age, 1000 + age))
    assert cache.get("a") is not None  # used: now the newest
    cache.put("d", bytes(80))
    assert {p.name for p in tmp_path.iterdir()} == {"a", "c", "d"}
    cache.put("huge", bytes(1000))
    assert cache.get("huge") is not None


def test_files_of_dead_processes_are_removed_and_young_ones_kept(tmp_path: Path) -> None:
    (tmp_path / ".a.old").write_bytes(b"x")
    os.utime(tmp_path / ".a.old", (0, 0))
    (tmp_path / ".a.young").write_bytes(b"x")
    Cache(tmp_path).put("b", b"1")
    assert {p.name for p in tmp_path.iterdir()} == {".a.young", "b"}


def test_a_folder_that_cannot_be_written_is_replaced_by_memory(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.touch()
    cache = Cache(blocked / "plans")
    cache.put("a", b"1")
    assert cache.get("a") == b"1"
    assert Cache(blocked / "plans").get("a") is None


def test_the_key_depends_on_content_and_context(tmp_path: Path) -> None:
    file = tmp_path / "a.ifc"
    file.write_bytes(b"one")
    keys = {content_key(file, "0.1"), content_key(file, "0.2"), content_key(file, "0.1", "x")}
    file.write_bytes(b"two")
    keys.add(content_key(file, "0.1"))
    assert len(keys) == 4


def test_clearing_removes_our_entries_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SITUGRAPH_CACHE", str(tmp_path))
    (tmp_path / "letter.txt").write_text("not ours")
    plan_cache().put("a", bytes(10))
    assert {u.kind: u.bytes for u in cache_use()}["plans"] == 10
    assert sum(u.files for u in clear_cache()) == 1
    assert clear_cache()[0].files == 0
    assert [p.name for p in tmp_path.iterdir()] == ["letter.txt"]
