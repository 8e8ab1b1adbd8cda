"""Settings of the matching stage."""

from __future__ import annotations

import msgspec


class MatchingConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the matching stage."""
