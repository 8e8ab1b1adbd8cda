"""What really happened when an S-Graph was sampled; kept apart from the graph itself."""

from __future__ import annotations

from typing import Literal

import msgspec

from situgraph.geometry.poses import Placement
from situgraph.scenegraph.graph import SceneGraph


class MovedPlane(msgspec.Struct, frozen=True):
    """A face that stands elsewhere than planned.

    ``offset`` (m) is positive along the planned inward normal, as in the match JSON. ``online`` is
    None where the face was not seen.
    """

    prior: str
    online: str | None
    offset: float


class SampleTruth(msgspec.Struct, frozen=True, kw_only=True):
    """The true correspondences and motions of a sample; all mappings are online id -> prior id.

    ``placement`` takes map to building coordinates. With drift there is no exact one: it is the
    best rigid fit over the true rooms then, ``start`` is exact for the first room, and
    ``room_placements`` has each room's own. ``duplicates`` are second instances of objects that
    stand in ``objects`` too; ``confused`` and ``wrong_wall`` objects stand in ``objects``.
    ``order`` is the order of exploration, ``walked`` the metres walked when each of these rooms
    was entered. ``contiguous`` is False where the plan had no way on and the next nearest room
    was taken.
    """

    format: Literal["situgraph/sample-truth"] = "situgraph/sample-truth"
    version: Literal[1] = 1
    placement: Placement
    start: Placement
    room_placements: dict[str, Placement]
    storeys: dict[str, str]
    rooms: dict[str, str]
    planes: dict[str, str]
    objects: dict[str, str]
    duplicates: dict[str, str]
    confused: tuple[str, ...]
    wrong_wall: tuple[str, ...]
    moved: tuple[MovedPlane, ...]
    missing_planes: tuple[str, ...]
    missed_objects: tuple[str, ...]
    false_rooms: tuple[str, ...]
    false_planes: tuple[str, ...]
    false_objects: tuple[str, ...]
    order: tuple[str, ...]
    walked: tuple[float, ...]
    contiguous: bool


class OnlineSample(msgspec.Struct, frozen=True):
    """An S-Graph as a robot would have it, and the truth about it."""

    online: SceneGraph
    truth: SampleTruth


def truth_to_json(truth: SampleTruth) -> bytes:
    """The truth as JSON, two spaces of indent."""
    return msgspec.json.format(msgspec.json.encode(truth), indent=2) + b"\n"


def truth_from_json(data: bytes) -> SampleTruth:
    """The truth from JSON.

    Raises:
        msgspec.ValidationError: the text is JSON but no sample truth.
        msgspec.DecodeError: the text is no JSON.
    """
    return msgspec.json.decode(data, type=SampleTruth)
