"""The exceptions situgraph raises on purpose; each message names the place and the remedy."""

from __future__ import annotations


class SituGraphError(Exception):
    """Bad input or a request that cannot be met; the command line prints it and exits with 2."""


class InputError(SituGraphError):
    """A file, graph or recording that cannot be used as it is."""

    def __init__(self, source: object, problem: str, remedy: str = "") -> None:
        """Join ``source`` (file, then place in it), ``problem`` and ``remedy`` to one sentence."""
        text = f"{source}: {problem}"
        super().__init__(f"{text}; {remedy}" if remedy else text)


class ConfigError(SituGraphError):
    """A setting that does not exist or does not accept the value given."""


class MissingExtraError(SituGraphError):
    """An optional dependency is needed and not installed."""
