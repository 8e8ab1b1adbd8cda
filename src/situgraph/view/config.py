"""Settings of the pictures and reports."""

from __future__ import annotations

from typing import Annotated, Final

import msgspec

from situgraph.setting import setting

_LOOKED = "own choice, by looking at the pictures"


class ViewConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How graphs, matches and experiments are drawn; nothing here changes a result."""

    dpi: Annotated[
        int,
        setting("Resolution of PNG pictures.", "dots per inch", _LOOKED, ge=40, le=600),
    ] = 160
    page_width: Annotated[
        float,
        setting("Width of a whole picture.", "inch", _LOOKED, ge=5.0, le=40.0),
    ] = 11.0
    smallest_text: Annotated[
        float,
        setting("Names that only fit in smaller letters are left out.", "point", _LOOKED, ge=2.0),
    ] = 4.6
    max_panels: Annotated[
        int,
        setting("At most so many storeys in one picture.", "storeys", _LOOKED, ge=1, le=60),
    ] = 12
    max_rivals: Annotated[
        int,
        setting("At most so many rival solutions side by side.", "solutions", _LOOKED, ge=1, le=12),
    ] = 6
    max_rows: Annotated[
        int,
        setting("Longer tables of a report are cut, and say so.", "rows", _LOOKED, ge=5),
    ] = 60
    wall_gap: Annotated[
        float,
        setting(
            "Two faces this close are one wall.",
            "m",
            "thickest inner walls of the test models",
            gt=0.0,
            le=2.0,
        ),
    ] = 0.6
    one_face_thickness: Annotated[
        float,
        setting("Drawn thickness of a wall with one known face.", "m", _LOOKED, gt=0.0, le=1.0),
    ] = 0.2
    door_width: Annotated[
        float,
        setting("Drawn width of a door without a size.", "m", "usual clear width", gt=0.0),
    ] = 0.9
    open_reach: Annotated[
        float,
        setting("How far a room is drawn where no plane bounds it.", "m", _LOOKED, gt=0.0),
    ] = 3.0
    detail_rooms: Annotated[
        int,
        setting(
            "Above so many rooms a storey, faces instead of walls.", "rooms", "time to draw", ge=1
        ),
    ] = 2500
    inline_svg_limit: Annotated[
        int,
        setting("A larger drawing enters a report as PNG.", "byte", _LOOKED, ge=10_000),
    ] = 3_000_000


USUAL: Final = ViewConfig()
