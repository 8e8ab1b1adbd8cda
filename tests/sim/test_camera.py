"""Pictures: depth by formula, noise as stated, part numbers where things are."""

from __future__ import annotations

from typing import ClassVar

import msgspec
import numpy as np
import pytest
from tests.sim.buildings import box_room, two_rooms, window

from situgraph.errors import SituGraphError
from situgraph.geometry.poses import pose_to_matrix
from situgraph.io.recording import Intrinsics
from situgraph.scenegraph.graph import Ellipsoid, Object
from situgraph.sim.camera import Camera
from situgraph.sim.config import CameraConfig, WorldConfig
from situgraph.sim.render_cpu import CpuRenderer
from situgraph.sim.render_gl import GlRenderer, GlUnavailableError
from situgraph.sim.renderer import Renderer, View, make_renderer
from situgraph.sim.simulation import camera_mount
from situgraph.sim.world import World, build_world

BARE = WorldConfig(pictures=0.0)
CLEAN = CameraConfig(disparity_noise=0.0, edge_loss=0.0, dropout=0.0, glass_depth=1.0)
K = Intrinsics(77.2, 77.2, 63.5, 47.5)


def renderer(kind: str, world: World) -> Renderer:
    if kind == "cpu":
        return CpuRenderer(world)
    try:
        return GlRenderer(world)
    except GlUnavailableError:
        pytest.skip("no OpenGL here")


