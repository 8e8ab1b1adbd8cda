"""Settings of the matching stage: the constants of ``docs/matching.md``.

Lengths in metres, angles in radians. One set of values serves every input.
"""

from __future__ import annotations

import math
from typing import Annotated

import msgspec

from situgraph.setting import setting

_DESIGN = "DESIGN section 1"
_MODEL = "docs/matching.md section 4"
_PARTS = "docs/matching.md, section 12"
_OBJECTS = "docs/matching.md section 6"
_DETECTOR = "paper, Table II, with a margin"

_Share = Annotated[float, msgspec.Meta(ge=0, le=1)]


class ObjectRates(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How the detector errs on one category; categories without an entry use the defaults."""

    miss: Annotated[
        float, setting("An object in view is not detected", "1", _DETECTOR, gt=0, lt=1)
    ] = 0.08
    false: Annotated[float, setting("A detection is of nothing", "1", _DETECTOR, gt=0, lt=1)] = 0.04
    duplicate: Annotated[
        float, setting("An object is detected twice", "1", "issue 3", gt=0, lt=1)
    ] = 0.03
    confusion: Annotated[
        float,
        setting("A detection has another category than its object", "1", _DETECTOR, gt=0, lt=1),
    ] = 0.02
    wrong_wall: Annotated[
        float, setting("A detection is tied to a wrong wall", "1", _MODEL, gt=0, lt=1)
    ] = 0.05
    wrong_join: Annotated[
        float,
        setting(
            "A detection is tied to a room that its object is not in", "1", _OBJECTS, gt=0, lt=1
        ),
    ] = 0.05
    half_seen: Annotated[
        float,
        setting("A door between two rooms is tied to one of them only", "1", _OBJECTS, gt=0, lt=1),
    ] = 0.1


class MatchingConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the matching stage."""

    plane_offset_tolerance: Annotated[
        float, setting("A wall this near its planned place fits", "m", _DESIGN, gt=0, le=1)
    ] = 0.15
    moved_limit: Annotated[
        float,
        setting("A wall this near its planned place may have been moved", "m", _DESIGN, gt=0, le=2),
    ] = 0.4
    angle_tolerance: Annotated[
        float,
        setting("Walls that differ less have the same direction", "rad", _DESIGN, gt=0, le=0.3),
    ] = math.radians(5)
    parallel_sine: Annotated[
        float,
        setting("Planes are parallel below this sine of their angle", "1", _MODEL, gt=0.2, le=0.9),
    ] = 0.3
    usable_tilt: Annotated[
        float, setting("Planes that lean more bound no room", "rad", _MODEL, ge=0, le=1)
    ] = math.radians(20)
    storey_tolerance: Annotated[
        float, setting("Storeys this near in height are one", "m", _DESIGN, gt=0, le=2)
    ] = 0.8
    min_share: Annotated[
        float, setting("Share of the online rooms a candidate explains", "1", _DESIGN, gt=0, le=1)
    ] = 0.7
    all_rooms_up_to: Annotated[
        int, setting("With so few online rooms a candidate explains all", "1", _DESIGN, ge=0)
    ] = 3
    same_distance: Annotated[
        float,
        setting("Placements this near at the mean room centre are the same", "m", _DESIGN, gt=0),
    ] = 0.3
    same_yaw: Annotated[
        float, setting("Placements this near in yaw are the same", "rad", _DESIGN, gt=0)
    ] = math.radians(10)
    same_height: Annotated[
        float, setting("Placements this near in height are the same", "m", _DESIGN, gt=0)
    ] = 0.8
    plane_sigma: Annotated[
        float, setting("Standard deviation of the offset of a wall that fits", "m", _MODEL, gt=0)
    ] = 0.06
    map_bend: Annotated[
        float,
        setting("The map's heading errs by so much more with each metre", "rad/m", _MODEL, ge=0),
    ] = math.radians(2) / 50
    part_rooms: Annotated[
        int,
        setting(
            "A bent map is cut into parts of so many rooms at least; 0: never", "1", _PARTS, ge=0
        ),
    ] = 4
    part_gap: Annotated[
        float,
        setting("Standard deviation of placements of parts side by side", "m", _PARTS, gt=0),
    ] = 1.5
    part_yaw: Annotated[
        float,
        setting(
            "Parts side by side are turned against each other by so much at most",
            "rad",
            _PARTS,
            gt=0,
            le=0.5,
        ),
    ] = math.radians(15)
    p_bent_part: Annotated[
        float,
        setting("A part of a bent map is too bent for one placement", "1", _PARTS, gt=0, lt=1),
    ] = 0.2
    angle_sigma: Annotated[
        float, setting("Standard deviation of a wall's direction", "rad", _MODEL, gt=0)
    ] = math.radians(2)
    clutter_length: Annotated[
        float, setting("A plane that is in no plan lies anywhere in this length", "m", _MODEL, gt=0)
    ] = 10.0
    p_moved: Annotated[float, setting("A wall was moved", "1", _MODEL, gt=0, lt=0.5)] = 0.03
    p_together: Annotated[
        float, setting("A face moved because its wall did", "1", _MODEL, gt=0, lt=1)
    ] = 0.9
    wall_thickness: Annotated[
        float, setting("Faces on lines this near may be of one wall", "m", _MODEL, ge=0, le=2)
    ] = 0.5
    p_missing: Annotated[
        float, setting("A seen wall is not planned", "1", _MODEL, gt=0, lt=0.5)
    ] = 0.03
    p_missing_shared: Annotated[
        float, setting("A plane is tied to a room too many", "1", _MODEL, gt=0, lt=1)
    ] = 0.1
    p_false_room: Annotated[
        float, setting("A seen room is none of the plan's", "1", _MODEL, gt=0, lt=1)
    ] = 0.1
    p_other_room: Annotated[
        float,
        setting("A seen room that is none of the plan's is like them", "1", _MODEL, ge=0, le=1),
    ] = 0.05
    outside_prior: Annotated[
        float, setting("The robot is not in this plan", "1", _DESIGN, gt=0, lt=1)
    ] = 0.01
    p_tied: Annotated[
        float, setting("Rooms elsewhere stand to each other as here", "1", _MODEL, ge=0, le=1)
    ] = 0.07
    mirror_prior: Annotated[float, setting("The plan is mirrored", "1", _MODEL, ge=0, lt=1)] = 0.001
    plan_margin: Annotated[
        float, setting("The plan reaches this far beyond its room centres", "m", _MODEL, gt=0)
    ] = 5.0
    rival_ratio: Annotated[
        float,
        setting(
            "A candidate this probable beside the best is a solution", "1", _DESIGN, ge=0, le=1
        ),
    ] = 0.01
    unique_probability: Annotated[
        float, setting("A single solution this probable is unique", "1", _DESIGN, gt=0, le=1)
    ] = 0.99
    max_solutions: Annotated[
        int, setting("Solutions listed at most", "1", "DESIGN section 3", ge=1)
    ] = 10_000

    object_sigma: Annotated[
        float, setting("Standard deviation of an object's place in the plan", "m", _MODEL, gt=0)
    ] = 0.25
    object_tail_share: Annotated[
        float, setting("Objects of which only a part was seen", "1", _MODEL, ge=0, lt=1)
    ] = 0.1
    object_tail_radius: Annotated[
        float, setting("How far the centre of such a part may lie off", "m", _MODEL, gt=0)
    ] = 1.0
    object_shared: Annotated[
        float,
        setting(
            "Share of the variance of its place that an object has in common with its wall",
            "1",
            _OBJECTS,
            ge=0,
            lt=1,
        ),
    ] = 0.2
    clutter_area: Annotated[
        float,
        setting("An object that is in no plan lies anywhere in this area", "m2", _MODEL, gt=0),
    ] = 20.0
    least_share: Annotated[
        float, setting("No category is rarer among the prior's objects", "1", _MODEL, gt=0, le=1)
    ] = 0.01
    seen_whole: Annotated[
        float, setting("A matched room has been seen whole", "1", _MODEL, gt=0, lt=1)
    ] = 0.7
    rates: Annotated[
        ObjectRates, setting("How the detector errs on any category", "", _DETECTOR)
    ] = msgspec.field(default_factory=ObjectRates)
    category_rates: Annotated[
        dict[str, ObjectRates], setting("How the detector errs on some categories", "", _DETECTOR)
    ] = {}

    smallest_step: Annotated[
        float,
        setting(
            "Feasible sets narrower than this may be passed over", "m", "docs/matching.md", gt=0
        ),
    ] = 0.002
    peak_step: Annotated[
        float,
        setting(
            "Peaks are looked for from placements this near each other",
            "m",
            "docs/matching.md",
            gt=0,
        ),
    ] = 0.05
    max_boxes: Annotated[
        int,
        setting(
            "Boxes searched at most before the search is called incomplete",
            "1",
            "docs/matching.md",
            ge=1,
        ),
    ] = 2_000_000
    max_work: Annotated[
        int,
        setting(
            "Steps at most, each about a comparison of planes, before a search is incomplete",
            "1",
            "docs/matching.md",
            ge=1,
        ),
    ] = 2_000_000_000

    @property
    def shape_gain(self) -> float:
        """How much likelier a plane of a shape that was met before is than one anywhere."""
        return self.clutter_length / (2 * self.plane_offset_tolerance)

    def sigma_of(self, spread: float) -> float:
        """Standard deviation (m) of the offset of a wall that fits, in a map of this ``spread``.

        ``spread`` (m) is the rms distance of the room centres from their mean. A map bends the
        more the wider it is, but offsets that fit are within the tolerance. Rounded up to a
        millimetre, so that few sets of constants are met.
        """
        widest = max(self.plane_sigma, self.plane_offset_tolerance / math.sqrt(3))
        sigma = min(math.hypot(self.plane_sigma, self.map_bend * spread * spread), widest)
        return max(math.ceil(sigma * 1000 - 1e-6) / 1000, self.plane_sigma)

    def may_be_cut(self, rooms: int) -> bool:
        """Whether a map of so many rooms is placed in parts where no placement is left: three."""
        return 0 < 3 * self.part_rooms <= rooms

    def least_rooms(self, rooms: int) -> int:
        """K: how many of so many online rooms a candidate must explain."""
        if rooms <= self.all_rooms_up_to:
            return rooms
        return math.ceil(self.min_share * rooms - 1e-9)

    def rates_of(self, category: str) -> ObjectRates:
        """The error rates of a category."""
        return self.category_rates.get(category, self.rates)
