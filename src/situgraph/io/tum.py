"""Trajectories as text, one pose a line: ``stamp x y z qx qy qz qw`` (the TUM format)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from situgraph.errors import InputError
from situgraph.geometry.poses import Array
from situgraph.scenegraph.files import write_atomic

MAX_BYTES = 1_000_000_000


def write_tum(path: str | Path, stamps: ArrayLike, poses: ArrayLike) -> Path:
    """Write poses (n, 7) at stamps (n,), s; nine decimals, so that nanoseconds survive.

    Raises:
        InputError: the file cannot be written.
        ValueError: the sizes do not fit.
    """
    t, p = np.asarray(stamps, dtype=float), np.asarray(poses, dtype=float).reshape(-1, 7)
    if t.shape != (len(p),):
        raise ValueError(f"{t.shape} stamps for {len(p)} poses")
    lines = [
        f"{stamp:.9f} " + " ".join(f"{v:.9f}" for v in pose) + "\n"
        for stamp, pose in zip(t.tolist(), p.tolist())
    ]
    return write_atomic(path, "".join(lines).encode())


def read_tum(path: str | Path) -> tuple[Array, Array]:
    """Stamps (n,) and poses (n, 7) with unit quaternions; lines that start with ``#`` are comments.

    Raises:
        InputError: no such file, or a line that is not eight finite numbers.
    """
    file = Path(path)
    try:
        if file.stat().st_size > MAX_BYTES:
            raise InputError(file, f"larger than {MAX_BYTES} bytes", "is it a trajectory?")
        text = file.read_bytes().decode("utf-8", "replace")
    except OSError as error:
        raise InputError(file, f"cannot be read ({error.strerror})", "name a TUM file") from error
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.replace(",", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            row = [float(w) for w in words]
        except ValueError:
            row = []
        if len(row) != 8 or not np.isfinite(row).all():
            raise InputError(
                f"{file}, line {number}",
                f"not a pose: {line[:60]!r}",
                "expected stamp x y z qx qy qz qw",
            )
        rows.append(row)
    table = np.array(rows, dtype=float).reshape(-1, 8)
    length = np.linalg.norm(table[:, 4:], axis=1, keepdims=True)
    if len(table) and float(length.min()) < 1e-6:
        raise InputError(file, "a quaternion is zero", "expected qx qy qz qw of a rotation")
    table[:, 4:] /= length
    return table[:, 0], table[:, 1:]
