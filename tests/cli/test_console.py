"""What goes to stdout and what to stderr."""

from __future__ import annotations

import json

import numpy as np
import pytest

from situgraph.cli.console import emit_json, print_table, progress
from situgraph.geometry.poses import Placement


def test_json_is_strict_and_alone_on_stdout(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    emit_json({"a": np.float64(1.5), "b": np.arange(2), "c": Placement(1.0), "d": "Büro 部屋"})
    output = capfdbinary.readouterr()
    assert json.loads(output.out) == {
        "a": 1.5,
        "b": [0, 1],
        "c": {"x": 1.0, "y": 0.0, "z": 0.0, "yaw": 0.0},
        "d": "Büro 部屋",
    }
    assert output.err == b""
    with pytest.raises(ValueError, match="not JSON compliant"):
        emit_json({"a": float("nan")})


def test_tables_go_to_stderr_and_names_are_not_markup(capsys: pytest.CaptureFixture[str]) -> None:
    print_table("[red]Rooms", ("name", "area"), [("[bold]Küche[/bold]", 12.0), (None, 3)])
    output = capsys.readouterr()
    assert output.out == ""
    assert "[bold]Küche[/bold]" in output.err
    assert "[red]Rooms" in output.err


def test_progress_is_silent_where_nobody_watches(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("reading", 3) as advance:
        advance()
        advance(2)
    assert capsys.readouterr() == ("", "")
