"""Figures to bytes: the same drawing gives the same bytes."""

from __future__ import annotations

import io
import os
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from situgraph.errors import InputError
from situgraph.scenegraph.files import write_atomic
from situgraph.view import palette

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
_SCREEN = 1.28  # pixels on a page for a point of a drawing
_FONTS = "Inter, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif"


def save_figure(figure: Figure, path: str | os.PathLike[str], dpi: int = 160) -> Path:
    """Write a figure as ``.png``, ``.svg`` or ``.pdf``, whole or not at all.

    Raises:
        InputError: another ending, or the file cannot be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise InputError(path, f"'{ending}' is no picture format", f"use {', '.join(FORMATS)}")
    if ending == ".svg":
        return write_atomic(path, svg_text(figure).encode())
    return write_atomic(path, _rendered(figure, ending[1:], dpi))


def png_bytes(figure: Figure, dpi: int = 160) -> bytes:
    """The figure as PNG."""
    return _rendered(figure, "png", dpi)


def svg_text(figure: Figure) -> str:
    """The figure as an SVG document, with letters as text."""
    text = _rendered(figure, "svg", 72).decode()
    return text.replace("'DejaVu Sans'", _FONTS)


def inline_svg(figure: Figure, name: str, label: str) -> str:
    """The figure as an SVG element for an HTML page.

    It takes the width of its place; its ids start with ``name``, so that several fit on a page; its
    colours are the page's variables, so that they follow light and dark. ``label`` is read aloud.
    """
    from html import escape

    text = svg_text(figure)
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r"<style.*?</style>", "", text, count=1, flags=re.DOTALL)  # the page has it
    # Only inside tags: a room may be called id="x" or fill: #ffffff.
    text = re.sub(r"<[^>]*>", lambda tag: _local(tag[0], name), text)
    head, rest = text.split(">", 1)
    head = re.sub(r'\s(?:width|height)="[^"]*"', "", head)
    wide = _SCREEN * 72.0 * figure.get_figwidth()
    style = f'style="max-width:{wide:.0f}px"'  # so that letters are as large in every picture
    return f'{head} {style} role="img" aria-label="{escape(label)}">{rest}'


def _local(tag: str, name: str) -> str:
    """A tag with ids of its own and colours that follow the page."""
    tag = re.sub(r'\bid="([^"]*)"', rf'id="{name}-\1"', tag)
    tag = re.sub(r'xlink:href="#([^"]*)"', rf'xlink:href="#{name}-\1"', tag)
    tag = re.sub(r"url\(#([^)]*)\)", rf"url(#{name}-\1)", tag)
    return re.sub(r"(?:fill|stroke): (#[0-9a-f]{6})", _variable, tag)


def _variable(match: re.Match[str]) -> str:
    color = match[1]
    if color not in palette.DARK:
        return match[0]
    return match[0].replace(color, f"var(--{color[1:]}, {color})")


def _rendered(figure: Figure, form: str, dpi: int) -> bytes:
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    stamps: dict[str, dict[str, str | None]] = {
        "png": {"Software": None},
        "svg": {"Date": None, "Creator": "situgraph"},
        "pdf": {"CreationDate": None, "Creator": "situgraph", "Producer": None},
    }
    buffer = io.BytesIO()
    fixed: Any = {  # matplotlib's stub lists every key by name
        "svg.hashsalt": "situgraph",
        "svg.fonttype": "none",
        "pdf.fonttype": 42,
        "font.family": ["DejaVu Sans"],
        "hatch.linewidth": 0.5,
        "path.simplify": False,
    }
    with mpl.rc_context(fixed), warnings.catch_warnings():
        # A name in a script that the typeface lacks is drawn as boxes in PNG and whole in SVG.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        FigureCanvasAgg(figure)
        figure.savefig(buffer, format=form, dpi=dpi, metadata=stamps[form])
    return buffer.getvalue()
