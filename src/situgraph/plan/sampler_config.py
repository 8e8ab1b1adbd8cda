"""How a synthetic robot sees a building: noise and errors of sampled S-Graphs."""

from __future__ import annotations

import math
from typing import Annotated

import msgspec

Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class DetectionRates(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How often the detector errs on one category.

    ``missed``: share of the objects in view that are not found. ``false``: false objects for one
    real object in view. The other three are shares of the objects found: seen twice, under
    another category's name, related to another wall of the room than their own.
    """

    missed: Share = 0.0
    false: Annotated[float, msgspec.Meta(ge=0.0)] = 0.0
    duplicated: Share = 0.0
    confused: Share = 0.0
    wrong_wall: Share = 0.0


class SamplerConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Noise and errors; the default is a perfect view in an unknown frame."""

    translation_range: Annotated[
        float,
        msgspec.Meta(ge=0, description="Map origin within this of the start.", extra={"unit": "m"}),
    ] = 20.0
    height_range: Annotated[
        float,
        msgspec.Meta(ge=0, description="Map origin above or below the floor.", extra={"unit": "m"}),
    ] = 0.5
    plane_offset_sigma: Annotated[
        float, msgspec.Meta(ge=0, description="Noise of plane offsets.", extra={"unit": "m"})
    ] = 0.0
    plane_yaw_sigma: Annotated[
        float,
        msgspec.Meta(ge=0, description="Noise of wall directions.", extra={"unit": "rad"}),
    ] = 0.0
    plane_tilt_sigma: Annotated[
        float, msgspec.Meta(ge=0, description="Noise of wall tilts.", extra={"unit": "rad"})
    ] = 0.0
    extent_sigma: Annotated[
        float,
        msgspec.Meta(ge=0, description="Noise of wall ends along the wall.", extra={"unit": "m"}),
    ] = 0.0
    center_sigma: Annotated[
        float,
        msgspec.Meta(ge=0, description="Noise of room centres, each axis.", extra={"unit": "m"}),
    ] = 0.0
    object_sigma: Annotated[
        float,
        msgspec.Meta(ge=0, description="Noise of object centres, each axis.", extra={"unit": "m"}),
    ] = 0.0
    footprints: Annotated[
        bool,
        msgspec.Meta(description="Rooms come with a (noisy) footprint where the plan has one."),
    ] = True
    missing_planes: Annotated[
        Share, msgspec.Meta(description="Share of planes not seen; two that are not parallel stay.")
    ] = 0.0
    false_rooms: Annotated[
        float, msgspec.Meta(ge=0, description="Rooms that do not exist, for one that does.")
    ] = 0.0
    moved_walls: Annotated[
        Share, msgspec.Meta(description="Share of walls built elsewhere than planned.")
    ] = 0.0
    moved_min: Annotated[
        float, msgspec.Meta(ge=0, description="Least offset of a moved wall.", extra={"unit": "m"})
    ] = 0.1
    moved_max: Annotated[
        float,
        msgspec.Meta(
            ge=0,
            description="Largest offset of a moved wall.",
            extra={"unit": "m", "source": "DESIGN section 1"},
        ),
    ] = 0.4
    drift: Annotated[
        float,
        msgspec.Meta(
            ge=0,
            description="Heading error for one metre walked, either way; it bends the map.",
            extra={"unit": "rad/m"},
        ),
    ] = 0.0
    detection: Annotated[
        dict[str, DetectionRates], msgspec.Meta(description="Rates by category.")
    ] = {}
    detection_default: Annotated[
        DetectionRates, msgspec.Meta(description="Rates of the categories not named.")
    ] = DetectionRates()


CLEAN = SamplerConfig()

# Issue 3, item 5 and 'Geometry against real deviation': the errors a matcher has to stand.
REALISTIC = SamplerConfig(
    plane_offset_sigma=0.03,
    plane_yaw_sigma=math.radians(0.3),
    plane_tilt_sigma=math.radians(0.3),
    extent_sigma=0.1,
    center_sigma=0.05,
    object_sigma=0.1,
    missing_planes=0.1,
    false_rooms=0.1,
    moved_walls=0.05,
    drift=math.radians(2.0) / 50.0,
)

# Table II of the paper: recall .92 and .94, precision 1.00 and .96.
PAPER_DETECTOR = {
    "door": DetectionRates(missed=0.08),
    "window": DetectionRates(missed=0.06, false=0.94 * (1.0 / 0.96 - 1.0)),
}
