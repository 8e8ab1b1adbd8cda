"""What a setting says of itself: every stage's ``config.py`` declares its numbers with this."""

from __future__ import annotations

from typing import Any

import msgspec


def setting(description: str, unit: str, source: str, **bounds: Any) -> msgspec.Meta:
    """What a setting means, its unit, where its value is from, its bounds (``ge``, ``lt`` ...)."""
    return msgspec.Meta(description=description, extra={"unit": unit, "source": source}, **bounds)
