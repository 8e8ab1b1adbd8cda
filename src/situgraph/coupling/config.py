"""Settings of the coupling stage."""

from __future__ import annotations

import math
from typing import Annotated, Any

import msgspec


def _meta(description: str, unit: str, source: str, **bounds: Any) -> msgspec.Meta:
    return msgspec.Meta(description=description, extra={"unit": unit, "source": source}, **bounds)


_FACTS = "FACTS.md, gtsam"
_DESIGN = "DESIGN section 1"
_CHOICE = "docs/coupling.md"


class CouplingConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the coupling stage."""

    # The factor graph
    built_offset: Annotated[
        float,
        _meta("Scale of the Cauchy kernel: walls are built this near", "m", _FACTS, gt=0, le=0.2),
    ] = 0.01
    built_angle: Annotated[
        float, _meta("Scale of the same kernel for their direction", "rad", _FACTS, gt=0, le=0.1)
    ] = 0.003
    wall_sigma: Annotated[
        float,
        _meta("How exactly a face lies in its frame", "m and rad", _CHOICE, gt=0, le=0.1),
    ] = 0.001
    level_sigma: Annotated[
        float, _meta("Roll and pitch of the building in the map", "rad", _FACTS, gt=0, le=0.5)
    ] = 0.003
    height_sigma: Annotated[
        float, _meta("Height of the building in the map", "m", _FACTS, gt=0, le=10)
    ] = 0.05
    plane_sigma: Annotated[
        float,
        _meta("Offset of an online plane that does not tell its own", "m", _CHOICE, gt=0, le=1),
    ] = 0.03
    plane_angle_sigma: Annotated[
        float,
        _meta("Angle of an online plane that does not tell its own", "rad", _CHOICE, gt=0, le=0.5),
    ] = 0.01
    max_iterations: Annotated[
        int, _meta("Steps of Levenberg-Marquardt at most", "1", _CHOICE, ge=1, le=1000)
    ] = 50

    # Association of what was seen later
    same_angle: Annotated[
        float, _meta("Faces that differ less may be one", "rad", _DESIGN, gt=0, le=0.3)
    ] = math.radians(5)
    same_offset: Annotated[
        float, _meta("Faces farther apart are never one", "m", _DESIGN, gt=0, le=2)
    ] = 0.4
    same_surface: Annotated[
        float, _meta("A second plane on one face lies this near it", "m", _CHOICE, gt=0, le=1)
    ] = 0.06
    least_overlap: Annotated[
        float, _meta("Common stretch of two faces that are one", "m", _CHOICE, gt=0, le=5)
    ] = 0.3
    room_overlap: Annotated[
        float, _meta("Share of an online room inside a planned one", "1", _CHOICE, gt=0, le=1)
    ] = 0.6

    # Deviations
    told_offset: Annotated[
        float, _meta("Smaller offsets of walls are not told", "m", "issue 6", ge=0, le=1)
    ] = 0.03
    told_sigmas: Annotated[
        float, _meta("Nor offsets below so many standard deviations", "1", _DESIGN, ge=0, le=10)
    ] = 3.0
    told_length: Annotated[
        float, _meta("Faces shorter than this are not missed and not extra", "m", _CHOICE, ge=0)
    ] = 1.0
    seen_beyond: Annotated[
        float, _meta("A face is missing where the room goes on this far", "m", _CHOICE, gt=0, le=5)
    ] = 0.5
    told_extra: Annotated[
        float, _meta("A face this far from all planned ones is extra", "m", _CHOICE, gt=0, le=5)
    ] = 0.4
    least_sightings: Annotated[
        int, _meta("Keyframes that saw a face or object before it is extra", "1", _CHOICE, ge=1)
    ] = 3
    same_object: Annotated[
        float,
        _meta("Objects of a category on one wall this near are one", "m", _CHOICE, gt=0, le=5),
    ] = 0.8
    moved_object: Annotated[
        float, _meta("An object farther from its planned place was moved", "m", _CHOICE, gt=0, le=5)
    ] = 0.4

    # The state: located or not
    keep_probability: Annotated[
        float,
        _meta("A match whose probability falls below this is withdrawn", "1", _CHOICE, gt=0, lt=1),
    ] = 0.5
