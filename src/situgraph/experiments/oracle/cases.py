"""Random small cases for the comparison of the matcher with the brute force.

A case is drawn from its number alone: kind of layout, sizes, errors, policy, frames.
"""

from __future__ import annotations

import math
import typing
from typing import Any

import msgspec
import numpy as np

from situgraph.experiments.oracle.definition import Policy
from situgraph.plan.layout_config import Kind, Symmetry
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC, DetectionRates, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph

MOST_SEEN, MOST_PLANNED = 6, 12

# Errors of every kind at once; the last is far beyond what the definition forgives.
ERRORS: dict[str, SamplerConfig] = {
    "clean": SamplerConfig(),
    "noisy": SamplerConfig(
        plane_offset_sigma=0.03,
        plane_yaw_sigma=math.radians(0.5),
        plane_tilt_sigma=math.radians(0.5),
        center_sigma=0.05,
        object_sigma=0.1,
        detection_default=DetectionRates(missed=0.08, false=0.04, duplicated=0.03),
    ),
    "realistic": msgspec.structs.replace(
        REALISTIC,
        detection_default=DetectionRates(
            missed=0.08, false=0.04, duplicated=0.03, confused=0.02, wrong_wall=0.05
        ),
    ),
    "rough": SamplerConfig(
        plane_offset_sigma=0.06,
        plane_yaw_sigma=math.radians(1.5),
        plane_tilt_sigma=math.radians(2.0),
        center_sigma=0.2,
        object_sigma=0.3,
        missing_planes=0.15,
        false_rooms=0.2,
        moved_walls=0.25,
        drift=math.radians(4.0) / 50.0,
        detection_default=DetectionRates(
            missed=0.2, false=0.2, duplicated=0.1, confused=0.05, wrong_wall=0.1
        ),
    ),
}


class Case(msgspec.Struct, frozen=True):
    """Everything that makes a case, so that it can be made again."""

    number: int
    kind: Kind
    symmetry: Symmetry
    errors: str
    policy: Policy
    planned: int
    seen: int
    density: float | None

    def graphs(self) -> tuple[SceneGraph, OnlineSample]:
        """The prior graph, and the online graph with its truth."""
        prior = make_layout(self.kind, self.planned, self.number, self.symmetry, self.density)
        return prior, sample_online(prior, self.seen, self.number, ERRORS[self.errors])


def draw(number: int, **fixed: Any) -> Case:
    """The case of that number; ``fixed`` fields are not drawn."""
    rng = np.random.default_rng([number, 20])
    planned = int(rng.integers(2, MOST_PLANNED + 1))
    kind: Kind = rng.choice(typing.get_args(Kind))
    symmetry: Symmetry = rng.choice(["none", "none", "none", "local", "global"])
    drawn: dict[str, Any] = {
        "kind": str(kind),
        "symmetry": str(symmetry),
        "errors": str(rng.choice(list(ERRORS))),
        "policy": str(rng.choice(typing.get_args(Policy))),
        "planned": planned,
        "seen": int(rng.integers(1, min(MOST_SEEN, planned) + 1)),
        "density": None if rng.random() < 0.5 else float(rng.uniform(0.0, 0.4)),
    }
    return Case(number, **{**drawn, **fixed})
