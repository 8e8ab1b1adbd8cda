"""Settings of the plan stage."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec


def _meta(description: str, unit: str, source: str, **bounds: Any) -> msgspec.Meta:
    return msgspec.Meta(description=description, extra={"unit": unit, "source": source}, **bounds)


_SURVEY = "survey of eight building models, docs/plan.md"


class PlanConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a building model becomes an A-Graph. Lengths in metres, angles in radians."""

    face_tilt: Annotated[
        float,
        _meta("A face this far from vertical still bounds a room", "rad", _SURVEY, ge=0, le=1),
    ] = 0.09
    coplanar_angle: Annotated[
        float, _meta("Facets that differ less are one face", "rad", _SURVEY, ge=0, le=0.5)
    ] = 0.0175
    coplanar_offset: Annotated[
        float, _meta("Facets whose planes differ less are one face", "m", _SURVEY, ge=0, le=1)
    ] = 0.02
    coplanar_gap: Annotated[
        float,
        _meta(
            "Coplanar stretches with a wider gap between are faces of their own", "m", _SURVEY, ge=0
        ),
    ] = 1.5
    min_face_length: Annotated[
        float, _meta("Shorter faces are slivers and left out", "m", _SURVEY, ge=0, le=10)
    ] = 0.1
    min_face_height: Annotated[
        float, _meta("Lower faces are slivers and left out", "m", _SURVEY, ge=0, le=10)
    ] = 0.6
    wall_gap: Annotated[
        float, _meta("A wall face this near a room's face is behind it", "m", _SURVEY, ge=0, le=2)
    ] = 0.3
    knee_wall: Annotated[
        float, _meta("A wall this high above the floor stands behind a face", "m", _SURVEY, ge=0)
    ] = 0.4
    virtual_share: Annotated[
        float,
        _meta("A face with less of its length backed is virtual", "1", _SURVEY, ge=0, le=1),
    ] = 0.1
    door_overlap: Annotated[
        float,
        _meta(
            "A face that carries this share of a door's width hosts it", "1", _SURVEY, gt=0, le=1
        ),
    ] = 0.5
    window_overlap: Annotated[
        float,
        _meta(
            "A face that carries this share of a window's width hosts it", "1", _SURVEY, gt=0, le=1
        ),
    ] = 0.25
    passage_sill: Annotated[
        float,
        _meta("A bare opening that ends lower can be walked through", "m", _SURVEY, ge=0, le=2),
    ] = 0.3
    passage_height: Annotated[
        float, _meta("A bare opening this high can be walked through", "m", _SURVEY, ge=0, le=10)
    ] = 1.7
    passage_width: Annotated[
        float, _meta("A bare opening this wide can be walked through", "m", _SURVEY, ge=0, le=10)
    ] = 0.5
    mount_gap: Annotated[
        float, _meta("A fixture this near a wall face hangs on it", "m", _SURVEY, ge=0, le=1)
    ] = 0.15
    min_semi_axis: Annotated[
        float,
        _meta("Smallest semi-axis of an ellipsoid", "m", "as in the objects stage", ge=0, le=1),
    ] = 0.05
    storey_tolerance: Annotated[
        float,
        _meta(
            "A declared storey elevation this far from its floors is odd", "m", _SURVEY, ge=0, le=5
        ),
    ] = 0.3
    storey_split: Annotated[
        float, _meta("Floors this far apart are different storeys", "m", _SURVEY, gt=0, le=10)
    ] = 1.8
    far: Annotated[
        float,
        _meta("Coordinates beyond this are shifted to the origin", "m", _SURVEY, gt=0, le=1e6),
    ] = 1000.0
    ignore_spaces: Annotated[
        bool, _meta("Derive rooms from walls even where the model has spaces", "", "user's choice")
    ] = False
    cut_height: Annotated[
        float,
        _meta(
            "Rooms are derived from walls cut this high above a storey", "m", _SURVEY, gt=0, le=5
        ),
    ] = 1.2
    close_gap: Annotated[
        float,
        _meta("Walls this near each other touch when rooms are derived", "m", _SURVEY, ge=0, le=1),
    ] = 0.1
    min_room_area: Annotated[
        float,
        _meta("Smaller enclosures are shafts, not derived rooms", "m2", _SURVEY, ge=0, le=100),
    ] = 1.5
    min_room_width: Annotated[
        float, _meta("Narrower enclosures are shafts, not derived rooms", "m", _SURVEY, ge=0, le=10)
    ] = 0.6
    passage_gap: Annotated[
        float,
        _meta(
            "A passage of an indoor map lies this near the faces it joins", "m", "SIST map", ge=0
        ),
    ] = 0.6
    door_height: Annotated[
        float,
        _meta("Height of a door where an indoor map gives none", "m", "usual door", gt=0, le=10),
    ] = 2.0
    max_osm_mb: Annotated[
        int, _meta("Larger indoor maps are refused", "MB", "bounded input", ge=1, le=4_000)
    ] = 64
    max_file_mb: Annotated[
        int, _meta("Larger building models are refused", "MB", "bounded input", ge=1, le=16_000)
    ] = 1024
    max_memory_mb: Annotated[
        int,
        _meta(
            "Address space the reader of a building model may take", "MB", "bounded input", ge=64
        ),
    ] = 8192
    max_seconds: Annotated[
        float, _meta("Longest time the reader may take", "s", "bounded input", gt=0, le=86_400)
    ] = 600.0
    isolate: Annotated[
        bool,
        _meta(
            "Parse building models in a child process, so that a crash stays there",
            "",
            "robustness",
        ),
    ] = True
