"""What went wrong, was left out or could not be told: a code, a sentence, and how often."""

from __future__ import annotations

from situgraph.scenegraph.graph import Warning


class Notices:
    """One entry a code: the first sentence of each and how many there were."""

    def __init__(self) -> None:
        """Nothing noticed yet."""
        self._first: dict[str, str] = {}
        self._count: dict[str, int] = {}

    def add(self, code: str, sentence: str) -> None:
        """Notice ``code`` once more; only its first ``sentence`` is kept."""
        self._first.setdefault(code, sentence)
        self._count[code] = self._count.get(code, 0) + 1

    def count(self, code: str) -> int:
        """How often ``code`` was noticed."""
        return self._count.get(code, 0)

    def all(self) -> tuple[Warning, ...]:
        """One warning a code, in the order of their first occurrence."""
        return tuple(
            Warning(code, text if (n := self._count[code]) == 1 else f"{text} ({n} times)")
            for code, text in self._first.items()
        )
