"""Point clouds in PCD files: ASCII and binary, version 0.7."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError

MAX_POINTS = 50_000_000
_HEADER = 10_000  # bytes; a header is a dozen lines
_TYPES = {("F", 4): "<f4", ("F", 8): "<f8", ("U", 1): "u1", ("U", 2): "<u2", ("U", 4): "<u4",
          ("I", 1): "i1", ("I", 2): "<i2", ("I", 4): "<i4"}  # fmt: skip

Floats = NDArray[np.float32]


def read_pcd(path: str | Path) -> tuple[Floats, Floats | None]:
    """Points (n, 3) float32 and intensities (n,) float32 or None.

    Raises:
        InputError: not a PCD file, compressed, cut short, or without x, y and z.
    """
    file = Path(path)
    try:
        data = file.read_bytes()
    except OSError as error:
        raise InputError(file, f"cannot be read ({error.strerror})", "name a PCD file") from error
    header, kind, body = _header(file, data)
    try:
        names = header["FIELDS"]
        counts = [int(c) for c in header.get("COUNT", ["1"] * len(names))]
        sizes, types = [int(s) for s in header["SIZE"]], header["TYPE"]
        points = int(header["POINTS"][0])
        layout = np.dtype(
            [(f"{n}{i}" if n == "_" else n, _TYPES[t, s], (c,) if c > 1 else ())
             for i, (n, t, s, c) in enumerate(zip(names, types, sizes, counts, strict=True))]
        )  # fmt: skip
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(file, f"damaged PCD header ({error})", "write it again") from error
    if not 0 <= points <= MAX_POINTS:
        raise InputError(file, f"{points} points", f"at most {MAX_POINTS} are read")
    if kind == "ascii":
        table = _ascii(file, body, layout, points)
    else:
        if len(body) < points * layout.itemsize:
            have = len(body) // max(layout.itemsize, 1)
            raise InputError(file, f"cut short: {have} of {points} points", "copy it again")
        table = np.frombuffer(body, dtype=layout, count=points)
    if not {"x", "y", "z"} <= set(table.dtype.names or ()):
        raise InputError(file, f"fields are {' '.join(names)}", "x, y and z are needed")
    xyz = np.stack([table[k].astype(np.float32) for k in ("x", "y", "z")], axis=1)
    bright = table["intensity"].astype(np.float32) if "intensity" in names else None
    return xyz, bright


def _header(file: Path, data: bytes) -> tuple[dict[str, list[str]], str, bytes]:
    header: dict[str, list[str]] = {}
    at = 0
    while at < min(len(data), _HEADER):
        end = data.find(b"\n", at)
        if end < 0:
            break
        words = data[at:end].decode("ascii", "replace").split()
        at = end + 1
        if not words or words[0].startswith("#"):
            continue
        header[words[0].upper()] = words[1:]
        if words[0].upper() == "DATA":
            kind = words[1].lower() if len(words) > 1 else ""
            if kind in {"ascii", "binary"}:
                return header, kind, data[at:]
            raise InputError(file, f"DATA {kind or '?'} is not read", "save it as ascii or binary")
    raise InputError(file, "not a PCD file", "expected a header that ends with DATA")


def _ascii(file: Path, body: bytes, layout: np.dtype[np.void], points: int) -> NDArray[np.void]:
    names = layout.names or ()
    wide = [int(np.prod(layout[n].shape)) for n in names]
    try:
        values = np.array(body.split(), dtype=np.float64)
        rows = values[: points * sum(wide)].reshape(points, sum(wide))
    except ValueError as error:
        raise InputError(file, "cut short or not numbers", "copy it again") from error
    table = np.zeros(points, dtype=layout)
    at = 0
    for name, width in zip(names, wide):
        table[name] = rows[:, at] if width == 1 else rows[:, at : at + width]
        at += width
    return table
