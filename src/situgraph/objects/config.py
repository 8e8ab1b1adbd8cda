"""Settings of the objects stage."""

from __future__ import annotations

import msgspec


class ObjectsConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the objects stage."""
