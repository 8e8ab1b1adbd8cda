"""Settings of the pictures and reports."""

from __future__ import annotations

from typing import Annotated, Final

import msgspec

_LOOKED = "own choice, by looking at the pictures"


class ViewConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How graphs, matches and experiments are drawn; nothing here changes a result."""

    dpi: Annotated[
        int,
        msgspec.Meta(
            ge=40,
            le=600,
            description="Resolution of PNG pictures.",
            extra={"unit": "dots per inch", "source": _LOOKED},
        ),
    ] = 160
    page_width: Annotated[
        float,
        msgspec.Meta(
            ge=5.0,
            le=40.0,
            description="Width of a whole picture.",
            extra={"unit": "inch", "source": _LOOKED},
        ),
    ] = 11.0
    smallest_text: Annotated[
        float,
        msgspec.Meta(
            ge=2.0,
            description="Names that only fit in smaller letters are left out.",
            extra={"unit": "point", "source": _LOOKED},
        ),
    ] = 4.6
    max_panels: Annotated[
        int,
        msgspec.Meta(
            ge=1,
            le=60,
            description="At most so many storeys in one picture.",
            extra={"unit": "storeys", "source": _LOOKED},
        ),
    ] = 12
    max_rivals: Annotated[
        int,
        msgspec.Meta(
            ge=1,
            le=12,
            description="At most so many rival solutions side by side.",
            extra={"unit": "solutions", "source": _LOOKED},
        ),
    ] = 6
    max_rows: Annotated[
        int,
        msgspec.Meta(
            ge=5,
            description="Longer tables of a report are cut, and say so.",
            extra={"unit": "rows", "source": _LOOKED},
        ),
    ] = 60
    wall_gap: Annotated[
        float,
        msgspec.Meta(
            gt=0.0,
            le=2.0,
            description="Two faces this close are one wall.",
            extra={"unit": "m", "source": "thickest inner walls of the test models"},
        ),
    ] = 0.6
    one_face_thickness: Annotated[
        float,
        msgspec.Meta(
            gt=0.0,
            le=1.0,
            description="Drawn thickness of a wall with one known face.",
            extra={"unit": "m", "source": _LOOKED},
        ),
    ] = 0.2
    door_width: Annotated[
        float,
        msgspec.Meta(
            gt=0.0,
            description="Drawn width of a door without a size.",
            extra={"unit": "m", "source": "usual clear width"},
        ),
    ] = 0.9
    open_reach: Annotated[
        float,
        msgspec.Meta(
            gt=0.0,
            description="How far a room is drawn where no plane bounds it.",
            extra={"unit": "m", "source": _LOOKED},
        ),
    ] = 3.0
    detail_rooms: Annotated[
        int,
        msgspec.Meta(
            ge=1,
            description="Above so many rooms a storey, faces instead of walls.",
            extra={"unit": "rooms", "source": "time to draw"},
        ),
    ] = 2500
    inline_svg_limit: Annotated[
        int,
        msgspec.Meta(
            ge=10_000,
            description="A larger drawing enters a report as PNG.",
            extra={"unit": "byte", "source": _LOOKED},
        ),
    ] = 3_000_000


USUAL: Final = ViewConfig()
