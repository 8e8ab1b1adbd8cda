"""The measures of synthetic layouts, each with its unit."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

Kind = Literal["random", "modular", "grid", "wings", "corridor", "lshaped", "storeys"]
Symmetry = Literal["none", "local", "global"]


class LayoutConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How layouts are drawn; the defaults follow the generator behind the paper's dataset."""

    thickness_min: Annotated[
        float,
        msgspec.Meta(gt=0, description="Thinnest wall.", extra={"unit": "m", "source": "FACTS"}),
    ] = 0.05
    thickness_max: Annotated[
        float,
        msgspec.Meta(gt=0, description="Thickest wall.", extra={"unit": "m", "source": "FACTS"}),
    ] = 0.15
    cell_min: Annotated[
        float,
        msgspec.Meta(gt=0, description="Narrowest cell of the grid.", extra={"unit": "m"}),
    ] = 2.0
    cell_max: Annotated[
        float, msgspec.Meta(gt=0, description="Widest cell of the grid.", extra={"unit": "m"})
    ] = 3.6
    module: Annotated[
        float,
        msgspec.Meta(gt=0, description="Planning module of modular rooms.", extra={"unit": "m"}),
    ] = 1.2
    grid_room: Annotated[
        tuple[float, float],
        msgspec.Meta(
            description="Width and depth of a grid cell between wall centre lines.",
            extra={"unit": "m"},
        ),
    ] = (5.0, 4.0)
    corridor_width: Annotated[
        float, msgspec.Meta(gt=0, description="Corridors, wall to wall.", extra={"unit": "m"})
    ] = 2.0
    room_height: Annotated[
        float, msgspec.Meta(gt=0, description="Floor to ceiling.", extra={"unit": "m"})
    ] = 2.8
    storey_height: Annotated[
        float, msgspec.Meta(gt=0, description="Floor to floor.", extra={"unit": "m"})
    ] = 3.2
    position_range: Annotated[
        float,
        msgspec.Meta(
            ge=0, description="The layout's centre lies within this of 0.", extra={"unit": "m"}
        ),
    ] = 50.0
    lshaped_share: Annotated[
        float,
        msgspec.Meta(ge=0, le=1, description="Share of big rooms that become L-shaped."),
    ] = 0.6
    loop_doors: Annotated[
        float,
        msgspec.Meta(
            ge=0, le=1, description="Share of shared walls with a door beyond the spanning tree."
        ),
    ] = 0.2
    window_share: Annotated[
        float, msgspec.Meta(ge=0, le=1, description="Share of window places that get a window.")
    ] = 0.75
    rooms_per_exit: Annotated[
        float, msgspec.Meta(gt=0, description="Rooms for one door to the outside.")
    ] = 15.0
    others_per_room: Annotated[
        float,
        msgspec.Meta(ge=0, description="Mean number of other objects a room, no density given."),
    ] = 1.5
