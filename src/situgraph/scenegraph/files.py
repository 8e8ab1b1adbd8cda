"""Output that is either whole or absent: everything is written beside its place, then renamed."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from situgraph.errors import InputError

_REMEDY = "choose a folder you may write to, with room on its disk"


def write_atomic(path: str | os.PathLike[str], data: bytes) -> Path:
    """Write ``data`` to ``path`` in one step and return the path.

    The parent folders are made. Whatever happens, ``path`` holds the old content or the new one.
    A symbolic link is followed; a device or pipe (``/dev/stdout``) is written to as it is.

    Raises:
        InputError: ``path`` is a directory, or its folder cannot be written to or is full.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(path, "is a directory, not a file to write", "name a file in it")
    target = Path(os.path.realpath(path))
    try:
        if path.exists() and not path.is_file():
            # A rename would put a file in the place of the device.
            with open(path, "wb") as device:
                device.write(data)
            return path
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        _open_to_readers(name, 0o666)
        os.replace(name, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(name)
        if isinstance(error, OSError):
            raise _cannot_write(path, error) from error
        raise
    return path


@contextlib.contextmanager
def atomic_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A folder to fill that takes the name ``path`` only when the block ends without an error.

    An existing ``path`` may only be an empty folder: finished work is never overwritten.

    Raises:
        InputError: ``path`` exists and is not an empty folder, or its place cannot be written to.
    """
    target = Path(path)
    if target.exists() and not (target.is_dir() and not any(target.iterdir())):
        raise InputError(target, "exists already", "name a new folder or remove this one")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        beside = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
    except OSError as error:
        raise _cannot_write(target, error) from error
    try:
        yield beside
        _open_to_readers(beside, 0o777)
        os.replace(beside, target)
    except BaseException as error:
        shutil.rmtree(beside, ignore_errors=True)
        if isinstance(error, OSError):
            raise _cannot_write(target, error) from error
        raise


def _open_to_readers(path: str | Path, mode: int) -> None:
    """Give a temporary file, made private by ``tempfile``, the rights any new file would have."""
    mask = os.umask(0)
    os.umask(mask)
    os.chmod(path, mode & ~mask)


def _cannot_write(target: Path, error: OSError) -> InputError:
    return InputError(target, f"cannot be written ({error.strerror or error})", _REMEDY)
