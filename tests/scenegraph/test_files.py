"""Output is whole or absent."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from situgraph.errors import InputError
from situgraph.scenegraph import files
from situgraph.scenegraph.files import atomic_folder, write_atomic


def left_over(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_a_file_is_written_and_replaced(tmp_path: Path) -> None:
    target = tmp_path / "new" / "a.json"
    assert write_atomic(target, b"one") == target
    write_atomic(target, b"two")
    assert target.read_bytes() == b"two"
    assert left_over(target.parent) == ["a.json"]
    mask = os.umask(0)
    os.umask(mask)
    assert target.stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "a.json"
    write_atomic(target, b"old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(InputError, match="No space left on device") as caught:
        write_atomic(target, b"new")
    assert str(target) in str(caught.value)
    assert target.read_bytes() == b"old"
    assert left_over(tmp_path) == ["a.json"]


def test_ctrl_c_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(files.os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_atomic(tmp_path / "a.json", b"new")
    assert left_over(tmp_path) == []


def test_places_that_cannot_be_written_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="is a directory"):
        write_atomic(tmp_path, b"")
    with pytest.raises(InputError, match="cannot be written"):
        write_atomic(tmp_path / "file" / "a.json", b"")
    with (
        pytest.raises(InputError, match="cannot be written"),
        atomic_folder(tmp_path / "file" / "run"),
    ):
        pytest.fail("the block must not run")


def test_a_folder_appears_when_it_is_complete(tmp_path: Path) -> None:
    target = tmp_path / "runs" / "one"
    with atomic_folder(target) as folder:
        (folder / "log").write_text("x")
        assert not target.exists()
    assert left_over(target) == ["log"]
    assert left_over(target.parent) == ["one"]
    with pytest.raises(InputError, match="exists already"), atomic_folder(target):
        pytest.fail("the block must not run")


def test_a_folder_whose_making_failed_is_gone(tmp_path: Path) -> None:
    def fill(folder: Path) -> None:
        (folder / "log").write_text("x")
        raise ValueError

    def make() -> None:
        with atomic_folder(tmp_path / "run") as folder:
            fill(folder)

    with pytest.raises(ValueError):  # noqa: PT011
        make()
    assert left_over(tmp_path) == []


def test_an_empty_folder_may_be_filled(tmp_path: Path) -> None:
    target = tmp_path / "run"
    target.mkdir()
    with atomic_folder(target) as folder:
        (folder / "log").write_text("x")
    assert left_over(target) == ["log"]


def test_a_link_is_followed_and_stays(tmp_path: Path) -> None:
    (tmp_path / "link.json").symlink_to(tmp_path / "real.json")
    for content in (b"one", b"two"):
        write_atomic(tmp_path / "link.json", content)
        assert (tmp_path / "real.json").read_bytes() == content
        assert (tmp_path / "link.json").is_symlink()


def test_a_pipe_is_written_to_and_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomic(pipe, b"data")
        assert os.read(reader, 10) == b"data"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a disk that is always full")
def test_a_full_device_is_said() -> None:
    with pytest.raises(InputError, match="/dev/full: cannot be written"):
        write_atomic("/dev/full", b"data")
    assert not os.path.isfile("/dev/full")
