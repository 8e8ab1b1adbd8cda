"""A report: one HTML file with verdict, key figures, pictures, tables and warnings.

Whatever is put in is text and is escaped; only pictures, drawn by this package, enter as markup.
"""

from __future__ import annotations

import base64
import os
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import situgraph
from situgraph.scenegraph.files import write_atomic
from situgraph.scenegraph.graph import Warning
from situgraph.view.canvas import inline_svg, png_bytes
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.lettering import number, plain, seconds
from situgraph.view.page import document

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Tone = Literal["good", "doubt", "bad", "plain"]
Cell = str | float | int | None


class Section:
    """A part of a report under its own heading; every method returns the section."""

    def __init__(self, title: str, key: str, config: ViewConfig) -> None:
        self.title = title
        self.key = key
        self._config = config
        self._parts: list[str] = []
        self._pictures = 0

    def text(self, sentence: str) -> Section:
        """A paragraph."""
        self._parts.append(f"<p>{_say(sentence, 2000)}</p>")
        return self

    def picture(self, figure: Figure, caption: str = "", *, small: bool = False) -> Section:
        """A drawing as SVG, or as PNG where that would be very large."""
        self._pictures += 1
        image = inline_svg(figure, f"{self.key}p{self._pictures}", plain(caption or self.title))
        if len(image) > self._config.inline_svg_limit:
            data = base64.b64encode(png_bytes(figure, self._config.dpi)).decode()
            image = f'<img alt="{_say(caption)}" src="data:image/png;base64,{data}">'
        below = f"<figcaption>{_say(caption, 600)}</figcaption>" if caption else ""
        kind = ' class="small"' if small else ""
        self._parts.append(f"<figure{kind}>{image}{below}</figure>")
        return self

    def table(
        self, columns: Sequence[str], rows: Iterable[Sequence[Cell]], caption: str = ""
    ) -> Section:
        """A table; numbers stand right. Rows beyond ``max_rows`` are counted, not shown."""
        body = [list(row) for row in rows]
        shown = body[: self._config.max_rows]
        right = [
            bool(shown) and all(isinstance(r[i], int | float | None) for r in shown)
            for i in range(len(columns))
        ]
        kinds = [' class="n"' if r else "" for r in right]
        head = "".join(f"<th{k}>{_say(c)}</th>" for c, k in zip(columns, kinds))
        lines = "".join(
            "<tr>" + "".join(f"<td{k}>{_cell(c)}</td>" for c, k in zip(row, kinds)) + "</tr>"
            for row in shown
        )
        title = f"<caption>{_say(caption)}</caption>" if caption else ""
        self._parts.append(
            f'<div class="wide"><table>{title}<thead><tr>{head}</tr></thead>'
            f"<tbody>{lines}</tbody></table></div>"
        )
        if len(body) > len(shown):
            rest = number(len(body) - len(shown))
            self._parts.append(f'<p class="note">{rest} further rows are not shown.</p>')
        return self

    def bars(self, rows: Sequence[tuple[str, float, str]], caption: str = "") -> Section:
        """Horizontal bars: a label, a length that is not negative, and what to say of it."""
        longest = max((length for _, length, _ in rows), default=0.0) or 1.0
        lines = "".join(
            f"<tr><td>{_say(label)}</td>"
            f'<td><i style="width:{100.0 * length / longest:.1f}%"></i></td>'
            f'<td class="n">{_say(words)}</td></tr>'
            for label, length, words in rows
        )
        title = f"<caption>{_say(caption)}</caption>" if caption else ""
        self._parts.append(f'<table class="bars">{title}<tbody>{lines}</tbody></table>')
        return self

    def timings(self, stages: Mapping[str, float], caption: str = "") -> Section:
        """Bars of seconds by stage."""
        return self.bars([(k, max(v, 0.0), seconds(v)) for k, v in stages.items()], caption)

    def fold(self, summary: str, lines: Sequence[str], count: int | None = None) -> Section:
        """A list that opens on demand."""
        items = "".join(f"<li>{_say(line, 400)}</li>" for line in lines)
        badge = "" if count is None else f'<span class="count">{number(count)}</span>'
        self._parts.append(
            f"<details><summary>{badge}<b>{_say(summary)}</b></summary><ul>{items}</ul></details>"
        )
        return self

    def html(self) -> str:
        """The section as HTML."""
        return (
            f'<section id="{self.key}"><h2>{_say(self.title)}</h2>{"".join(self._parts)}</section>'
        )


