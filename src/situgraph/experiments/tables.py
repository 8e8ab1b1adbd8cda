"""The summary of an experiment as tables: a line a case, a column a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple


class Table(NamedTuple):
    """A titled table; the first column names the case, an absent figure is None."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


def summary_tables(summary: Mapping[str, Any], title: str = "") -> Iterator[Table]:
    """Tables of a nested summary.

    Cases whose figures are plain values share a table, with a column for every figure one of them
    has; single figures make a table of two columns; deeper levels follow, named by their path. A
    figure of a case that is itself a few values (median, max) takes a column for each.
    """
    single = {key: value for key, value in summary.items() if not isinstance(value, Mapping)}
    nested = {key: _row(value) for key, value in summary.items() if isinstance(value, Mapping)}
    if single:
        yield Table(title, ("figure", "value"), [(k, shown(v)) for k, v in single.items()])
    flat = {key: value for key, value in nested.items() if _is_flat(value)}
    if flat:
        columns = list(dict.fromkeys(name for value in flat.values() for name in value))
        rows = [(key, *(shown(value.get(c)) for c in columns)) for key, value in flat.items()]
        yield Table(title, ("case", *columns), rows)
    for key, value in nested.items():
        if key not in flat:
            yield from summary_tables(value, f"{title} / {key}" if title else str(key))


def markdown(table: Table) -> str:
    """The table in Markdown, with its title in bold above."""
    head = f"**{table.title}**\n\n" if table.title else ""
    lines = [table.columns, ["---"] * len(table.columns), *table.rows]
    return head + "".join(
        "| " + " | ".join("" if cell is None else str(cell) for cell in line) + " |\n"
        for line in lines
    )


def shown(value: Any) -> Any:
    """A figure as it is printed: four significant digits, lists joined."""
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if isinstance(value, list | tuple):
        return ", ".join(str(shown(item)) for item in value)
    return value


def _row(case: Mapping[str, Any]) -> Mapping[str, Any]:
    """The case with its small groups of values spread out, if it has plain figures beside them."""
    groups = [value for value in case.values() if isinstance(value, Mapping)]
    if len(groups) == len(case) or not all(map(_is_flat, groups)):
        return case
    row: dict[str, Any] = {}
    for key, value in case.items():
        if isinstance(value, Mapping):
            row |= {f"{key} {name}": inner for name, inner in value.items()}
        else:
            row[key] = value
    return row


def _is_flat(value: Mapping[str, Any]) -> bool:
    return not any(isinstance(item, Mapping) for item in value.values())
