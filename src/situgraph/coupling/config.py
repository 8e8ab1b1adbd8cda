"""Settings of the coupling stage."""

from __future__ import annotations

import math
from typing import Annotated

import msgspec

from situgraph.setting import setting

_FACTS = "FACTS.md, gtsam"
_DESIGN = "DESIGN section 1"
_CHOICE = "docs/coupling.md"


class CouplingConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the coupling stage."""

    # The factor graph
    built_offset: Annotated[
        float,
        setting("Scale of the Cauchy kernel: walls are built this near", "m", _FACTS, gt=0, le=0.2),
    ] = 0.01
    built_angle: Annotated[
        float, setting("Scale of the same kernel for their direction", "rad", _FACTS, gt=0, le=0.1)
    ] = 0.003
    wall_sigma: Annotated[
        float,
        setting("How exactly a face lies in its frame", "m and rad", _CHOICE, gt=0, le=0.1),
    ] = 0.001
    plan_digit: Annotated[
        float, setting("Plans are drawn to this", "m", "millimetres", ge=0, le=0.1)
    ] = 0.001
    fit_bias: Annotated[
        float,
        setting("Error of a fitted face that does not average out", "m", _CHOICE, ge=0, le=0.1),
    ] = 0.0005
    level_sigma: Annotated[
        float, setting("Roll and pitch of the building in the map", "rad", _FACTS, gt=0, le=0.5)
    ] = 0.003
    height_sigma: Annotated[
        float, setting("Height of the building in the map", "m", _FACTS, gt=0, le=10)
    ] = 0.05
    plane_sigma: Annotated[
        float,
        setting("Offset of an online plane that does not tell its own", "m", _CHOICE, gt=0, le=1),
    ] = 0.03
    plane_angle_sigma: Annotated[
        float,
        setting(
            "Angle of an online plane that does not tell its own", "rad", _CHOICE, gt=0, le=0.5
        ),
    ] = 0.01
    max_iterations: Annotated[
        int, setting("Steps of Levenberg-Marquardt at most", "1", _CHOICE, ge=1, le=1000)
    ] = 50

    # Association of what was seen later
    same_angle: Annotated[
        float, setting("Faces that differ less may be one", "rad", _DESIGN, gt=0, le=0.3)
    ] = math.radians(5)
    same_offset: Annotated[
        float,
        setting("Faces farther apart are never one: 0.4 m and errors", "m", _DESIGN, gt=0, le=2),
    ] = 0.45
    same_surface: Annotated[
        float, setting("A second plane on one face lies this near it", "m", _CHOICE, gt=0, le=1)
    ] = 0.06
    least_overlap: Annotated[
        float, setting("Common stretch of two faces that are one", "m", _CHOICE, gt=0, le=5)
    ] = 0.3
    room_overlap: Annotated[
        float, setting("Share of an online room inside a planned one", "1", _CHOICE, gt=0, le=1)
    ] = 0.6

    # Readings: placements near the match's that explain the walls about as well
    reading_apart: Annotated[
        float, setting("Placements nearer than this are one reading", "m", _DESIGN, gt=0, le=1)
    ] = 0.15
    reading_reach: Annotated[
        float, setting("Readings are looked for this far around", "m", _CHOICE, gt=0, le=2)
    ] = 0.6
    reading_ratio: Annotated[
        float, setting("Less probable readings are ruled out", "1", _DESIGN, gt=0, lt=1)
    ] = 0.01
    reading_sigma: Annotated[
        float,
        setting("Offset of a wall built as planned", "m", "docs/matching.md", gt=0, le=0.5),
    ] = 0.06
    reading_moved: Annotated[
        float,
        setting(
            "Density of a moved wall against that of one in its place",
            "1", "docs/matching.md", gt=0, lt=0.5,
        ),
    ] = 0.006  # fmt: skip

    # Deviations
    told_offset: Annotated[
        float, setting("Smaller offsets of walls are not told", "m", "issue 6", ge=0, le=1)
    ] = 0.03
    told_sigmas: Annotated[
        float, setting("Nor offsets below so many standard deviations", "1", _DESIGN, ge=0, le=10)
    ] = 3.0
    told_length: Annotated[
        float, setting("Faces shorter than this are not missed and not extra", "m", _CHOICE, ge=0)
    ] = 1.0
    seen_beyond: Annotated[
        float,
        setting("A face is missing where the room goes on this far", "m", _CHOICE, gt=0, le=5),
    ] = 0.5
    told_extra: Annotated[
        float, setting("A face this far from all planned ones is extra", "m", _CHOICE, gt=0, le=5)
    ] = 0.4
    least_sightings: Annotated[
        int, setting("Keyframes that saw a face or object before it is extra", "1", _CHOICE, ge=1)
    ] = 3
    told_confidence: Annotated[
        float,
        setting(
            "Nor an object that was seen less surely, as extra or moved", "1", _CHOICE, ge=0, le=1
        ),
    ] = 0.8
    same_object: Annotated[
        float,
        setting("Objects of a category on one wall this near are one", "m", _CHOICE, gt=0, le=5),
    ] = 0.8
    moved_object: Annotated[
        float,
        setting("An object farther from its planned place was moved", "m", _CHOICE, gt=0, le=5),
    ] = 0.4

    # The state: located or not
    keep_probability: Annotated[
        float,
        setting(
            "A match whose probability falls below this is withdrawn", "1", _CHOICE, gt=0, lt=1
        ),
    ] = 0.5
