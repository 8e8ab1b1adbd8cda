"""The detector that a name stands for: the shipped network, the simulator's truth, an ONNX file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from situgraph.errors import InputError

if TYPE_CHECKING:
    from situgraph.io.recording import RecordingInfo
    from situgraph.objects.detections import Detector
    from situgraph.objects.oracle import OracleDetector
    from situgraph.sim.truth import Truth

CHOICES = "network, oracle, none, or an ONNX file"


def make_detector(name: str, log: str | Path, *, seed: int = 0) -> Detector | None:
    """The detector called ``name``; None for ``none``.

    ``network`` is the shipped one, ``oracle`` looks at the truth that lies beside a simulated
    ``log`` and errs as its noise model says; anything else is the path of an ONNX export.

    Raises:
        InputError: the model or the truth is not there.
    """
    if name == "none":
        return None
    if name == "network":
        from situgraph.objects.network import NetworkDetector

        return NetworkDetector()
    if name == "oracle":
        from situgraph.sim.truth import read_truth

        return oracle(read_truth(log), seed)
    if Path(name).suffix.lower() != ".onnx":
        raise InputError(f"--detector {name}", "no such detector", f"choose {CHOICES}")
    from situgraph.objects.panoptic import OnnxPanopticDetector

    return OnnxPanopticDetector(name)


def default_detector(info: RecordingInfo) -> str:
    """``network`` where the log has images and the shipped model is there, else ``none``."""
    from importlib import resources

    images = info.counts.get("frames", 0) != 0 and info.base_T_camera is not None
    model = resources.files("situgraph.objects") / "model" / "rooms.onnx"
    return "network" if images and model.is_file() else "none"


def oracle(truth: Truth, seed: int = 0) -> OracleDetector:
    """The oracle for a simulated drive: all parts of a thing (leaf, frame, pane) are one instance.

    Walls, floors and pictures, which are nobody's objects, are left to nothing.
    """
    from situgraph.objects.oracle import OracleDetector

    names = sorted({p.object for p in truth.parts if p.object is not None})
    number = {name: k for k, name in enumerate(names, start=1)}
    table = np.array([number.get(p.object or "", 0) for p in truth.parts], dtype=np.int64)
    categories = {number[p.object]: p.category for p in truth.parts if p.object is not None}

    def look(stamp: float) -> tuple[Any, None]:
        ids = truth.id_image(stamp)
        return (np.zeros((1, 1), np.int64) if ids is None else table[ids]), None

    return OracleDetector(look, categories, seed=seed)
