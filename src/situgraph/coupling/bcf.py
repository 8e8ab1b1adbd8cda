"""Deviations as BCF issues: what a BIM viewer opens beside the model.

The BIM Collaboration Format (buildingSMART, versions 2.1 and 3.0) is a zip with a folder for each
topic: ``markup.bcf`` says what is the matter, ``viewpoint.bcfv`` where to look from and which
elements are meant. All identifiers follow from the content, so the same run writes the same file.
"""

from __future__ import annotations

import io
import os
import uuid
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from situgraph.coupling.deviation import Deviation
from situgraph.geometry.poses import Array
from situgraph.scenegraph.files import write_atomic
from situgraph.scenegraph.graph import SceneGraph

Version = Literal["2.1", "3.0"]
AUTHOR = "situgraph"
TITLES = {
    "moved-wall": "Wall moved",
    "missing-wall": "Wall missing",
    "extra-wall": "Wall not in the plan",
    "moved-object": "Moved: {}",
    "missing-object": "Not found: {}",
    "extra-object": "Not in the plan: {}",
}
EYE = 1.6  # m over the floor of a usual room whose middle is at 1.4 m
STEP_BACK = 3.0  # m from what is looked at
FIELD_OF_VIEW = 60.0  # degrees
_SPACE = uuid.UUID("8f0ad3b6-2a8c-4c0e-9a57-6f5b9e0f6c11")


def write_bcf(
    deviations: Sequence[Deviation],
    prior: SceneGraph,
    path: str | os.PathLike[str],
    *,
    created: str = "1970-01-01T00:00:00Z",
    version: Version = "2.1",
    snapshots: Mapping[int, bytes] | None = None,
) -> Path:
    """Write one topic a deviation.

    Args:
        deviations: in the building frame of ``prior``.
        prior: the plan; its ``offset_x`` ... attributes lead back to the model's own coordinates.
        path: usually ``*.bcfzip`` (2.1) or ``*.bcf`` (3.0).
        created: date of the topics, ISO 8601.
        version: of the format.
        snapshots: pictures (PNG) by the deviation's number.

    Raises:
        InputError: the file cannot be written.
    """
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        _add(archive, "bcf.version", _version(version))
        for number, deviation in enumerate(deviations):
            key = f"{prior.name}/{number}/{deviation.kind}/{deviation.prior}/{deviation.online}"
            topic, view = (str(uuid.uuid5(_SPACE, f"{key}/{what}")) for what in ("topic", "view"))
            picture = (snapshots or {}).get(number)
            markup = _markup(deviation, prior, (topic, view), created, version, picture is not None)
            _add(archive, f"{topic}/markup.bcf", markup)
            _add(archive, f"{topic}/viewpoint.bcfv", _viewpoint(deviation, prior, view, version))
            if picture is not None:
                archive.writestr(_entry(f"{topic}/snapshot.png"), picture)
    return write_atomic(path, data.getvalue())


def _version(version: Version) -> Element:
    root = Element("Version", VersionId=version)
    if version == "2.1":
        SubElement(root, "DetailedVersion").text = version
    return root


def _markup(
    deviation: Deviation,
    prior: SceneGraph,
    guids: tuple[str, str],
    created: str,
    version: Version,
    pictured: bool,
) -> Element:
    root = Element("Markup")
    _header(root, prior, created, version)
    topic = SubElement(root, "Topic", Guid=guids[0], TopicType="Deviation", TopicStatus="Open")
    title = TITLES[deviation.kind].format(deviation.category)
    where = ", ".join(
        str(prior.room_by_id[r].name or r) for r in deviation.rooms if r in prior.room_by_id
    )
    SubElement(topic, "Title").text = _clean(f"{title} ({where})" if where else title)
    SubElement(topic, "CreationDate").text = created
    SubElement(topic, "CreationAuthor").text = AUTHOR
    SubElement(topic, "Description").text = _clean(_description(deviation))
    holder = topic if version == "3.0" else root
    if version == "3.0":
        frame = SubElement(SubElement(holder, "Viewpoints"), "ViewPoint", Guid=guids[1])
    else:
        frame = SubElement(holder, "Viewpoints", Guid=guids[1])
    SubElement(frame, "Viewpoint").text = "viewpoint.bcfv"
    if pictured:
        SubElement(frame, "Snapshot").text = "snapshot.png"
    return root


