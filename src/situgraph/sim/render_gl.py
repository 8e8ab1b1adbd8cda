"""Pictures by OpenGL on EGL: no display needed, Mesa's software rasteriser is enough."""

from __future__ import annotations

import contextlib
import gc
import weakref
from collections.abc import Iterator
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.io.recording import Intrinsics
from situgraph.sim.renderer import SKY, View, shading
from situgraph.sim.world import World

_NEAR, _FAR = 0.05, 200.0  # m

_VERTEX = """
#version 330
uniform mat4 projection;
in vec3 position;
in vec3 normal;
in vec2 uv;
in uvec2 what;  // part, room
out vec3 at;
flat out vec3 face;
out vec2 tile;
flat out uvec2 id;
void main() {
    at = position;
    face = normal;
    tile = uv;
    id = what;
    gl_Position = projection * vec4(position, 1.0);
}
"""

_FRAGMENT = """
#version 330
uniform vec3 eye;
uniform vec3 forward;
uniform sampler2DArray textures;
uniform sampler2D parts;   // two texels a part: layer, tiles/m, gloss, pane; red, green, blue, room
uniform sampler2D lamps;   // two texels a lamp: position; colour
uniform isampler2D first;  // where a room's lamps begin
in vec3 at;
flat in vec3 face;
in vec2 tile;
flat in uvec2 id;
layout(location = 0) out vec4 color;
layout(location = 1) out uint part;
layout(location = 2) out vec2 range;

vec3 outside(vec3 ray) {
    float up = ray.z;
    vec3 sky = mix(vec3(0.92, 0.95, 1.0), vec3(0.45, 0.65, 0.95), clamp(up * 2.0, 0.0, 1.0));
    float around = atan(ray.y, ray.x);
    float hedge = 0.05 + 0.03 * sin(9.0 * around) + 0.02 * sin(31.0 * around);
    vec3 green = vec3(0.25, 0.36, 0.18), lawn = vec3(0.42, 0.47, 0.33);
    return up > hedge ? sky : mix(lawn, green, smoothstep(-0.12, 0.0, up));
}

void main() {
    vec4 look = texelFetch(parts, ivec2(0, int(id.x)), 0);
    vec3 paint = texelFetch(parts, ivec2(1, int(id.x)), 0).rgb;
    vec3 to_eye = eye - at;
    float away = length(to_eye);
    vec3 ray = to_eye / away;
    vec3 n = face;
    float slant = dot(n, ray);
    part = id.x;
    range = vec2(dot(at - eye, forward), abs(slant));
    if (look.w > 0.5) {
        float mirror = 0.04 + 0.5 * pow(1.0 - abs(slant), 4.0);
        color = vec4(mix(outside(-ray), vec3(0.75), mirror), 1.0);
        return;
    }
    if (slant < 0.0) n = -n;
    vec3 albedo = paint * texture(textures, vec3(tile * look.y, look.x)).rgb * 1.25;
    vec3 light = vec3(0.22 + 0.06 * n.z);
    float shine = 0.0;
    int begin = texelFetch(first, ivec2(int(id.y), 0), 0).r;
    int end = texelFetch(first, ivec2(int(id.y) + 1, 0), 0).r;
    for (int i = begin; i < end; ++i) {
        vec3 to = texelFetch(lamps, ivec2(0, i), 0).xyz - at;
        float d2 = dot(to, to);
        vec3 l = to * inversesqrt(d2);
        float lambert = max(dot(n, l), 0.0) + 0.12;
        vec3 power = texelFetch(lamps, ivec2(1, i), 0).rgb * (2.6 / (2.0 + d2));
        light += power * lambert;
        shine += pow(max(dot(reflect(-l, n), ray), 0.0), 24.0) * (2.6 / (2.0 + d2));
    }
    color = vec4(albedo * light + look.z * shine, 1.0);
}
"""


class GlUnavailableError(Exception):
    """There is no OpenGL 3.3 context to be had."""


