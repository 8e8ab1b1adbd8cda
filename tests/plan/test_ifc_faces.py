"""The pure geometry below the IFC reader: faces, footprints, hosting."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from shapely import Polygon
from shapely.geometry.polygon import orient

from situgraph.plan.backing import backing, wall_faces
from situgraph.plan.building import Element, Mesh
from situgraph.plan.config import PlanConfig
from situgraph.plan.contents import ellipsoid
from situgraph.plan.faces import Face, merged, vertical_faces
from situgraph.plan.openings import extent_box
from situgraph.plan.outlines import footprint, is_consistent

CONFIG = PlanConfig()


def prism(outline: list[tuple[float, float]], height: float = 2.5) -> Mesh:
    """An upright prism on a counter-clockwise outline."""
    ring = np.array(outline, dtype=float)
    n = len(ring)
    low, high = (np.column_stack([ring, np.full(n, z)]) for z in (0.0, height))
    number = {tuple(corner): k for k, corner in enumerate(ring)}
    faces = []
    for k in range(n):
        m = (k + 1) % n
        faces += [(k, m, n + m), (k, n + m, n + k)]
    for part in shapely.constrained_delaunay_triangles(Polygon(outline)).geoms:
        a, b, c = (number[corner] for corner in orient(part).exterior.coords[:3])
        faces += [(c, b, a), (n + a, n + b, n + c)]
    return Mesh(np.concatenate([low, high]), np.array(faces, dtype=np.int64))


def cuboid(low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    body = trimesh.creation.box(bounds=[low, high])
    return Mesh(np.asarray(body.vertices), np.asarray(body.faces, dtype=np.int64))


sizes = st.floats(0.5, 30.0)
angles = st.floats(-math.pi, math.pi)


@given(width=sizes, depth=sizes, yaw=angles)
def test_a_box_has_four_faces_that_point_outwards(width: float, depth: float, yaw: float) -> None:
    body = trimesh.creation.box((width, depth, 2.0))
    body.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
    mesh = Mesh(np.asarray(body.vertices), np.asarray(body.faces, dtype=np.int64))
    faces = vertical_faces(mesh, CONFIG)
    assert len(faces) == 4
    assert sorted(-f.offset for f in faces) == pytest.approx(
        sorted((width / 2, width / 2, depth / 2, depth / 2)), abs=1e-6
    )
    assert sorted(f.length for f in faces) == pytest.approx(
        sorted((width, width, depth, depth)), abs=1e-6
    )
    inward = vertical_faces(mesh, CONFIG, outward=False)
    assert sorted(f.offset for f in inward) == pytest.approx(sorted(-f.offset for f in faces))
    (floor,) = footprint(mesh)
    assert floor.area == pytest.approx(width * depth, abs=1e-4)


@given(yaw=angles, scramble=st.lists(st.integers(0, 11), max_size=6))
def test_winding_does_not_matter(yaw: float, scramble: list[int]) -> None:
    body = trimesh.creation.box((3.0, 2.0, 2.0))
    body.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
    triangles = np.array(body.faces, dtype=np.int64)
    triangles[scramble] = triangles[scramble][:, ::-1]
    mesh = Mesh(np.asarray(body.vertices), triangles)
    assert is_consistent(mesh) == (len(set(scramble)) == 0)
    assert sorted(-f.offset for f in vertical_faces(mesh, CONFIG)) == pytest.approx(
        [1, 1, 1.5, 1.5]
    )


def test_wide_gaps_part_coplanar_faces() -> None:
    comb = [
        (0, 0),
        (9, 0),
        (9, 2),
        (8, 2),
        (8, 1),
        (6, 1),
        (6, 2),
        (5, 2),
        (5, 1),
        (4, 1),
        (4, 2),
        (0, 2),
    ]
    mesh = prism([(float(x), float(y)) for x, y in comb])
    tops = [f for f in vertical_faces(mesh, CONFIG) if f.normal[1] > 0.9 and f.offset < -1.9]
    # The gap of 1 m is bridged, the one of 2 m is not.
    assert sorted(round(f.length, 6) for f in tops) == [1.0, 5.0]
    spans = max(tops, key=lambda f: f.length).spans
    assert np.allclose(np.abs(spans), [(0.0, 4.0), (5.0, 6.0)])


def test_the_strip_above_a_niche_is_no_part_of_the_face() -> None:
    # A room of 4 x 3 m with a niche 2 m wide, 0.3 m deep and 2.3 m high in its south side.
    whole = trimesh.creation.box(bounds=[(0, 0, 0), (4, 3, 2.5)])
    parts = [whole, trimesh.creation.box(bounds=[(2, -0.3, 0), (4, 0, 2.3)])]
    faces: list[list[int]] = []
    corners: list[np.ndarray] = []
    for body in parts:
        keep = [f for f in body.faces if not np.allclose(body.vertices[f][:, 1], 0.0)]
        faces += [[len(corners) * 8 + int(k) for k in f] for f in keep]
        corners.append(np.asarray(body.vertices))
    ring = [(0, 0, 0), (2, 0, 0), (2, 0, 2.3), (4, 0, 2.3), (4, 0, 2.5), (0, 0, 2.5), (2, 0, 2.5)]
    start = 16
    strip = [(0, 1, 6), (0, 6, 5), (2, 3, 4), (2, 4, 6)]
    faces += [[start + k for k in t] for t in strip]
    mesh = Mesh(np.vstack([*corners, ring]), np.array(faces, dtype=np.int64))
    found = vertical_faces(mesh, CONFIG, outward=False, min_height=0.6)
    south = [f for f in found if f.normal[1] > 0.9 and abs(f.offset) < 1e-6]
    assert sorted((round(f.length, 3), round(f.height, 3)) for f in south) == [
        (2.0, 0.2),
        (2.0, 2.5),
    ]
    whole_faces = vertical_faces(mesh, CONFIG, outward=False)
    assert [
        round(f.length, 3) for f in whole_faces if f.normal[1] > 0.9 and abs(f.offset) < 1e-6
    ] == [4]


def test_the_tangent_runs_counter_clockwise_round_a_room() -> None:
    mesh = prism([(0, 0), (4, 0), (4, 3), (0, 3)])
    south = next(f for f in vertical_faces(mesh, CONFIG, outward=False) if f.normal[1] > 0.9)
    assert south.point(south.low) == pytest.approx((0.0, 0.0))
    assert south.point(south.high) == pytest.approx((4.0, 0.0))


spans = st.lists(st.tuples(st.floats(0, 50), st.floats(0, 5)).map(lambda p: (p[0], p[0] + p[1])))


@given(spans)
def test_merged_intervals_cover_the_same_and_are_apart(
    intervals: list[tuple[float, float]],
) -> None:
    out = merged(intervals)
    assert all(a[1] < b[0] for a, b in pairwise(out))
    for low, high in intervals:
        assert any(lo <= low and high <= hi for lo, hi in out)


def wall(mesh: Mesh, key: int = 1) -> Element:
    return Element(key, "guid", "IfcWall", None, mesh)


FACE = Face((0.0, 1.0), 0.0, ((0.0, 4.0),), 0.0, 2.5)  # y = 0, the room at y > 0


@pytest.mark.parametrize(
    ("low", "high", "share"),
    [
        ((0, -0.2, 0), (4, 0, 2.5), 1.0),  # a wall right behind
        ((0, -0.4, 0), (4, -0.2, 2.5), 1.0),  # 0.2 m behind
        ((0, -0.9, 0), (4, -0.5, 2.5), 0.0),  # too far behind
        ((0, -0.2, 0), (1, 0, 2.5), 0.25),  # a quarter of the length
        ((0, -0.2, 2.1), (4, 0, 2.5), 0.0),  # a lintel
        ((0, -0.2, 0), (4, 0, 0.5), 1.0),  # a knee wall
        ((0, -0.2, 0), (4, 0, 0.1), 0.0),  # a skirting board
        ((0, -0.2, 1.0), (4, 0, 2.5), 1.0),  # hanging, over half of the height
    ],
)
def test_what_counts_as_a_wall_behind(
    low: tuple[float, ...], high: tuple[float, ...], share: float
) -> None:
    found = backing(FACE, wall_faces([wall(cuboid(low, high))], CONFIG), CONFIG)
    assert found.share == pytest.approx(share)
    assert (found.key is None) == (share == 0.0)


def test_two_walls_one_above_the_other_add_up() -> None:
    walls = [wall(cuboid((0, -0.2, 0), (4, 0, 0.3))), wall(cuboid((0, -0.2, 0.3), (4, 0, 2.5)), 2)]
    assert backing(FACE, wall_faces(walls, CONFIG), CONFIG).share == pytest.approx(1.0)


@given(width=st.floats(0.6, 3.0), depth=st.floats(0.1, 0.5), yaw=angles)
def test_the_smallest_box_and_its_ellipsoid(width: float, depth: float, yaw: float) -> None:
    body = trimesh.creation.box((width, depth, 2.0))
    body.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
    box = extent_box(Mesh(np.asarray(body.vertices), np.asarray(body.faces, dtype=np.int64)))
    assert box.half == pytest.approx((width / 2, depth / 2, 1.0), abs=1e-6)
    made = ellipsoid(box, 0.05)
    x, y, z, w = made.rotation
    assert (x, y) == (0.0, 0.0)
    turned = 2 * math.atan2(z, w)
    assert abs(math.sin(turned - yaw)) < 1e-6
    assert made.axes == pytest.approx((width / 2, max(depth / 2, 0.05), 1.0), abs=1e-6)
