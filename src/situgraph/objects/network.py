"""The shipped detector: a small network that labels pixels, trained on simulated frames only.

It is made for the simulator's pictures and does not transfer to photographs; its data and limits
are in ``docs/model-card.md``. Its results are always reported under the name ``network``.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray
from scipy import ndimage

from situgraph.errors import InputError
from situgraph.objects.detections import Detection
from situgraph.objects.panoptic import open_session

MODEL, CARD = "rooms.onnx", "rooms.json"
MAX_CARD_BYTES = 1 << 20
Chance = Annotated[float, Meta(ge=0, le=1)]


class ModelCard(msgspec.Struct, frozen=True):
    """What ``rooms.json`` says: category of each channel, the chance from which it is taken.

    The first channel is the background. A category without a threshold is one that validation
    showed it cannot tell: its pixels are nobody's. ``frames`` and ``report`` say what it was
    trained on and how well it did; they are not needed to run it.
    """

    names: tuple[str, ...]
    thresholds: dict[str, Chance]
    frames: dict[str, Any] = {}
    report: dict[str, Any] = {}


class NetworkConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How the network's chances become instances."""

    min_area: Annotated[
        int, Meta(ge=1, description="smallest instance", extra={"unit": "px of its output"})
    ] = 12


class NetworkDetector:
    """Doors, windows and a few fixed things in simulated pictures; instances are what touches."""

    def __init__(self, folder: Path | None = None, config: NetworkConfig | None = None) -> None:
        """Read what the model knows; the network itself is loaded at the first picture.

        Args:
            folder: holds ``rooms.onnx`` and ``rooms.json``; none: those that situgraph ships.
            config: how instances are made.

        Raises:
            InputError: a file is absent or no such model.
        """
        self.name = "network"
        self.config = config or NetworkConfig()
        self._model, self.card = _files(folder)
        self._session: Any = None
        never = 2.0  # no chance is as large
        self._least = np.array(
            [never, *(self.card.thresholds.get(name, never) for name in self.card.names[1:])],
            np.float32,
        )

    @property
    def categories(self) -> frozenset[str]:
        """The categories it can tell."""
        return frozenset(self.card.thresholds)

    def detect(self, rgb: NDArray[np.uint8], stamp: float = 0.0) -> Sequence[Detection]:
        """The instances in an image (h, w, 3) uint8; ``stamp`` is not used."""
        chance = self.chances(rgb)
        label = np.argmax(chance[1:], axis=0) + 1
        best = np.take_along_axis(chance, label[None], axis=0)[0]
        label[best <= self._least[label]] = 0
        found = []
        for k in np.unique(label[label > 0]).tolist():
            parts, count = ndimage.label(label == k)
            sizes = np.bincount(parts.ravel(), minlength=count + 1)
            for n in range(1, count + 1):
                if sizes[n] < self.config.min_area:
                    continue
                mask = parts == n
                score = float(best[mask].mean())
                found.append(Detection(_enlarged(mask, rgb.shape[:2]), self.card.names[k], score))
        return found

    def chances(self, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        """The chance of each channel (classes, h', w') at the network's own resolution."""
        from PIL import Image

        if self._session is None:
            self._session = open_session(self._model)
        given = self._session.get_inputs()[0]
        size = (given.shape[3], given.shape[2])
        image = Image.fromarray(rgb)
        if image.size != size:
            image = image.resize(size, Image.Resampling.BOX)
        pixels = np.asarray(image, np.float32).transpose(2, 0, 1)[None] / np.float32(255)
        (chance,) = self._session.run(None, {given.name: np.ascontiguousarray(pixels)})
        out: NDArray[np.float32] = np.asarray(chance)[0]
        return out


def _files(folder: Path | None) -> tuple[bytes, ModelCard]:
    """The model's bytes and its card."""
    place: Any = folder if folder is not None else resources.files("situgraph.objects") / "model"
    model, card = place / MODEL, place / CARD
    for file in (model, card):
        if not file.is_file():
            remedy = "install situgraph anew, or train it (docs/model-card.md)"
            raise InputError(file.name, "the detector's model file is not there", remedy)
    try:
        text = card.read_bytes()[: MAX_CARD_BYTES + 1]
        known = msgspec.json.decode(text, type=ModelCard)
        unknown = sorted(set(known.thresholds) - set(known.names[1:]))
        if len(known.names) < 2 or unknown:
            raise msgspec.ValidationError(f"no channels for {unknown}")
    except (msgspec.DecodeError, msgspec.ValidationError) as error:
        raise InputError(card.name, f"is no model card ({error})", "train it anew") from None
    return model.read_bytes(), known


def _enlarged(mask: NDArray[np.bool_], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """A mask brought to the image's size: each pixel takes the nearest."""
    rows = np.arange(shape[0]) * mask.shape[0] // shape[0]
    columns = np.arange(shape[1]) * mask.shape[1] // shape[1]
    out: NDArray[np.bool_] = mask[rows[:, None], columns[None]]
    return out