def _header(root: Element, prior: SceneGraph, created: str, version: Version) -> None:
    project = prior.attributes.get("project")
    header = SubElement(root, "Header")
    holder = SubElement(header, "Files") if version == "3.0" else header
    outside = {"IsExternal" if version == "3.0" else "isExternal": "true"}
    known = {"IfcProject": project} if isinstance(project, str) and len(project) == 22 else {}
    file = SubElement(holder, "File", {**known, **outside})
    SubElement(file, "Filename").text = _clean(prior.name or "model")
    SubElement(file, "Date").text = created


def _description(deviation: Deviation) -> str:
    lines = [deviation.message[:1].upper() + deviation.message[1:] + "."]
    if deviation.offset is not None and deviation.sigma is not None:
        lines.append(
            f"Offset {deviation.offset:+.3f} m along the planned normal into the room, "
            f"standard deviation {deviation.sigma:.3f} m."
        )
    if deviation.tilt is not None and deviation.tilt_sigma is not None:
        lines.append(
            f"Turned by {np.degrees(deviation.tilt):+.2f} deg in the plan, "
            f"standard deviation {np.degrees(deviation.tilt_sigma):.2f} deg."
        )
    x, y, z = deviation.place
    lines.append(f"At {x:.2f}, {y:.2f}, {z:.2f} m in the building.")
    return "\n".join(lines)


def _viewpoint(deviation: Deviation, prior: SceneGraph, guid: str, version: Version) -> Element:
    root = Element("VisualizationInfo", Guid=guid)
    parts = SubElement(root, "Components")
    if deviation.element:
        selection = SubElement(parts, "Selection")
        SubElement(selection, "Component", IfcGuid=deviation.element)
    SubElement(parts, "Visibility", DefaultVisibility="true")
    camera = SubElement(root, "PerspectiveCamera")
    eye, sight = _camera(deviation, prior)
    up = np.cross(np.cross(sight, [0.0, 0.0, 1.0]), sight)
    vectors = {
        "CameraViewPoint": eye + _offset(prior),
        "CameraDirection": sight,
        "CameraUpVector": up / np.linalg.norm(up),
    }
    for name, vector in vectors.items():
        node = SubElement(camera, name)
        for axis, value in zip("XYZ", vector.tolist()):
            SubElement(node, axis).text = f"{value:.6f}"
    SubElement(camera, "FieldOfView").text = f"{FIELD_OF_VIEW:g}"
    if version == "3.0":
        SubElement(camera, "AspectRatio").text = f"{4 / 3:.6f}"
    return root


def _camera(deviation: Deviation, prior: SceneGraph) -> tuple[Array, Array]:
    """Where to stand and where to look: from within the room, a few steps back."""
    place = np.asarray(deviation.place, dtype=float)
    room = next((prior.room_by_id[r] for r in deviation.rooms if r in prior.room_by_id), None)
    face = prior.plane_by_id.get(deviation.prior or "")
    centre = place if room is None else np.asarray(room.center, dtype=float)
    back = np.asarray(face.normal, dtype=float) if face is not None else centre - place
    back = np.array([back[0], back[1], 0.0])
    length = float(np.linalg.norm(back))
    back = np.array([1.0, 0.0, 0.0]) if length < 1e-6 else back / length
    eye = place + STEP_BACK * back
    eye[2] = centre[2] + EYE - 1.4
    sight = place - eye
    return eye, sight / np.linalg.norm(sight)


def _offset(prior: SceneGraph) -> Array:
    values = [prior.attributes.get(f"offset_{axis}") for axis in "xyz"]
    return np.array([float(v) if isinstance(v, int | float) else 0.0 for v in values])


def _clean(text: str) -> str:
    """Without characters that XML cannot hold."""
    return "".join(c for c in text if c in "\t\n" or " " <= c < "\ud800" or c >= "\ue000")


def _add(archive: zipfile.ZipFile, name: str, root: Element) -> None:
    indent(root)
    archive.writestr(_entry(name), tostring(root, encoding="utf-8", xml_declaration=True))


def _entry(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)  # dated 1980, whenever it is written
    info.compress_type = zipfile.ZIP_DEFLATED
    return info