class GlRenderer:
    """Draws with one context of its own; keep to one thread.

    Attributes:
        name: OpenGL and the driver behind it.
    """

    def __init__(self, world: World) -> None:
        try:
            import moderngl

            create: Any = moderngl.create_context
            self._gl: Any = create(standalone=True, backend="egl", require=330)
        except Exception as error:  # moderngl raises bare exceptions of many kinds
            raise GlUnavailableError(str(error) or type(error).__name__) from error
        # The driver keeps a context and what is in it until told to let go.
        weakref.finalize(self, self._gl.release)
        self._gl.gc_mode = "auto"
        self._origin = world.origin
        self._target: tuple[tuple[int, int], Any] | None = None
        try:
            with self._alone():
                self.name = f"OpenGL ({self._gl.info['GL_RENDERER']})"
                self._program: Any = self._gl.program(
                    vertex_shader=_VERTEX, fragment_shader=_FRAGMENT
                )
                self._load(world)
                self._framebuffer(8, 8)
        except Exception as error:  # a driver that makes a context and cannot use it
            raise GlUnavailableError(str(error) or type(error).__name__) from error

    def view(self, pose: Array, intrinsics: Intrinsics, width: int, height: int) -> View:
        """See ``Renderer.view``."""
        with self._alone():
            return self._drawn(pose, intrinsics, width, height)

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        """Draw in our own context, and let no other one go meanwhile.

        OpenGL draws into whichever context is current; letting go of another renderer's (as the
        garbage collector may, at any time) leaves none.
        """
        collecting = gc.isenabled()
        gc.disable()
        try:
            with self._gl:
                yield
        finally:
            if collecting:
                gc.enable()

    def _drawn(self, pose: Array, intrinsics: Intrinsics, width: int, height: int) -> View:
        frame = self._framebuffer(width, height)
        frame.use()
        frame.clear()  # all zero: part 0 is the sky
        self._gl.enable(self._gl.DEPTH_TEST)
        eye = pose[:3, 3] - self._origin
        local = pose.copy()
        local[:3, 3] = eye
        projection = _projection(intrinsics, width, height) @ np.linalg.inv(local)
        self._program["projection"].write(projection.T.astype("f4").tobytes())
        self._program["eye"].value = tuple(eye)
        self._program["forward"].value = tuple(pose[:3, 2])
        for unit, texture in enumerate(self._textures):
            texture.use(unit)
        self._array.render()
        rgb = np.frombuffer(frame.read(components=3, attachment=0), np.uint8)
        rgb = rgb.reshape(height, width, 3).copy()
        ids = np.frombuffer(frame.read(components=1, attachment=1, dtype="u2"), np.uint16)
        range_ = np.frombuffer(frame.read(components=2, attachment=2, dtype="f4"), np.float32)
        # Rows come from the bottom; the projection is flipped so that they come from the top.
        range_ = range_.reshape(height, width, 2)
        ids = ids.reshape(height, width)
        depth = np.where(ids > 0, range_[..., 0], np.float32(0))
        rgb[ids == 0] = SKY
        return View(rgb, depth, ids, range_[..., 1])

    def _load(self, world: World) -> None:
        """Put triangles and looks where the shaders find them."""
        looks = shading(world)
        mesh = world.mesh
        count = 3 * len(mesh.part)
        vertex = np.zeros(
            count,
            dtype=[("position", "f4", 3), ("normal", "f4", 3), ("uv", "f4", 2), ("what", "u4", 2)],
        )
        vertex["position"] = mesh.corners.reshape(-1, 3)
        vertex["normal"] = np.repeat(mesh.normals, 3, axis=0)
        # Large coordinates lose the fine steps of a texture; whole tiles change nothing.
        tiles = np.floor(mesh.uv.mean(axis=1) * looks.parts[mesh.part, 1:2])
        shift = tiles / looks.parts[mesh.part, 1:2]
        vertex["uv"] = (mesh.uv - shift[:, None]).reshape(-1, 2)
        vertex["what"] = np.repeat(np.stack([mesh.part, looks.rooms], axis=1), 3, axis=0)
        buffer = self._gl.buffer(vertex.tobytes())
        content = [(buffer, "3f 3f 2f 2u", "position", "normal", "uv", "what")]
        self._array = self._gl.vertex_array(self._program, content)
        layers = world.textures
        textures = self._gl.texture_array(
            (layers.shape[2], layers.shape[1], len(layers)), 3, layers.tobytes()
        )
        textures.build_mipmaps()
        parts = self._gl.texture((2, len(looks.parts)), 4, looks.parts.tobytes(), dtype="f4")
        lamp = np.zeros((len(looks.lamps), 2, 4), dtype=np.float32)
        lamp[:, 0, :3], lamp[:, 1, :3] = looks.lamps[:, :3], looks.lamps[:, 3:]
        lamps = self._gl.texture((2, len(lamp)), 4, lamp.tobytes(), dtype="f4")
        first = self._gl.texture((len(looks.first), 1), 1, looks.first.tobytes(), dtype="i4")
        for table in (parts, lamps, first):
            table.filter = (self._gl.NEAREST, self._gl.NEAREST)
        self._textures = (textures, parts, lamps, first)
        for unit, name in enumerate(("textures", "parts", "lamps", "first")):
            self._program[name].value = unit

    def _framebuffer(self, width: int, height: int) -> Any:
        if self._target is None or self._target[0] != (width, height):
            size = (width, height)
            attachments = [
                self._gl.texture(size, 4),
                self._gl.texture(size, 1, dtype="u2"),
                self._gl.texture(size, 2, dtype="f4"),
            ]
            frame = self._gl.framebuffer(attachments, self._gl.depth_renderbuffer(size))
            self._target = (size, frame)
        return self._target[1]


def _projection(k: Intrinsics, width: int, height: int) -> Array:
    """From the optical frame (x right, y down, z forward) to clip coordinates, rows from the top.

    Pixel centres are whole numbers, so the image spans -0.5 to width - 0.5.
    """
    p = np.zeros((4, 4))
    p[0] = [2 * k.fx / width, 0, 2 * (k.cx + 0.5) / width - 1, 0]
    p[1] = [0, 2 * k.fy / height, 2 * (k.cy + 0.5) / height - 1, 0]
    p[2] = [0, 0, (_FAR + _NEAR) / (_FAR - _NEAR), -2 * _FAR * _NEAR / (_FAR - _NEAR)]
    p[3, 2] = 1
    return p
