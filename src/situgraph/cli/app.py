"""The ``situgraph`` command: a table of commands, each loaded when called, and the exit codes.

0: done (any verdict of a match), 1: an internal error, 2: bad input, 130: interrupted.
"""

from __future__ import annotations

import errno
import importlib
import importlib.util
import os
import sys
from typing import Any, NoReturn

import click

from situgraph import __version__
from situgraph.errors import SituGraphError

# name -> the sentence of `situgraph --help`; module situgraph.cli.<name> defines `command`.
COMMANDS = {
    "demo": "The whole system on an embedded building; saves a report.",
    "plan": "A-Graph from a building model, and what is odd about the model.",
    "simulate": "Drive a simulated robot through a building.",
    "info": "What a recording holds.",
    "run": "SLAM, objects, matching and coupling on a recording.",
    "objects": "What a camera with known poses saw: an RGB-D folder, no SLAM.",
    "match": "Place an online scene graph in a prior one.",
    "synth": "Synthetic layouts and partial S-Graphs of them.",
    "experiment": "The paper's experiments and ours.",
    "view": "Look at a graph, a match or a run.",
    "config": "Every setting with value, unit and source.",
    "cache": "What is cached, and a way to clear it.",
}


LONGEST_REASON = 300  # characters of an internal error; compilers tell whole stories


class LazyGroup(click.Group):
    """A group that imports a command only when it is called, so that ``--help`` stays fast."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands whose module exists, in the order of the table."""
        return [n for n in COMMANDS if importlib.util.find_spec(f"situgraph.cli.{n}") is not None]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name, or None when there is none."""
        if cmd_name not in self.list_commands(ctx):
            return None
        command = importlib.import_module(f"situgraph.cli.{cmd_name}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl([(n, COMMANDS[n]) for n in self.list_commands(ctx)])

    def main(self, *args: Any, **kwargs: Any) -> NoReturn:
        """Run and end the process with the exit code of the outcome, one sentence on stderr."""
        kwargs["standalone_mode"] = False
        kwargs.setdefault("prog_name", "situgraph")
        try:
            outcome = super().main(*args, **kwargs)
            _end_output()
        except click.ClickException as error:
            error.show(file=sys.stderr)
            sys.exit(error.exit_code)
        except SituGraphError as error:
            _fail(str(error), 2)
        except (click.Abort, KeyboardInterrupt):
            _fail("interrupted; whatever was finished before is kept", 130)
        except BrokenPipeError:
            _drop_stdout()
            sys.exit(141)
        except OSError as error:
            _fail(_sentence(error), 2)
        except MemoryError:
            _fail("the memory of this machine is full; try a smaller input", 1)
        except Exception as error:
            _report(error)
        sys.exit(outcome if isinstance(outcome, int) else 0)


def _sentence(error: OSError) -> str:
    what = error.strerror or str(error) or type(error).__name__
    where = f"{error.filename}: " if error.filename else ""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return (
            f"{where}the disk is full; whatever was finished before is kept, make room and repeat"
        )
    return f"{where}{what}"


def _fail(sentence: str, code: int) -> NoReturn:
    click.echo(f"situgraph: error: {' '.join(sentence.split())}", err=True)
    sys.exit(code)


def _report(error: Exception) -> NoReturn:
    """An internal error: one sentence, and the traceback for those who ask for it."""
    if os.environ.get("SITUGRAPH_DEBUG"):
        raise error
    reason = f"{type(error).__name__}: {error}"[:LONGEST_REASON]
    remedy = "set SITUGRAPH_DEBUG=1 to see the traceback, and please report it"
    _fail(f"internal error, {reason}; {remedy}", 1)


def _end_output() -> None:
    """Let a full disk behind ``> file`` show here, not in the interpreter's shutdown."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError:
        _drop_stdout()
        raise


def _drop_stdout() -> None:
    devnull = os.open(os.devnull, os.O_WRONLY)
    os.dup2(devnull, sys.stdout.fileno())


@click.group("situgraph", cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="situgraph")
def main() -> None:
    """Locate a robot in its building: match the scene graph from its sensors with the plan's.

    Exit codes: 0 done (whatever the verdict), 2 bad input, 1 internal error, 130 interrupted.
    """
