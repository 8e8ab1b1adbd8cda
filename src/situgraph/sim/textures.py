"""Procedural textures by seed: grey patterns of mean 200 that tile; a material tints one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array

SIZE = 256  # px, a texture's side
LAYERS = 11  # how many there are


def textures(seed: int) -> NDArray[np.uint8]:
    """All texture layers (LAYERS, SIZE, SIZE, 3)."""
    return np.stack([draw(np.random.default_rng([seed, 7002, i])) for i, draw in enumerate(_DRAW)])


def _smooth(rng: np.random.Generator, fx: float, fy: float) -> Array:
    """Periodic noise (SIZE, SIZE) of zero mean and unit deviation, cut off at fx, fy."""
    spectrum = np.fft.rfft2(rng.normal(size=(SIZE, SIZE)))
    ky = np.abs(np.fft.fftfreq(SIZE) * SIZE)[:, None]
    kx = np.fft.rfftfreq(SIZE)[None, :] * SIZE
    noise = np.fft.irfft2(spectrum * np.exp(-((kx / fx) ** 2) - (ky / fy) ** 2), s=(SIZE, SIZE))
    return np.asarray((noise - noise.mean()) / (noise.std() + 1e-12))


def _grey(value: Array) -> NDArray[np.uint8]:
    grey = np.clip(np.rint(value), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def _plain(rng: np.random.Generator) -> NDArray[np.uint8]:
    return _grey(203 + 2.0 * _smooth(rng, 60, 60) + 3.0 * _smooth(rng, 3, 3))


def _plaster(rng: np.random.Generator) -> NDArray[np.uint8]:
    return _grey(200 + 9.0 * _smooth(rng, 45, 45) + 5.0 * _smooth(rng, 5, 5))


def _joints(columns: int, rows: int, width: float, shift: float) -> tuple[Array, NDArray[np.int64]]:
    """Where joints are (0..1) and the number of the brick each pixel is in."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    row = np.floor(y * rows)
    u, v = (x * columns + shift * (row % 2)) % columns, y * rows % 1.0
    w = u % 1.0
    edge = np.minimum(np.minimum(w, 1 - w) / columns, np.minimum(v, 1 - v) / rows) * SIZE
    brick = (row * columns + np.floor(u)).astype(np.int64)
    return np.clip(1.5 - edge / width, 0.0, 1.0), brick


def _bricks(rng: np.random.Generator) -> NDArray[np.uint8]:
    joint, brick = _joints(4, 10, 1.5, 0.5)
    face = 190 + rng.normal(0, 16, 64)[brick] + 7 * _smooth(rng, 60, 60)
    return _grey(face * (1 - joint) + 230 * joint)


def _tiles(rng: np.random.Generator) -> NDArray[np.uint8]:
    count = int(rng.integers(2, 5))
    joint, tile = _joints(count, count, 1.2, 0.0)
    face = 210 + rng.normal(0, 5, 64)[tile] + 3 * _smooth(rng, 20, 20)
    return _grey(face * (1 - joint) + float(rng.uniform(110, 170)) * joint)


def _planks(rng: np.random.Generator) -> NDArray[np.uint8]:
    joint, plank = _joints(2, 8, 0.8, 0.5)
    face = 198 + rng.normal(0, 13, 64)[plank] + 9 * _smooth(rng, 6, 70)
    return _grey(face * (1 - 0.6 * joint))


def _grain(rng: np.random.Generator) -> NDArray[np.uint8]:
    return _grey(200 + 12 * _smooth(rng, 40, 3) + 5 * _smooth(rng, 6, 2))


def _stripes(rng: np.random.Generator) -> NDArray[np.uint8]:
    x = np.arange(SIZE)[None, :] / SIZE
    wave = np.sign(np.sin(2 * np.pi * int(rng.integers(4, 13)) * x))
    return _grey(203 + float(rng.uniform(4, 18)) * wave + 3 * _smooth(rng, 60, 60))


def _carpet(rng: np.random.Generator) -> NDArray[np.uint8]:
    return _grey(198 + 14 * _smooth(rng, 110, 110) + 5 * _smooth(rng, 8, 8))


def _panels(rng: np.random.Generator) -> NDArray[np.uint8]:
    joint, panel = _joints(int(rng.integers(1, 4)), int(rng.integers(1, 3)), 1.2, 0.0)
    return _grey((206 + rng.normal(0, 3, 64)[panel] + 2 * _smooth(rng, 30, 30)) * (1 - 0.3 * joint))


def _wainscot(rng: np.random.Generator) -> NDArray[np.uint8]:
    y = np.arange(SIZE)[:, None] / SIZE
    band = np.where(y < float(rng.uniform(0.3, 0.5)), float(rng.uniform(0.6, 0.9)), 1.0)
    return _grey((205 + 4 * _smooth(rng, 30, 30)) * band)


def _marble(rng: np.random.Generator) -> NDArray[np.uint8]:
    vein = np.abs(_smooth(rng, 5, 5) + 0.3 * _smooth(rng, 25, 25))
    return _grey(212 - 50 * np.exp(-vein * 9) + 2 * _smooth(rng, 60, 60))


_DRAW: tuple[Callable[[np.random.Generator], NDArray[np.uint8]], ...] = (
    _plain,
    _plaster,
    _bricks,
    _tiles,
    _planks,
    _grain,
    _stripes,
    _carpet,
    _panels,
    _wainscot,
    _marble,
)
