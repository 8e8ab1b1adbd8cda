"""Names from models and files, made safe and short enough to be drawn."""

from __future__ import annotations

import math
import unicodedata

# Advances of the drawings' typeface, as shares of the type size, by kind of letter.
_NARROW, _SMALL, _LARGE, _WIDE, _FULL = 0.33, 0.61, 0.7, 0.9, 1.0


def plain(text: object, limit: int = 120) -> str:
    """``text`` on one line without control characters, cut to ``limit`` letters."""
    kept = (" " if c.isspace() else c for c in str(text) if c.isspace() or _drawable(c))
    line = " ".join("".join(kept).split())
    return line if len(line) <= limit else line[: limit - 1].rstrip() + "…"


def _drawable(letter: str) -> bool:
    # Control, format (bidirectional overrides), surrogate and unassigned code points break SVG
    # or make a name read as another one.
    return unicodedata.category(letter) not in ("Cc", "Cf", "Cs", "Cn", "Co")


def width(text: str, size: float) -> float:
    """About how wide ``text`` is in points when set in ``size`` points."""
    return size * sum(_advance(c) for c in text)


def _advance(letter: str) -> float:
    if letter in " .,:;!|'()[]iIjlftr·-":
        return _NARROW
    if letter in "mwMW@%—…":
        return _WIDE
    if unicodedata.east_asian_width(letter) in "WF":
        return _FULL
    return _LARGE if letter.isupper() else _SMALL


def fitted(
    text: str, room: float, height: float, smallest: float, largest: float
) -> tuple[str, float] | None:
    """``text`` on one or two lines and the type size (points) that fits, or None.

    ``room`` and ``height`` are the space in points.
    """
    best: tuple[str, float] | None = None
    for lines in _layouts(text):
        across = max(width(line, 1.0) for line in lines)
        size = min(largest, room / max(across, 1e-9), height / (1.25 * len(lines)))
        if size >= smallest and (best is None or size > best[1] + 0.5):
            best = ("\n".join(lines), size)
    return best


def _layouts(text: str) -> list[tuple[str, ...]]:
    words = text.split(" ")
    halves = [(" ".join(words[:i]), " ".join(words[i:])) for i in range(1, len(words))]
    two = min(halves, key=lambda h: max(len(h[0]), len(h[1])), default=None)
    return [(text,)] if two is None else [(text,), two]


def metres(length: float) -> str:
    """A length to read: ``3 mm``, ``4 cm``, ``1.25 m``."""
    if 0.0 < abs(length) < 0.0095:
        return f"{1000.0 * length:.0f} mm"
    return f"{100.0 * length:.0f} cm" if abs(length) < 0.995 else f"{length:.2f} m"


def number(value: float) -> str:
    """A number to read: three digits, thousands apart."""
    if value == int(value) and abs(value) < 1e15:
        return f"{int(value):,}".replace(",", " ")
    return f"{value:.3g}"


def seconds(value: float) -> str:
    """A duration to read: ``0.35 ms``, ``12 s``."""
    if value < 1e-3:
        return f"{1e6 * value:.0f} µs"
    if value < 1.0:
        return f"{1e3 * value:.3g} ms"
    return f"{value:.3g} s" if value < 120.0 else f"{value / 60.0:.3g} min"


def percent(probability: float) -> str:
    """A probability to read, never rounded to certainty."""
    rest = min(probability, 1.0 - probability)
    if rest <= 0.0:
        return f"{100.0 * probability:.0f} %"
    if rest < 1e-7:
        return "< 0.00001 %" if probability < 0.5 else "> 99.99999 %"
    digits = max(0, -math.floor(math.log10(100.0 * rest)))
    return f"{100.0 * probability:.{digits}f} %"