class Report:
    """A report being put together; ``save`` writes it."""

    def __init__(self, title: str, subtitle: str = "", config: ViewConfig = USUAL) -> None:
        self.title = title
        self.subtitle = subtitle
        self._config = config
        self._banner = ""
        self._facts: list[str] = []
        self._sections: list[Section] = []

    def banner(self, verdict: str, sentence: str, tone: Tone = "plain") -> Report:
        """The verdict, at the top."""
        self._banner = (
            f'<div class="banner {tone}"><b>{_say(verdict)}</b>{_say(sentence, 900)}</div>'
        )
        return self

    def fact(self, label: str, value: Cell, remark: str = "") -> Report:
        """A key figure."""
        below = f"<small>{_say(remark)}</small>" if remark else ""
        self._facts.append(f"<div><dt>{_say(label)}</dt><dd>{_cell(value)}{below}</dd></div>")
        return self

    def section(self, title: str) -> Section:
        """A new section at the end."""
        section = Section(title, f"s{len(self._sections) + 1}", self._config)
        self._sections.append(section)
        return section

    def warnings(self, warnings: Sequence[Warning], title: str = "Warnings") -> Report:
        """A section of warnings grouped by their codes, the most frequent first."""
        if warnings:
            section = self.section(title)
            groups: dict[str, list[Warning]] = {}
            for warning in warnings:
                groups.setdefault(warning.code, []).append(warning)
            for code, group in sorted(groups.items(), key=lambda g: (-len(g[1]), g[0])):
                lines = [_warning(w) for w in group[: self._config.max_rows]]
                rest = len(group) - len(lines)
                section.fold(
                    code, lines + ([f"and {number(rest)} more"] if rest else []), len(group)
                )
        return self

    def settings(self, settings: Mapping[str, object], title: str = "Settings used") -> Report:
        """A section of settings, one line each."""
        self.section(title).table(
            ("setting", "value"), [(key, _value(value)) for key, value in sorted(settings.items())]
        )
        return self

    def html(self) -> str:
        """The page. The same content gives the same bytes."""
        links = "".join(f'<a href="#{s.key}">{_say(s.title)}</a>' for s in self._sections)
        parts = [
            f"<h1>{_say(self.title)}</h1>",
            f'<p class="sub">{_say(self.subtitle, 400)}</p>' if self.subtitle else "",
            self._banner,
            f'<dl class="facts">{"".join(self._facts)}</dl>' if self._facts else "",
            f"<nav>{links}</nav>" if len(self._sections) > 2 else "",
            *(s.html() for s in self._sections),
            f"<footer>situgraph {situgraph.__version__}</footer>",
        ]
        return document(plain(self.title), "\n".join(p for p in parts if p))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page, whole or not at all.

        Raises:
            InputError: the file cannot be written.
        """
        return write_atomic(path, self.html().encode("utf-8", "replace"))


def _say(text: object, limit: int = 200) -> str:
    return escape(plain(text, limit))


def _cell(value: Cell) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return number(value)
    return _say(value, 400)


def _value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else plain(value, 200)


def _warning(warning: Warning) -> str:
    ids = ", ".join(warning.ids[:8]) + (" …" if len(warning.ids) > 8 else "")
    return f"{warning.message} ({ids})" if ids else warning.message
