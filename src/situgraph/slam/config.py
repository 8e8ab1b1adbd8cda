"""Settings of the slam stage."""

from __future__ import annotations

import msgspec


class SlamConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the slam stage."""
