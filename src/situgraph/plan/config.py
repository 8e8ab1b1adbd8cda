"""Settings of the plan stage."""

from __future__ import annotations

from typing import Annotated

import msgspec

from situgraph.setting import setting

_SURVEY = "survey of eight building models, docs/plan.md"


class PlanConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a building model becomes an A-Graph. Lengths in metres, angles in radians."""

    face_tilt: Annotated[
        float,
        setting("A face this far from vertical still bounds a room", "rad", _SURVEY, ge=0, le=1),
    ] = 0.09
    coplanar_angle: Annotated[
        float, setting("Facets that differ less are one face", "rad", _SURVEY, ge=0, le=0.5)
    ] = 0.0175
    coplanar_offset: Annotated[
        float, setting("Facets whose planes differ less are one face", "m", _SURVEY, ge=0, le=1)
    ] = 0.02
    coplanar_gap: Annotated[
        float,
        setting(
            "Coplanar stretches with a wider gap between are faces of their own", "m", _SURVEY, ge=0
        ),
    ] = 1.5
    min_face_length: Annotated[
        float, setting("Shorter faces are slivers and left out", "m", _SURVEY, ge=0, le=10)
    ] = 0.1
    min_face_height: Annotated[
        float, setting("Lower faces are slivers and left out", "m", _SURVEY, ge=0, le=10)
    ] = 0.6
    wall_gap: Annotated[
        float, setting("A wall face this near a room's face is behind it", "m", _SURVEY, ge=0, le=2)
    ] = 0.3
    knee_wall: Annotated[
        float, setting("A wall this high above the floor stands behind a face", "m", _SURVEY, ge=0)
    ] = 0.4
    virtual_share: Annotated[
        float,
        setting("A face with less of its length backed is virtual", "1", _SURVEY, ge=0, le=1),
    ] = 0.1
    door_overlap: Annotated[
        float,
        setting(
            "A face that carries this share of a door's width hosts it", "1", _SURVEY, gt=0, le=1
        ),
    ] = 0.5
    window_overlap: Annotated[
        float,
        setting(
            "A face that carries this share of a window's width hosts it", "1", _SURVEY, gt=0, le=1
        ),
    ] = 0.25
    passage_sill: Annotated[
        float,
        setting("A bare opening that ends lower can be walked through", "m", _SURVEY, ge=0, le=2),
    ] = 0.3
    passage_height: Annotated[
        float, setting("A bare opening this high can be walked through", "m", _SURVEY, ge=0, le=10)
    ] = 1.7
    passage_width: Annotated[
        float, setting("A bare opening this wide can be walked through", "m", _SURVEY, ge=0, le=10)
    ] = 0.5
    mount_gap: Annotated[
        float, setting("A fixture this near a wall face hangs on it", "m", _SURVEY, ge=0, le=1)
    ] = 0.15
    min_semi_axis: Annotated[
        float,
        setting("Smallest semi-axis of an ellipsoid", "m", "as in the objects stage", ge=0, le=1),
    ] = 0.05
    storey_tolerance: Annotated[
        float,
        setting(
            "A declared storey elevation this far from its floors is odd", "m", _SURVEY, ge=0, le=5
        ),
    ] = 0.3
    storey_split: Annotated[
        float, setting("Floors this far apart are different storeys", "m", _SURVEY, gt=0, le=10)
    ] = 1.8
    far: Annotated[
        float,
        setting("Coordinates beyond this are shifted to the origin", "m", _SURVEY, gt=0, le=1e6),
    ] = 1000.0
    ignore_spaces: Annotated[
        bool,
        setting("Derive rooms from walls even where the model has spaces", "", "user's choice"),
    ] = False
    cut_height: Annotated[
        float,
        setting(
            "Rooms are derived from walls cut this high above a storey", "m", _SURVEY, gt=0, le=5
        ),
    ] = 1.2
    close_gap: Annotated[
        float,
        setting(
            "Walls this near each other touch when rooms are derived", "m", _SURVEY, ge=0, le=1
        ),
    ] = 0.1
    min_room_area: Annotated[
        float,
        setting("Smaller enclosures are shafts, not derived rooms", "m2", _SURVEY, ge=0, le=100),
    ] = 1.5
    min_room_width: Annotated[
        float,
        setting("Narrower enclosures are shafts, not derived rooms", "m", _SURVEY, ge=0, le=10),
    ] = 0.6
    passage_gap: Annotated[
        float,
        setting(
            "A passage of an indoor map lies this near the faces it joins", "m", "SIST map", ge=0
        ),
    ] = 0.6
    door_height: Annotated[
        float,
        setting("Height of a door where an indoor map gives none", "m", "usual door", gt=0, le=10),
    ] = 2.0
    max_osm_mb: Annotated[
        int, setting("Larger indoor maps are refused", "MB", "bounded input", ge=1, le=4_000)
    ] = 64
    max_file_mb: Annotated[
        int, setting("Larger building models are refused", "MB", "bounded input", ge=1, le=16_000)
    ] = 1024
    max_memory_mb: Annotated[
        int,
        setting(
            "Address space the reader of a building model may take", "MB", "bounded input", ge=64
        ),
    ] = 8192
    max_seconds: Annotated[
        float, setting("Longest time the reader may take", "s", "bounded input", gt=0, le=86_400)
    ] = 600.0
    isolate: Annotated[
        bool,
        setting(
            "Parse building models in a child process, so that a crash stays there",
            "",
            "robustness",
        ),
    ] = True
