"""Settings of the plan stage."""

from __future__ import annotations

import msgspec


class PlanConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the plan stage."""
