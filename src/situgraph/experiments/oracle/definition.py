"""The constants of ``docs/matching.md`` once more: nothing of the matcher is trusted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

import msgspec

Policy = Literal["none", "containment", "likelihood"]


class Terms(NamedTuple):
    """What a plane's log ratio (section 4) is made of: constants, and spreads ``2 sigma^2``."""

    fit: float
    moved: float
    missing: float
    offset_spread: float
    angle_spread: float


class Definition(msgspec.Struct, frozen=True, kw_only=True):
    """Constants of the definition; lengths in metres, angles in radians."""

    usable_tilt: float = math.radians(20)
    angle_tolerance: float = math.radians(5)
    fit_limit: float = 0.15
    moved_limit: float = 0.4
    parallel_sine: float = 0.3
    storey_tolerance: float = 0.8
    clutter_length: float = 10.0
    plane_sigma: float = 0.06
    map_bend: float = math.radians(2) / 50
    angle_sigma: float = math.radians(2)
    p_moved: float = 0.03
    p_together: float = 0.9
    wall_thickness: float = 0.5
    wall_sine: float = 0.01
    p_missing: float = 0.03
    p_missing_shared: float = 0.1
    p_false_room: float = 0.1
    p_other_room: float = 0.05
    outside_prior: float = 0.01
    p_tied: float = 0.07
    mirror_prior: float = 0.001
    shape_walls: float = 4.0
    least_reach: float = 2.0
    plan_margin: float = 5.0
    min_share: float = 0.7
    all_rooms_up_to: int = 3
    same_distance: float = 0.3
    same_yaw: float = math.radians(10)
    same_height: float = 0.8
    rival_ratio: float = 0.01
    unique_probability: float = 0.99
    clutter_area: float = 20.0
    object_sigma: float = 0.25
    object_tail_share: float = 0.1
    object_tail_radius: float = 1.0
    least_share: float = 0.01
    miss: float = 0.08
    false: float = 0.04
    duplicate: float = 0.03
    confusion: float = 0.02
    wrong_wall: float = 0.05
    wrong_join: float = 0.05
    half_seen: float = 0.1
    object_shared: float = 0.2
    seen_whole: float = 0.7
    seen_shares: tuple[float, ...] = (0.0, 0.5)
    miss_by_category: Mapping[str, float] = {}
    false_by_category: Mapping[str, float] = {}
    duplicate_by_category: Mapping[str, float] = {}

    def least_rooms(self, rooms: int) -> int:
        """K: how many of so many online rooms a placement must explain."""
        if rooms <= self.all_rooms_up_to:
            return rooms
        return math.ceil(self.min_share * rooms - 1e-9)

    def terms(self, sigma: float) -> Terms:
        """The constants of the log ratio of planes that fit, are moved, are missing."""
        fitting = 1 - self.p_moved - self.p_missing
        peak = fitting * self.clutter_length / (math.sqrt(2 * math.pi) * sigma)
        return Terms(
            fit=math.log(peak),
            moved=math.log(self.p_moved * self.clutter_length / (2 * self.moved_limit)),
            missing=math.log(self.p_missing),
            offset_spread=2 * sigma**2,
            angle_spread=2 * self.angle_sigma**2,
        )

    def miss_of(self, category: str) -> float:
        """The probability that an object of the category is not detected."""
        return self.miss_by_category.get(category, self.miss)

    def false_of(self, category: str) -> float:
        """The probability that a detection of the category is false."""
        return self.false_by_category.get(category, self.false)

    def duplicate_of(self, category: str) -> float:
        """The probability that an object of the category is detected twice."""
        return self.duplicate_by_category.get(category, self.duplicate)
