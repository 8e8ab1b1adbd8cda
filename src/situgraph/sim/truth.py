"""Ground truth of a simulated drive, kept apart from the recording: for evaluation only.

No estimator may read this. Beside a recording it is the folder ``truth``: ``truth.json``,
``graph.json`` (the world as built, building frame), ``poses.tum`` (base in the building), and
``ids/NNNNNN.png`` with ``ids.csv`` (part numbers of each image's pixels, by stamp).
"""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import SceneGraph
from situgraph.sim.deviations import Deviation
from situgraph.sim.site import Part

FOLDER = "truth"
Ids = NDArray[np.uint16]


class Visit(msgspec.Struct, frozen=True):
    """The robot's base was over ``room`` from ``start`` to ``end`` (stamps, s)."""

    room: str
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Truth:
    """What really is. Everything in the building frame, metres and seconds.

    ``graph``: the world as built; ``building_T_map``: takes the odometry frame at its start (the
    map) to the building; ``stamps`` (n,) and ``poses`` (n, 7) of base; ``visits`` in order;
    ``deviations`` from the plan; ``parts[i]``: what number i of an id image means.
    """

    graph: SceneGraph
    building_T_map: Placement  # noqa: N815
    stamps: Array
    poses: Array
    visits: tuple[Visit, ...]
    deviations: tuple[Deviation, ...]
    parts: tuple[Part, ...]
    images: Callable[[float], Ids | None]

    def id_image(self, stamp: float) -> Ids | None:
        """Part numbers (h, w) of the image with that stamp; None where there is no such image.

        A running simulation only keeps the last few.
        """
        return self.images(stamp)


class RecentImages:
    """The last few id images of a running simulation."""

    def __init__(self, count: int = 16) -> None:
        self._images: OrderedDict[float, Ids] = OrderedDict()
        self._count = count

    def keep(self, stamp: float, ids: Ids) -> None:
        """Keep one more and let go of the oldest."""
        self._images[stamp] = ids
        if len(self._images) > self._count:
            self._images.popitem(last=False)

    def __call__(self, stamp: float) -> Ids | None:
        """The image of that stamp if it is still kept."""
        return self._images.get(stamp)


class TruthWriter:
    """Writes truth into a recording's folder while the recording itself is written."""

    def __init__(self, recording: Path) -> None:
        self._folder = recording / FOLDER
        (self._folder / "ids").mkdir(parents=True)
        self._stamps: list[str] = []

    def add_ids(self, stamp: float, ids: Ids) -> None:
        """Store the id image of one more frame."""
        from PIL import Image

        Image.fromarray(ids).save(self._folder / "ids" / f"{len(self._stamps):06d}.png")
        self._stamps.append(repr(stamp))

    def finish(self, truth: Truth) -> None:
        """Store everything else."""
        from situgraph.io.tum import write_tum
        from situgraph.scenegraph.codec import write_json

        write_json(truth.graph, self._folder / "graph.json")
        write_tum(self._folder / "poses.tum", truth.stamps, truth.poses)
        (self._folder / "ids.csv").write_text("".join(f"{s}\n" for s in self._stamps))
        record = {
            "building_T_map": msgspec.structs.asdict(truth.building_T_map),
            "visits": msgspec.to_builtins(truth.visits),
            "deviations": msgspec.to_builtins(truth.deviations),
            "parts": msgspec.to_builtins(truth.parts),
        }
        (self._folder / "truth.json").write_text(json.dumps(record, indent=1))


def has_truth(recording: str | Path) -> bool:
    """Whether truth lies beside a recording (its folder or a bag in it)."""
    return (_folder(recording) / "truth.json").is_file()


def read_truth(recording: str | Path) -> Truth:
    """The ground truth that lies beside a simulated recording.

    Raises:
        InputError: there is none, or it is damaged.
    """
    from situgraph.io.tum import read_tum
    from situgraph.scenegraph.codec import read_json

    folder = _folder(recording)
    file = folder / "truth.json"
    if not file.is_file():
        raise InputError(recording, "has no ground truth beside it", "use a simulated recording")
    try:
        record: dict[str, Any] = json.loads(file.read_bytes())
        placement = msgspec.convert(record["building_T_map"], Placement)
        visits = msgspec.convert(record["visits"], tuple[Visit, ...])
        deviations = msgspec.convert(record["deviations"], tuple[Deviation, ...])
        parts = msgspec.convert(record["parts"], tuple[Part, ...])
        names = (folder / "ids.csv").read_text().split()
        index = {float(s): i for i, s in enumerate(names)}
    except (OSError, ValueError, KeyError, msgspec.MsgspecError) as error:
        raise InputError(file, f"damaged ({error})", "simulate the recording again") from error
    stamps, poses = read_tum(folder / "poses.tum")

    def image(stamp: float) -> Ids | None:
        from PIL import Image

        if stamp not in index:
            return None
        with Image.open(folder / "ids" / f"{index[stamp]:06d}.png") as picture:
            return np.asarray(picture).astype(np.uint16)

    graph = read_json(folder / "graph.json")
    return Truth(graph, placement, stamps, poses, visits, deviations, parts, image)


def _folder(recording: str | Path) -> Path:
    path = Path(recording)
    return (path.parent if path.is_file() else path) / FOLDER
