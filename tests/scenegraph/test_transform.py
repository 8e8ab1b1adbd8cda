from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from situgraph.geometry.poses import Placement, matrix_to_pose, pose_to_matrix, wrap_angle
from situgraph.scenegraph.graph import Keyframe, Object, Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

coordinate = st.floats(-50, 50)
placements = st.builds(Placement, coordinate, coordinate, coordinate, st.floats(-3, 3))


def graph() -> SceneGraph:
    plane = Plane("p", (0.6, 0.8, 0.0), -2.0, ((2.0, 1.0), (-2.0, 4.0)))
    room = Room("r", (4.0, 5.0, 1.0), ("p",), footprint=((0, 0), (9, 0), (9, 9)))
    door = Object("o", "door", (2.0, 1.0, 1.0), rooms=("r",), planes=("p",))
    return SceneGraph(
        rooms=(room,),
        planes=(plane,),
        objects=(door,),
        keyframes=(Keyframe("k", 0, (1, 2, 3, 0, 0, 0, 1)),),
    )


@given(placements)
def test_distances_to_planes_do_not_change(placement) -> None:
    before, after = graph(), transformed(graph(), placement)
    for g in (before, after):
        n, d = g.plane_arrays(["p"])
        assert np.allclose(n @ g.rooms[0].center + d, 0.6 * 4 + 0.8 * 5 - 2.0, atol=1e-9)
        assert np.allclose(n[:, :2] @ g.planes[0].extent[0] + d, 0.0, atol=1e-9)
        assert np.allclose(n @ g.objects[0].center + d, 0.0, atol=1e-9)


@given(placements)
def test_the_inverse_takes_it_back(placement) -> None:
    back = transformed(transformed(graph(), placement), placement.inverse())
    assert np.allclose(back.rooms[0].center, graph().rooms[0].center, atol=1e-9)
    assert np.allclose(back.keyframes[0].pose, graph().keyframes[0].pose, atol=1e-9)
    assert np.allclose(back.planes[0].offset, graph().planes[0].offset, atol=1e-9)


@given(placements, placements)
def test_composition_is_one_after_the_other(first, second) -> None:
    point = np.array([[1.0, -2.0, 0.5]])
    assert np.allclose(second.compose(first).points(point), second.points(first.points(point)))
    assert np.allclose(second.compose(first).matrix(), second.matrix() @ first.matrix())


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_poses_and_matrices(q) -> None:
    from scipy.spatial.transform import Rotation

    q = np.array(q) / np.linalg.norm(q)
    pose = np.array([1.0, 2.0, 3.0, *q])
    matrix = pose_to_matrix(pose)
    assert np.allclose(matrix[:3, :3], Rotation.from_quat(q).as_matrix())
    assert np.allclose(pose_to_matrix(matrix_to_pose(matrix)), matrix)


@given(st.floats(-100, 100))
def test_wrapped_angles(angle) -> None:
    wrapped = float(wrap_angle(angle))
    assert -np.pi <= wrapped < np.pi
    assert np.isclose(np.sin(wrapped), np.sin(angle), atol=1e-9)
