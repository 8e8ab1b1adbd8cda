"""Colour and depth images as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError

MAX_PIXELS = 50_000_000
JPEG_QUALITY = 92
_HUFFMAN = 2  # zlib's strategy: noise has no repeats to look for

Floats = NDArray[np.float32]


def write_rgb(file: Path, rgb: NDArray[np.uint8]) -> None:
    """Store a colour image (h, w, 3) as JPEG: what is read back differs by a few values of 255."""
    from PIL import Image

    Image.fromarray(rgb).save(file, quality=JPEG_QUALITY)


def write_grey(file: Path, image: NDArray[np.uint16] | NDArray[np.uint8]) -> None:
    """Store an image of whole numbers (h, w) as PNG."""
    from PIL import Image

    Image.fromarray(image).save(file, compress_level=1, compress_type=_HUFFMAN)


def write_depth(base: Path, depth: Floats, strength: float, step: float) -> None:
    """Store a depth image (h, w), metres, to the millimetre.

    As disparities ``base.d.png`` where all depths come from whole ``step`` pixels of a stereo pair
    with focal length times baseline ``strength`` (m px), which takes half the space; else as
    millimetres ``base.png``.
    """
    with np.errstate(divide="ignore"):
        counts = np.rint(strength / step / depth.astype(np.float64))
    steps = np.where((depth > 0) & (counts <= 65_535), counts, 0).astype(np.uint16)
    if np.array_equal(_from_disparity(steps, strength, step), depth):
        write_grey(base.with_suffix(".d.png"), steps)
    else:
        whole = np.rint(np.clip(depth.astype(np.float64), 0, 65.535) * 1000).astype(np.uint16)
        write_grey(base.with_suffix(".png"), whole)


def read_rgb(file: Path) -> NDArray[np.uint8]:
    """Read a colour image (h, w, 3).

    Raises:
        InputError: not an image, cut short, or too large.
    """
    return np.asarray(_image(file).convert("RGB"))


def read_depth(file: Path, unit: float) -> Floats:
    """Read a depth image (h, w), metres, from one of whole numbers of ``unit`` metres.

    Raises:
        InputError: not an image with one channel of whole numbers, cut short, or too large.
    """
    # Dividing keeps whole millimetres the nearest representable metres.
    return (_whole(file) / (1.0 / unit)).astype(np.float32)


def read_disparity(file: Path, strength: float, step: float) -> Floats:
    """Read a depth image (h, w), metres, from one of disparities; see ``write_depth``.

    Raises:
        InputError: not an image with one channel of whole numbers, cut short, or too large.
    """
    return _from_disparity(_whole(file), strength, step)


def _from_disparity(steps: NDArray[Any], strength: float, step: float) -> Floats:
    millimetres = np.rint(1000.0 * strength / (np.maximum(steps, 1) * step))
    return np.where(steps > 0, millimetres / 1000.0, 0.0).astype(np.float32)


def _whole(file: Path) -> NDArray[Any]:
    image = np.asarray(_image(file))
    if image.ndim != 2 or image.dtype.kind not in "iu":
        raise InputError(
            file, f"not a depth image ({image.dtype}, {image.shape})", "expected 16-bit grey"
        )
    return image


def _image(file: Path) -> Any:
    from PIL import Image, UnidentifiedImageError

    try:
        image = Image.open(file)
        if image.width * image.height > MAX_PIXELS:
            raise InputError(file, f"{image.width}x{image.height} pixels", "scale it down")
        image.load()
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise InputError(file, f"not an image, or damaged ({error})", "copy it again") from error
    return image
