"""Scans as small files: a range image where it loses nothing, else compressed points."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.io.images import write_grey
from situgraph.io.recording import Scan
from situgraph.io.vlp16 import RINGS, vlp16

MAX_BYTES = 500_000_000  # of one unpacked scan
_FIELDS = {"points": np.float32, "times": np.float32, "rings": np.uint8, "intensity": np.float32}


class ScanFiles:
    """Scans in a folder by their number.

    A scan that fits the firing pattern of a VLP-16, with ranges in whole steps, is stored as two
    PNG images of 16 rows (rings) by 1808 columns (cycles): ``000000.png`` ranges in steps (0: none)
    and ``000000.i.png`` intensities in 255ths. Any other is ``000000.npz`` with ``points``, and
    ``times``, ``rings``, ``intensity`` where known.
    """

    def __init__(self, folder: Path, rate: float, step: float) -> None:
        self._folder = folder
        self._step = step
        self._pattern = vlp16(rate)

    def write(self, index: int, scan: Scan) -> None:
        """Store ``scan`` under its number; reading it gives the same arrays."""
        images = self._images(scan)
        base = self._folder / f"{index:06d}"
        if images is None:
            found = {k: getattr(scan, k) for k in _FIELDS}
            np.savez_compressed(
                base.with_suffix(".npz"), **{k: v for k, v in found.items() if v is not None}
            )
            return
        write_grey(base.with_suffix(".png"), images[0])
        write_grey(base.with_suffix(".i.png"), images[1])

    def read(self, index: int, stamp: float) -> Scan:
        """The scan of that number.

        Raises:
            InputError: its file is missing or damaged.
        """
        base = self._folder / f"{index:06d}"
        if base.with_suffix(".png").exists():
            return self._from_images(base, stamp)
        return _from_archive(base.with_suffix(".npz"), stamp)

    def _images(self, scan: Scan) -> tuple[NDArray[np.uint16], NDArray[np.uint8]] | None:
        """Ranges and intensities (16, c); None where the scan does not fit the pattern exactly."""
        place = self._pattern.rows_and_columns(scan)
        if place is None or scan.intensity is None:
            return None
        steps = np.zeros(self._pattern.times.shape, dtype=np.uint16)
        light = np.zeros(self._pattern.times.shape, dtype=np.uint8)
        away = np.linalg.norm(scan.points.astype(np.float64), axis=1) / self._step
        if len(away) and away.max() > 65_535:
            return None
        steps[place] = np.rint(away)
        light[place] = np.rint(np.clip(scan.intensity, 0, 1) * 255)
        again = self._scan(steps, light, scan.stamp)
        same = all(np.array_equal(getattr(again, k), getattr(scan, k)) for k in _FIELDS)
        return (steps, light) if same else None

    def _scan(self, steps: NDArray[np.uint16], light: NDArray[np.uint8], stamp: float) -> Scan:
        order = self._pattern.order[steps.ravel()[self._pattern.order] > 0]
        points = self._pattern.points(steps, self._step).reshape(-1, 3)[order]
        rings = (order // self._pattern.columns).astype(np.uint8)
        bright = light.ravel()[order].astype(np.float32) / np.float32(255)
        return Scan(stamp, points, self._pattern.times.ravel()[order], rings, bright)

    def _from_images(self, base: Path, stamp: float) -> Scan:
        from PIL import Image

        images = []
        for suffix in (".png", ".i.png"):
            file = base.with_suffix(suffix)
            try:
                with Image.open(file) as image:
                    if image.size != (self._pattern.columns, RINGS):
                        raise InputError(file, f"is {image.size}, not a scan", "copy it again")
                    images.append(np.asarray(image))
            except (OSError, SyntaxError, ValueError) as error:
                raise InputError(file, f"damaged ({error})", "copy it again") from error
        return self._scan(images[0].astype(np.uint16), images[1].astype(np.uint8), stamp)


def _from_archive(file: Path, stamp: float) -> Scan:
    try:
        with zipfile.ZipFile(file) as archive:
            if sum(i.file_size for i in archive.infolist()) > MAX_BYTES:
                raise InputError(file, f"unpacks to more than {MAX_BYTES} bytes", "is it a scan?")
        with np.load(file, allow_pickle=False) as stored:
            found = {k: stored[k].astype(t) for k, t in _FIELDS.items() if k in stored}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(file, f"missing or damaged ({error})", "copy it again") from error
    points = found.pop("points", None)
    if points is None or points.ndim != 2 or points.shape[1] != 3:
        raise InputError(file, "holds no points (n, 3)", "see docs/recordings.md")
    if any(v.shape != (len(points),) for v in found.values()):
        raise InputError(file, "times, rings and points do not fit", "see docs/recordings.md")
    return Scan(stamp, points, found.get("times"), found.get("rings"), found.get("intensity"))
