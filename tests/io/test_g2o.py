"""S-Graphs+ logs: what is read, how it is oriented, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.io.g2o import read_g2o

POSE = "0 0 0 1"
COLOUR = "0.2 0.2 0.2"
INFO2 = "0.1 0 0.1"

# A 4 x 4 m room with normals logged in any direction, and a corridor east of it that shares wall 2.
LOG = f"""\
VERTEX_SE3:QUAT 0 0 0 0 {POSE}
FIX 0
VERTEX_SE3:QUAT 10 2 2 0.1 0 0 0 2
VERTEX_PLANE 1 1 0 0 0 {COLOUR}
VERTEX_PLANE 2 1 0 0 -4 {COLOUR}
VERTEX_PLANE 3 0 -1 0 0 {COLOUR}
VERTEX_PLANE 4 0 -2 0.2 8 {COLOUR}
VERTEX_PLANE 5 1 0 0 -6 {COLOUR}
VERTEX_PLANE 6 0 1 0 3 {COLOUR}
VERTEX_PLANE 7 0 0 1 1 {COLOUR}
VERTEX_FLOOR 20 2 2 -0.4 {POSE}
VERTEX_ROOM 30 2 2 0 {POSE}
VERTEX_ROOM 31 5 1 0 {POSE}
VERTEX_ROOM 32 5 1.1 0 {POSE}
EDGE_SE3:QUAT 0 10 2 2 0 {POSE} 1
EDGE_ROOM_4PLANES 30 1 2 3 4 0 0 {INFO2}
EDGE_ROOM_2PLANES 31 2 5 32 0 0 {INFO2}
EDGE_FLOOR_ROOM 20 30 2 2 {INFO2}
EDGE_SE3_PLANE 10 6 0 1 0 5 1 0 0 1 0 1
VERTEX_PLANE 40 -1 0 0 9 {COLOUR}
FIX 40
VERTEX_PLANE 41 1 0 0 -5 {COLOUR}
VERTEX_ROOM 42 7 1 0 {POSE}
FIX 41 42
EDGE_ROOM_2PLANES 42 40 41 32 0 0 {INFO2}
"""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "run" / "graph.g2o"
    path.parent.mkdir()
    path.write_text(LOG)
    return path


def test_the_free_part_is_the_online_graph(log: Path) -> None:
    graph = read_g2o(log)
    assert (graph.kind, graph.name) == ("online", "run")
    assert [r.id for r in graph.rooms] == ["30", "31"]  # 32 is a corridor's cluster centre
    assert [k.id for k in graph.keyframes] == ["10"]
    assert graph.keyframes[0].pose == (2, 2, 0.1, 0, 0, 0, 1)
    assert [(s.id, s.elevation) for s in graph.storeys] == [("20", -0.4)]
    assert {r.storey for r in graph.rooms} == {"20"}


def test_normals_point_into_their_room_and_a_wall_between_rooms_has_two_faces(log: Path) -> None:
    graph = read_g2o(log)
    assert graph.room_by_id["30"].planes == ("1", "2", "3", "4")
    assert graph.room_by_id["31"].planes == ("2b", "5")
    for room in graph.rooms:
        normals, offsets = graph.plane_arrays(room.planes)
        assert np.all(normals @ np.array(room.center) + offsets > 0)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    one, other = graph.plane_by_id["2"], graph.plane_by_id["2b"]
    assert one.source == other.source == "VERTEX_PLANE 2"
    np.testing.assert_allclose(one.normal, -np.array(other.normal))
    assert one.offset == -other.offset
    tilted = graph.plane_by_id["4"]
    assert tilted.normal[2] == pytest.approx(0.0995, abs=1e-4)  # the tilt is kept


def test_planes_without_a_room_face_the_keyframe_and_flat_ones_are_reported(log: Path) -> None:
    graph = read_g2o(log)
    assert graph.plane_by_id["6"].normal == (0, 1, 0)
    assert "7" not in graph.plane_by_id
    assert [(w.code, w.ids) for w in graph.warnings] == [("plane-not-vertical", ("7",))]


def test_the_fixed_part_is_the_prior(log: Path) -> None:
    graph = read_g2o(log, "fixed")
    assert (graph.kind, [r.id for r in graph.rooms]) == ("prior", ["42"])
    assert [p.id for p in graph.planes] == ["40", "41"]
    assert graph.keyframes == ()
    assert read_g2o(log, prefer="fixed") == graph


def test_the_part_that_has_rooms_is_taken_unless_one_is_asked_for(log: Path) -> None:
    log.write_text("".join(s for s in LOG.splitlines(True) if not s.startswith("FIX")))
    assert read_g2o(log, prefer="fixed").kind == "online"
    with pytest.raises(InputError, match="no fixed room; its free part has some"):
        read_g2o(log, "fixed")


def test_stamps_come_from_the_keyframe_folders(log: Path) -> None:
    folder = log.parent / "000000"
    folder.mkdir()
    (folder / "data").write_text("stamp 80.493 80493000000\nestimate\n1 0 0 0\nid 10\n")
    assert read_g2o(log).keyframes[0].stamp == 80.493


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("VERTEX_ROOM 30 2 2 0", "VERTEX_ROOM 30 2 nan 0", "line 12: .*not finite"),
        ("VERTEX_ROOM 30 2 2 0", "VERTEX_ROOM 30 2 x 0", "line 12: .*not a number"),
        ("VERTEX_PLANE 1 1 0 0 0", "VERTEX_PLANE 1 0 0 0 0", "line 4: .*zero normal"),
        ("VERTEX_PLANE 2 1 0 0 -4", "VERTEX_PLANE 1 1 0 0 -4", "line 5: a second vertex 1"),
        ("30 1 2 3 4 0 0", "30 1 2 3 99 0 0", "line 16: .*VERTEX_PLANE 99, which is not in"),
        ("30 1 2 3 4 0 0", "30 1 2 3", "line 16: .*7 fields, expected 10"),
        ("10 2 2 0.1 0 0 0 2", "10 2 2 0.1 0 0 0 0", "line 3: .*zero quaternion"),
        (f"FIX 41 42\nEDGE_ROOM_2PLANES 42 40 41 32 0 0 {INFO2}", "VERTEX_PLANE 9", "line 24:"),
        ("VERTEX_FLOOR 20", "VERTEX_FLOOR ../x", "line 11: .*no vertex id"),
        ("FIX 0", "import os", "line 2: 'import' is no g2o tag"),
        ("FIX 0", "FIX", "line 2: FIX names no vertex"),
    ],
)
def test_a_bad_line_is_named(log: Path, old: str, new: str, problem: str) -> None:
    assert old in LOG
    log.write_text(LOG.replace(old, new, 1))
    with pytest.raises(InputError, match=problem) as caught:
        read_g2o(log)
    assert str(log) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_no_logs_are_refused(tmp_path: Path) -> None:
    empty = tmp_path / "empty.g2o"
    empty.touch()
    huge = tmp_path / "huge.g2o"
    with open(huge, "wb") as file:
        file.truncate(2 << 30)
    poses = tmp_path / "poses.g2o"
    poses.write_text(f"VERTEX_SE3:QUAT 0 0 0 0 {POSE}\n")
    expected = {
        empty: "empty or not text",
        huge: "2147 MB is more than",
        poses: "has no VERTEX_ROOM",
        tmp_path: "is a directory",
        tmp_path / "missing.g2o": "no such file",
    }
    for path, problem in expected.items():
        with pytest.raises(InputError, match=problem):
            read_g2o(path)


# free rooms, planes, keyframes; fixed rooms, planes
SE1 = {
    "S-Graphs/R3": (3, 12, 9, 7, 28),
    "S-Graphs/R4": (4, 12, 11, 7, 28),
    "S-Graphs/R5": (5, 21, 15, 7, 28),
    "S-Graphs/R6": (7, 21, 22, 8, 34),
    "S-Graphs/R7": (6, 22, 21, 7, 28),
    "S-Graphs/R8": (6, 24, 34, 7, 28),
    "S-Graphs/RAll": (7, 21, 22, 8, 34),
    **{f"A-Graphs/T{i}": (0, 0, 0, 8, 34) for i in range(6)},
}


@pytest.mark.external
@pytest.mark.parametrize("name", SE1)
def test_the_logs_of_s_graphs(shared_data: Path, name: str) -> None:
    rooms, planes, keyframes, prior_rooms, prior_planes = SE1[name]
    path = shared_data / "sgraphs" / "SE1" / name / "graph.g2o"
    prior = read_g2o(path, prefer="fixed")
    assert (prior.kind, len(prior.rooms), len(prior.planes)) == ("prior", prior_rooms, prior_planes)
    graph = read_g2o(path)
    if not rooms:
        assert graph == prior
        return
    assert (len(graph.rooms), len(graph.planes), len(graph.keyframes)) == (rooms, planes, keyframes)
    assert all(len(room.planes) in (2, 4) for room in graph.rooms)
    for node in (graph, prior):
        for room in node.rooms:
            normals, offsets = node.plane_arrays(room.planes)
            assert np.all(normals @ np.array(room.center) + offsets > 0.5)
            # Opposite walls come in pairs: each looks at the other.
            pairs = normals.reshape(-1, 2, 3)
            assert np.all(np.einsum("ij,ij->i", pairs[:, 0], pairs[:, 1]) < -0.95)
