"""Detections from exported panoptic networks with the output contract of YOSO and Mask2Former.

The network takes ``(1, 3, h, w)`` float32 and gives ``cls_scores`` (1, q, classes + 1), the last
one for "no object", and ``mask_preds`` (1, q, h', w') as logits: q mask proposals with a class
each. The panoptic fusion follows MaskFormer (Cheng et al., 2021): every pixel goes to the proposal
with the largest class score times mask value; a proposal that keeps too little of its mask is
dropped.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.objects.classmap import ClassMap, class_map
from situgraph.objects.detections import Detection

MAX_MODEL_BYTES = 2 << 30
OUTPUTS = ("cls_scores", "mask_preds")


class PanopticConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How images are prepared and proposals are fused; defaults of YOSO's ADE20K export."""

    short_side: Annotated[
        int, Meta(gt=0, description="image's short side", extra={"unit": "px"})
    ] = 640
    mean: tuple[float, float, float] = (123.675, 116.28, 103.53)
    std: tuple[float, float, float] = (58.395, 57.12, 57.375)
    min_score: Annotated[float, Meta(ge=0, le=1, description="least class score")] = 0.2
    min_kept: Annotated[float, Meta(ge=0, le=1, description="least share of its mask kept")] = 0.8


class OnnxPanopticDetector:
    """Runs an ONNX export; the class map says what its channels are."""

    def __init__(
        self,
        model: str | Path,
        classes: str | Path | ClassMap = "ade20k",
        config: PanopticConfig | None = None,
    ) -> None:
        """Load a model.

        Raises:
            InputError: no such file, not an ONNX model, or not the output contract.
        """
        self.name = "onnx"
        self.config = config or PanopticConfig()
        self.classes = classes if isinstance(classes, ClassMap) else class_map(classes)
        self._session = open_session(model)
        self._input = self._session.get_inputs()[0].name
        names = [o.name for o in self._session.get_outputs()]
        if not set(OUTPUTS) <= set(names):
            problem = f"has the outputs {', '.join(names)}, expected {' and '.join(OUTPUTS)}"
            raise InputError(model, problem, "see docs/objects.md on exporting")
        self._model = str(model)

    @property
    def categories(self) -> frozenset[str]:
        """The categories of the class map."""
        return self.classes.categories

    def detect(self, rgb: NDArray[np.uint8], stamp: float = 0.0) -> Sequence[Detection]:
        """The instances in an image (h, w, 3) uint8; ``stamp`` is not used."""
        image = self._prepared(rgb)
        scores, masks = self._session.run(list(OUTPUTS), {self._input: image})
        scores, masks = np.asarray(scores)[0], np.asarray(masks)[0]
        if scores.ndim != 2 or scores.shape[1] != self.classes.classes + 1 or masks.ndim != 3:
            problem = (
                f"cls_scores {scores.shape} and mask_preds {masks.shape} do not fit "
                f"a map of {self.classes.classes} classes"
            )
            raise InputError(
                self._model, problem, "name the class map the network was trained with"
            )
        return fuse(scores, masks, rgb.shape[:2], self.classes, self.config)

    def _prepared(self, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        from PIL import Image

        h, w = rgb.shape[:2]
        scale = self.config.short_side / min(h, w)
        size = (round(w * scale), round(h * scale))
        shape = self._session.get_inputs()[0].shape
        if len(shape) == 4 and all(isinstance(v, int) for v in shape[2:]):
            size = (shape[3], shape[2])
        resized = Image.fromarray(rgb).resize(size, Image.Resampling.BILINEAR)
        mean, std = np.array(self.config.mean), np.array(self.config.std)
        pixels = ((np.asarray(resized, np.float64) - mean) / std).astype(np.float32)
        return np.ascontiguousarray(pixels.transpose(2, 0, 1)[None])


def open_session(model: str | Path | bytes) -> Any:
    """An onnxruntime session on one CPU thread.

    Raises:
        InputError: no such file, too large, or not a model that onnxruntime can run.
    """
    import onnxruntime as ort

    if not isinstance(model, bytes):
        path = Path(model)
        if not path.is_file():
            raise InputError(path, "no such model file", "name an .onnx file")
        if path.stat().st_size > MAX_MODEL_BYTES:
            raise InputError(path, "is larger than 2 GB", "export a smaller model")
    options = ort.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        source = model if isinstance(model, bytes) else str(model)
        return ort.InferenceSession(source, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's own exceptions share no base of their own
        name = "model" if isinstance(model, bytes) else model
        problem = " ".join(str(error).split())[:160]
        raise InputError(name, f"is no ONNX model that can be run ({problem})") from None


def fuse(
    scores: NDArray[np.float32],
    masks: NDArray[np.float32],
    shape: tuple[int, int],
    classes: ClassMap,
    config: PanopticConfig,
) -> list[Detection]:
    """Panoptic fusion of proposals: class logits (q, classes + 1), mask logits (q, h', w')."""
    shifted = np.exp(scores - scores.max(axis=1, keepdims=True))
    chance = (shifted / shifted.sum(axis=1, keepdims=True))[:, :-1]
    channel, score = chance.argmax(axis=1), chance.max(axis=1)
    keep = np.flatnonzero(score > config.min_score)
    if len(keep) == 0:
        return []
    value = 1.0 / (1.0 + np.exp(-_resized(masks[keep], shape)))
    owner = (score[keep, None, None] * value).argmax(axis=0)
    parts: dict[tuple[int, int], tuple[NDArray[np.bool_], float]] = {}
    for k, q in enumerate(keep):
        whole = value[k] >= 0.5
        own = (owner == k) & whole
        area = int(whole.sum())
        if area == 0 or own.sum() < config.min_kept * area:
            continue
        c = int(channel[q])
        key = (c, -1 if c in classes.stuff else int(q))
        before = parts.get(key)
        if before is None:
            parts[key] = (own, float(score[q]))
        else:
            parts[key] = (before[0] | own, max(before[1], float(score[q])))
    found = []
    for (c, _), (mask, best) in parts.items():
        category = classes.category(c)
        if category is not None:
            found.append(Detection(mask, category, best))
    return found


def _resized(masks: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Mask logits brought to the image's size, bilinear."""
    from PIL import Image

    if masks.shape[1:] == shape:
        return masks
    size = (shape[1], shape[0])
    return np.stack(
        [np.asarray(Image.fromarray(m).resize(size, Image.Resampling.BILINEAR)) for m in masks]
    )
