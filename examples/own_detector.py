"""Your own detector: anything with a name, its categories and `detect`.

This one asks the shipped network and believes it only where a patch is large; yours may ask
whatever it likes, as long as it gives masks, canonical categories and scores.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

import situgraph as sg
from situgraph.objects.detections import Detection, Detector
from situgraph.objects.network import NetworkDetector
from situgraph.plan.six_rooms import six_rooms
from situgraph.run import run_log
from situgraph.sim.simulation import Simulation


class LargeOnly:
    """Another detector's finds that cover at least a hundredth of the image."""

    name = "large only"

    def __init__(self, other: Detector) -> None:
        """Ask ``other`` first."""
        self.categories = other.categories
        self._other = other

    def detect(self, rgb: NDArray[np.uint8], stamp: float) -> Sequence[Detection]:
        """What is large in an image (h, w, 3)."""
        found = self._other.detect(rgb, stamp)
        return [d for d in found if d.mask.mean() > 0.01]


building = six_rooms(1)
log = Simulation(building, rooms=("r1",))
detector = LargeOnly(NetworkDetector())
run, pipeline = run_log(log, sg.Settings(), plan=building, detector=detector)
print(f"detector {run.detector}: {run.objects} objects after {run.duration:.0f} s")
for item in pipeline.graph.objects:
    evidence = item.attributes.get("evidence", "")
    print(f"{item.id} {item.category} on {', '.join(item.planes) or 'no wall'} ({evidence})")
print(f"{run.verdict}: {run.reason}")
