"""Exit codes, help, version: what a shell script may rely on."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from situgraph import __version__
from situgraph.cli import app
from situgraph.errors import InputError


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app.main, [str(a) for a in arguments])


def one_sentence(result: Result) -> str:
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    assert lines[0].startswith("situgraph: error: ")
    return lines[0]


def test_version_and_help() -> None:
    assert call("--version").stdout == f"situgraph, version {__version__}\n"
    listed = call("--help")
    assert listed.exit_code == 0
    for name in app.LazyGroup().list_commands(click.Context(app.main)):
        assert f"\n  {name} " in listed.stdout
        helped = call(name, "--help")
        assert helped.exit_code == 0
        assert "Usage: situgraph" in helped.stdout


def test_it_runs_as_a_module() -> None:
    command = [sys.executable, "-m", "situgraph", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == call("--version").stdout


def test_a_command_whose_module_is_missing_is_not_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(app.COMMANDS, "teleport", "Nothing yet.")
    assert "teleport" not in call("--help").stdout
    assert call("teleport").exit_code == 2


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (InputError("a.json", "no\nrooms", "add one"), 2, "a.json: no rooms; add one"),
        (OSError(errno.ENOSPC, "No space left on device", "out.json"), 2, "the disk is full"),
        (PermissionError(errno.EACCES, "Permission denied", "out.json"), 2, "out.json: Permission"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (ZeroDivisionError("oops"), 1, "internal error, ZeroDivisionError: oops"),
        (MemoryError(), 1, "memory"),
    ],
)
def test_errors_become_one_sentence_and_a_code(
    monkeypatch: pytest.MonkeyPatch, error: BaseException, code: int, words: str
) -> None:
    @click.command()
    def broken() -> None:
        raise error

    monkeypatch.setattr(app.LazyGroup, "get_command", lambda *_: broken)
    result = call("anything")
    assert result.exit_code == code
    assert result.stdout == ""
    assert words in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def run(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "situgraph.cli", *arguments]
    return subprocess.run(command, text=True, timeout=120, check=False, **options)  # type: ignore[call-overload, no-any-return]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a disk that is always full")
def test_a_full_disk_behind_stdout_is_said() -> None:
    with open("/dev/full", "w") as full:
        result = run("config", "--json", stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 2
    assert "the disk is full" in result.stderr
    assert "Traceback" not in result.stderr


def test_ctrl_c_ends_with_a_sentence() -> None:
    script = (
        "import os, signal, click, situgraph.cli.app as app\n"
        # Who is started in the background inherits that the signal is ignored.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "command = click.Command('x', callback=lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "app.LazyGroup.get_command = lambda *_: command\n"
        "app.main(['x'])"
    )
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False
    )
    assert result.returncode == 128 + signal.SIGINT
    assert "interrupted" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_closed_pipe_is_no_error() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        result = run("config", "--json", stdout=writing, stderr=subprocess.PIPE)
    finally:
        os.close(writing)
    assert "Traceback" not in result.stderr
    assert "internal error" not in result.stderr


def test_config_prints_every_setting(tmp_path: Path) -> None:
    listed = json.loads(call("config", "--json").stdout)
    assert {"key", "value", "default", "unit", "source", "description", "changed"} <= listed[
        0
    ].keys()
    file = tmp_path / "settings.yaml"
    file.write_text(call("config", "--yaml").stdout)
    assert json.loads(call("config", "--json", "--config", file).stdout) == listed
    assert call("config", "--yaml", "--json").exit_code == 2
    assert call("config").exit_code == 0


def test_an_unknown_setting_is_refused_with_the_nearest() -> None:
    listed = [s["key"] for s in json.loads(call("config", "--json").stdout)]
    if listed:
        key = listed[0]
        assert f"the nearest is {key}" in one_sentence(call("config", "--set", f"{key}s=1"))
    assert "unknown setting" in one_sentence(call("config", "--set", "matchin.zzz=1"))


def test_cache_is_shown_and_cleared(own_cache: Path) -> None:
    (own_cache / "plans").mkdir(parents=True, exist_ok=True)
    (own_cache / "plans" / "x").write_bytes(b"12345")
    shown = json.loads(call("cache", "--json").stdout)
    assert next(k for k in shown["kinds"] if k["kind"] == "plans")["files"] >= 1
    assert call("cache", "--clear").exit_code == 0
    assert not (own_cache / "plans").exists()


def test_every_setting_says_what_it_is() -> None:
    for setting in json.loads(call("config", "--json").stdout):
        assert setting["description"], setting["key"]
        assert setting["source"], setting["key"]
        if isinstance(setting["value"], float):
            assert setting["unit"], setting["key"]