def looking(x: float, y: float, z: float, yaw: float) -> np.ndarray:
    """The optical frame at a place, looking level in a direction."""
    base = np.eye(4)
    base[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    base[:3, 3] = (x, y, z)
    return base @ pose_to_matrix(camera_mount((0.0, 0.0, 0.0), 0.0))


@pytest.fixture(scope="module")
def glazed() -> World:
    return build_world(box_room((window("w", -0.1, 2.0, "a", "a.w"),)), BARE, 0)


@pytest.mark.parametrize("kind", ["cpu", "gl"])
def test_depth_of_a_wall_ahead_is_its_distance_in_every_pixel(kind: str) -> None:
    world = build_world(box_room(), BARE, 0)
    view = renderer(kind, world).view(looking(2, 2, 1.4, 0.0), K, 128, 96)
    v, u = np.mgrid[0:96, 0:128]
    side, up = (u - K.cx) / K.fx * 4.0, (v - K.cy) / K.fy * 4.0
    wall = (np.abs(side) < 1.9) & (np.abs(up) < 1.3)
    assert wall.sum() > 500
    assert np.abs(view.depth[wall] - 4.0).max() < 1e-3
    # The floor: depth follows from the row alone.
    floor = (up > 1.5) & (np.abs(side) < 1.0)
    expected = 1.4 * K.fy / (v[floor] - K.cy)
    assert np.abs(view.depth[floor] / expected - 1).max() < 1e-3
    assert np.abs(view.slant[wall] - 4 / np.hypot(np.hypot(side, up), 4)[wall]).max() < 1e-3


@pytest.mark.parametrize("kind", ["cpu", "gl"])
def test_part_numbers_stand_where_things_project(kind: str, glazed: World) -> None:
    pose = looking(3.0, 2.0, 1.2, np.pi)
    view = renderer(kind, glazed).view(pose, K, 128, 96)
    to_camera = np.linalg.inv(pose)
    for point, name in (
        ((-0.09, 2.35, 1.5), "glass"),
        ((-0.06, 2.67, 1.5), "window frame"),
        ((0.0, 2.0, 2.5), "wall"),
        ((1.0, 2.0, 0.0), "floor"),
    ):
        x, y, z, _ = to_camera @ (*point, 1.0)
        u, v = round(K.fx * x / z + K.cx), round(K.fy * y / z + K.cy)
        part = glazed.parts[view.ids[v, u]]
        assert part.name == name
        assert (part.object == "w") == (name in ("glass", "window frame"))


def test_both_renderers_draw_the_same(glazed: World) -> None:
    gl, cpu = renderer("gl", glazed), renderer("cpu", glazed)
    for yaw in (0.3, 2.0, 3.1):
        a, b = (r.view(looking(3.2, 1.7, 1.1, yaw), K, 128, 96) for r in (gl, cpu))
        same = a.ids == b.ids
        assert same.mean() > 0.98
        assert np.abs(a.depth - b.depth)[same].max() < 5e-3
        assert np.abs(a.rgb.astype(int) - b.rgb)[same].mean() < 12


@pytest.mark.parametrize("kind", ["cpu", "gl"])
def test_the_same_view_twice_is_the_same_to_the_bit(kind: str, glazed: World) -> None:
    views: list[View] = []
    for _ in range(2):
        views.append(renderer(kind, glazed).view(looking(3, 2, 1, 2.9), K, 128, 96))
    assert all(np.array_equal(a, b) for a, b in zip(*views))


class Wall:
    """A renderer of one plain wall at a distance."""

    name = "wall"

    def __init__(self, distance: float) -> None:
        self._z = distance

    def view(self, pose: np.ndarray, intrinsics: Intrinsics, width: int, height: int) -> View:
        shape = (height, width)
        grey = np.full((*shape, 3), 90, dtype=np.uint8)
        depth = np.full(shape, self._z, dtype=np.float32)
        return View(grey, depth, np.ones(shape, dtype=np.uint16), np.ones(shape, np.float32))


@pytest.mark.parametrize("z", [1.0, 3.0, 5.0])
def test_depth_noise_grows_with_the_square_of_the_distance(z: float, glazed: World) -> None:
    config = CameraConfig(dropout=0.0)
    camera = Camera(glazed, Wall(z), config, 640)
    picture = camera.take(np.eye(4), np.random.default_rng(0))
    expected = z * z * np.hypot(0.08, 0.03125 / np.sqrt(12)) / (386.0 * 0.05)
    seen = picture.depth[picture.depth > 0]
    assert seen.std() == pytest.approx(expected, rel=0.03)
    assert seen.mean() == pytest.approx(z, abs=0.3 * expected)


def test_out_of_range_there_is_no_depth(glazed: World) -> None:
    for z in (0.1, 30.0):
        camera = Camera(glazed, Wall(z), CLEAN, 64)
        assert (camera.take(np.eye(4), np.random.default_rng(0)).depth == 0).all()


def test_glass_and_edges_lose_depth(glazed: World) -> None:
    pose = looking(3.0, 2.0, 1.4, np.pi)
    lossy = msgspec.structs.replace(CLEAN, glass_depth=0.1, edge_loss=1.0)
    clear, lost = (
        Camera(glazed, CpuRenderer(glazed), c, 160).take(pose, np.random.default_rng(0))
        for c in (CLEAN, lossy)
    )
    glass = np.array([glazed.parts[i].name == "glass" for i in range(len(glazed.parts))])
    pane = glass[clear.ids]
    assert (clear.depth[pane] > 0).all()
    assert (lost.depth[pane] > 0).mean() < 0.15
    chest = Object("c", "cabinet", (1.2, 2.0, 0.5), Ellipsoid((0.3, 0.3, 0.5)), ("a",))
    world = build_world(box_room((chest,)), BARE, 0)
    camera = Camera(world, CpuRenderer(world), lossy, 160)
    depth = camera.take(pose, np.random.default_rng(0)).depth
    rows, columns = np.nonzero(depth == 0)
    # The outline of the chest, against the wall 1.2 m behind it.
    outline = (np.abs(columns - 79.5) < 24) & (rows > 40)
    assert len(rows) > 50
    assert outline.all()


def test_there_is_always_a_renderer_and_it_has_a_name() -> None:
    world = build_world(two_rooms(), BARE, 0)
    assert make_renderer(world, "cpu").name.startswith("CPU")
    assert make_renderer(world, "auto").name


class Broken:
    """A context whose driver cannot do what it promises."""

    info: ClassVar = {"GL_RENDERER": "broken"}

    def __enter__(self) -> Broken:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def release(self) -> None:
        return None

    def program(self, **_: object) -> None:
        raise RuntimeError("GLSL 3.30 is not supported")


def test_a_driver_that_fails_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    moderngl = pytest.importorskip("moderngl")
    world = build_world(two_rooms(), BARE, 0)

    def nothing(**_: object) -> None:
        raise RuntimeError("libEGL.so not loaded")

    for create, why in ((nothing, "not loaded"), (lambda **_: Broken(), "not supported")):
        monkeypatch.setattr(moderngl, "create_context", create)
        assert make_renderer(world, "auto").name.startswith("CPU")
        with pytest.raises(SituGraphError, match=why):
            make_renderer(world, "gl")
