"""Render labelled frames of random layouts for training, validation and test.

    python training/generate.py FRAMES/

Layout seeds and texture seeds of the three splits are disjoint ranges (``SPLITS``), apart from
those of the six-room building and of every simulation that situgraph ships; no building model of
any file is used. Same seeds, same renderer: same frames.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
from shapely import Point, Polygon

from situgraph.plan.layouts import make_layout
from situgraph.sim.camera import Camera, Picture
from situgraph.sim.config import CameraConfig, WorldConfig
from situgraph.sim.renderer import make_renderer
from situgraph.sim.simulation import camera_mount, pose_matrix
from situgraph.sim.world import World, build_world

# split -> (first layout seed, first texture seed, layouts, frames a layout)
SPLITS = {
    "train": (910_000, 920_000, 120, 30),
    "validation": (930_000, 940_000, 12, 25),
    "test": (950_000, 960_000, 12, 25),
}
NAMES = [
    "background",
    "door",
    "window",
    "radiator",
    "sink",
    "extinguisher",
    "column",
    "cabinet",
    "stairs",
]
KINDS = ("random", "modular", "corridor", "wings", "lshaped", "grid")
SIZE = (320, 240)
HEIGHT = (0.55, 1.1)  # m, camera over the floor: a legged robot, standing or on a plinth
MARGIN = 0.35  # m from walls
EMPTY_SHARE = 0.15  # of the frames that may show nothing at all


def layout_world(seed: int, texture_seed: int) -> World:
    """A furnished world of a layout kind that goes with its seed."""
    rng = np.random.default_rng([seed, 1])
    kind = KINDS[seed % len(KINDS)]
    density = float(rng.uniform(0.15, 0.4))
    graph = make_layout(kind, int(rng.integers(4, 9)), seed, object_density=density)
    config = WorldConfig(
        texture_seed=texture_seed,
        closed_doors=float(rng.choice([0.0, 0.3, 1.0])),
        pictures=float(rng.uniform(0.0, 2.5)),
        extra_furniture=int(rng.integers(0, 6)),
    )
    return build_world(graph, config, seed)


def pose(world: World, rng: np.random.Generator) -> np.ndarray:
    """A camera somewhere in a room, looking anywhere, level but for a few degrees."""
    rooms = [r for r in world.graph.rooms if r.footprint is not None]
    storeys = world.graph.storey_by_id
    while True:
        room = rooms[int(rng.integers(len(rooms)))]
        shape = Polygon(room.footprint).buffer(-MARGIN)
        if shape.is_empty:
            continue
        x0, y0, x1, y1 = shape.bounds
        x, y = rng.uniform(x0, x1), rng.uniform(y0, y1)
        floor = storeys[room.storey].elevation if room.storey else 0.0
        level = next((i for i, v in enumerate(world.levels) if room.id in v.rooms), 0)
        if shape.contains(Point(x, y)) and not world.obstacles[level].contains(Point(x, y)):
            break
    yaw, pitch = rng.uniform(-np.pi, np.pi), rng.normal(0.1, 0.06)
    mount = pose_matrix(camera_mount((0.0, 0.0, 0.0), float(pitch)))
    body = np.eye(4)
    body[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    body[:3, 3] = x, y, floor + rng.uniform(*HEIGHT)
    return body @ mount


def labels(world: World, picture: Picture) -> np.ndarray:
    """The category number of every pixel (h, w) uint8."""
    table = np.array(
        [NAMES.index(p.category) if p.category in NAMES else 0 for p in world.parts], np.uint8
    )
    return table[picture.ids]


def render(split: str, folder: Path) -> None:
    """Write ``<split>-images.npy`` and ``<split>-labels.npy``."""
    first, texture, layouts, frames = SPLITS[split]
    count = layouts * frames
    shape = (count, SIZE[1], SIZE[0])
    images = np.lib.format.open_memmap(folder / f"{split}-images.npy", "w+", np.uint8, (*shape, 3))
    truth = np.lib.format.open_memmap(folder / f"{split}-labels.npy", "w+", np.uint8, shape)
    done = 0
    started = time.monotonic()
    for k in range(layouts):
        world = layout_world(first + k, texture + k)
        camera = Camera(world, make_renderer(world, "auto"), CameraConfig(), SIZE[0])
        rng = np.random.default_rng([first + k, 2])
        while done < (k + 1) * frames:
            picture = camera.take(pose(world, rng), rng)
            label = labels(world, picture)
            if not label.any() and rng.random() > EMPTY_SHARE:
                continue
            images[done], truth[done] = picture.rgb, label
            done += 1
        print(f"{split} {done}/{count}  {time.monotonic() - started:.0f} s", flush=True)


def main() -> None:
    """Render all splits."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("frames", type=Path)
    options = parser.parse_args()
    options.frames.mkdir(parents=True, exist_ok=True)
    for split in SPLITS:
        render(split, options.frames)
    card = {
        "names": NAMES,
        "size": SIZE,
        "splits": {
            k: {"layout_seeds": [a, a + n], "texture_seeds": [b, b + n], "frames": n * m}
            for k, (a, b, n, m) in SPLITS.items()
        },
    }
    (options.frames / "frames.json").write_text(json.dumps(card, indent=1) + "\n")


if __name__ == "__main__":
    main()
