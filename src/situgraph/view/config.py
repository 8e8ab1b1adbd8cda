"""Settings of the view stage."""

from __future__ import annotations

import msgspec


class ViewConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the view stage."""
