"""What an experiment gives: rows and a summary, as JSON, CSV and a value."""

from __future__ import annotations

import csv
import functools
import io
import json
import math
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from situgraph.scenegraph.files import write_atomic


@dataclass(frozen=True)
class ExperimentResult:
    """Rows in the order of the tasks, and their summary; ``to_dict`` is the experiment JSON."""

    name: str
    seed: int
    situgraph: str
    rows: list[dict[str, Any]]
    summary: dict[str, Any]
    machine: dict[str, Any] = field(default_factory=dict)
    full: bool = False

    def to_dict(self) -> dict[str, Any]:
        """The experiment JSON, version 1; only finite numbers, null where a value is not."""
        return {
            "format": "situgraph/experiment",
            "version": 1,
            "name": self.name,
            "seed": self.seed,
            "situgraph": self.situgraph,
            "full": self.full,
            "machine": plain(self.machine),
            "rows": plain(self.rows),
            "summary": plain(self.summary),
        }

    def write(self, folder: Path) -> list[Path]:
        """Write ``NAME.json`` and ``NAME.csv`` into the folder; return their paths.

        Raises:
            InputError: the folder cannot be written to.
        """
        text = strict_json(self.to_dict(), indent=1)
        return [
            write_atomic(folder / f"{self.name}.json", text.encode() + b"\n"),
            write_atomic(folder / f"{self.name}.csv", _csv(plain(self.rows)).encode()),
        ]


def plain(value: Any) -> Any:
    """The value in JSON's own types: lists for tuples, numbers for numpy's, None for NaN."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, str | bool | int):
        return value
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    raise TypeError(f"{type(value).__name__} has no place in a result; use JSON's types")


def strict_json(value: Any, *, indent: int | None = None, sort_keys: bool = False) -> str:
    """JSON without NaN, the same bytes for the same value."""
    return json.dumps(
        plain(value), indent=indent, sort_keys=sort_keys, ensure_ascii=False, allow_nan=False
    )


@functools.cache
def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as file:
            for line in file:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def machine() -> dict[str, Any]:
    """What the figures were measured on: processor, cores, system, Python (no names, no paths)."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }


def _csv(rows: list[dict[str, Any]]) -> str:
    """The rows as CSV; nested values as JSON, columns in the order in which they first occur."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        cells = (row.get(name) for name in columns)
        writer.writerow([strict_json(c) if isinstance(c, list | dict) else c for c in cells])
    return text.getvalue()
