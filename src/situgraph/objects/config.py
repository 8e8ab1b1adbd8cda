"""Settings of the objects stage."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta


class ObjectsConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the objects stage."""

    visibility_margin: Annotated[
        float,
        Meta(
            ge=0,
            lt=1,
            description="share of the ray from room centre to object behind a wall that is allowed",
            extra={"unit": "1", "source": "paper, 'Objects in rooms' (epsilon)"},
        ),
    ] = 0.1
    wall_distance: Annotated[
        float,
        Meta(
            gt=0,
            description="farthest a wall-mounted object's centre may be from its wall face",
            extra={"unit": "m", "source": "paper, 'Objects on wall planes' (tau)"},
        ),
    ] = 0.3
    wall_thickness: Annotated[
        float,
        Meta(
            gt=0,
            description="thickest wall whose two faces share a door",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.6
    extent_margin: Annotated[
        float,
        Meta(
            ge=0,
            description="how far past the seen end of a face an object may still hang on it",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.5
    storey_height: Annotated[
        float,
        Meta(
            gt=0,
            description="height of a storey that does not tell its own",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 3.0
    doorway_width: Annotated[
        float,
        Meta(
            gt=0,
            description="width of a doorway known from the trajectory alone",
            extra={"unit": "m", "source": "usual door leaf"},
        ),
    ] = 0.9
    doorway_height: Annotated[
        float,
        Meta(
            gt=0,
            description="height of a doorway known from the trajectory alone",
            extra={"unit": "m", "source": "usual door leaf"},
        ),
    ] = 2.1
    doorway_merge: Annotated[
        float,
        Meta(
            gt=0,
            description="two doorways of one wall closer than this are one",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.8
