"""Settings of the coupling stage."""

from __future__ import annotations

import msgspec


class CouplingConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the coupling stage."""
