"""Issues that a BIM viewer opens: whole, well-formed, about the right elements."""

from __future__ import annotations

import zipfile
from pathlib import Path

import msgspec
import numpy as np
import pytest
from defusedxml.ElementTree import fromstring
from tests.coupling.plans import PRIOR

from situgraph.coupling.bcf import Version, write_bcf
from situgraph.coupling.deviation import Deviation

GUID = "2O2Fr$t4X7Zf8NOew3FLOH"
MOVED = Deviation(
    "moved-wall", "wall", (7.0, 2.6, 1.4), "the wall stands 20 cm into <room> & more",
    "p3", "p1", ("r1",), 0.2, 0.01, 0.001, 0.002, GUID,
)  # fmt: skip
GONE = Deviation("missing-object", "door", (7.0, 1.2, 1.0), "was not found\x00", prior="o2")


@pytest.mark.parametrize("version", ["2.1", "3.0"])
def test_topics_with_a_viewpoint_each(tmp_path: Path, version: Version) -> None:
    path = write_bcf([MOVED, GONE], PRIOR, tmp_path / "d.bcfzip", version=version)
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        assert fromstring(archive.read("bcf.version")).get("VersionId") == version
        topics = [n for n in names if n.endswith("markup.bcf")]
        assert len(topics) == 2
        first = fromstring(archive.read(topics[0]))
        assert "<room> & more" in (first.findtext("Topic/Description") or "")
        view = fromstring(archive.read(topics[0].replace("markup.bcf", "viewpoint.bcfv")))
    assert view.find("Components/Selection/Component").get("IfcGuid") == GUID
    eye, sight = (
        np.array([float(view.findtext(f"PerspectiveCamera/{part}/{axis}")) for axis in "XYZ"])
        for part in ("CameraViewPoint", "CameraDirection")
    )
    toward = np.array(MOVED.place) - eye
    assert sight == pytest.approx(toward / np.linalg.norm(toward), abs=1e-5)
    assert 0.0 < eye[0] < 7.0  # inside the room that the face looks into
    assert 0.0 < eye[1] < 5.2


def test_far_models_get_their_own_coordinates(tmp_path: Path) -> None:
    far = PRIOR.replace(attributes={"offset_x": 2.6e6, "offset_y": 1.2e6, "offset_z": 400.0})
    views = []
    for prior in (PRIOR, far):
        with zipfile.ZipFile(write_bcf([MOVED], prior, tmp_path / "d.bcf")) as archive:
            name = next(n for n in archive.namelist() if n.endswith(".bcfv"))
            view = fromstring(archive.read(name))
        views.append([float(view.findtext(f".//CameraViewPoint/{a}")) for a in "XYZ"])
    assert np.subtract(*reversed(views)) == pytest.approx([2.6e6, 1.2e6, 400.0])


def test_the_same_run_gives_the_same_file(tmp_path: Path) -> None:
    one = write_bcf([MOVED, GONE], PRIOR, tmp_path / "a.bcf").read_bytes()
    assert write_bcf([MOVED, GONE], PRIOR, tmp_path / "b.bcf").read_bytes() == one
    assert write_bcf([GONE], PRIOR, tmp_path / "c.bcf").read_bytes() != one


def test_another_library_reads_it(tmp_path: Path) -> None:
    bcf = pytest.importorskip("bcf.v2.bcfxml")
    path = write_bcf(
        [MOVED, msgspec.structs.replace(GONE, message="gone")],
        PRIOR,
        tmp_path / "d.bcfzip",
        snapshots={0: b"\x89PNG"},
    )
    with bcf.BcfXml.load(path) as document:
        topics = {t.topic.title: t for t in document.topics.values()}
        assert set(topics) == {"Wall moved (room 1)", "Not found: door"}
        moved = topics["Wall moved (room 1)"]
        (view,) = moved.viewpoints.values()
        chosen = view.visualization_info.components.selection.component
        assert [c.ifc_guid for c in chosen] == [GUID]
