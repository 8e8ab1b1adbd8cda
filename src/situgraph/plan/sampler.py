"""Partial S-Graphs of a building: what a robot has seen after a few rooms, and the truth."""

from __future__ import annotations

import math

import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement, best_placement
from situgraph.plan.exploration import RoomLinks
from situgraph.plan.sample_draft import Draft, finished
from situgraph.plan.sample_false import add_false_rooms
from situgraph.plan.sample_motion import room_motions
from situgraph.plan.sample_objects import add_objects
from situgraph.plan.sample_prior import prior_arrays
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sample_walls import add_planes, add_rooms, see_planes
from situgraph.plan.sampler_config import CLEAN, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph

Rng = np.random.Generator


class Sampler:
    """Draws S-Graphs of one building; what does not change is computed once.

    Works on any prior graph: a layout, or the A-Graph of an IFC file.
    """

    def __init__(self, prior: SceneGraph, config: SamplerConfig = CLEAN) -> None:
        """Prepare for ``prior``.

        Raises:
            InputError: the prior has no rooms.
        """
        if not prior.rooms:
            raise InputError(prior.name or "prior graph", "it has no rooms", "sample another plan")
        self.config = config
        self.links = RoomLinks(prior)
        self.prior = prior_arrays(prior, self.links, config)
        self._row = {r.id: i for i, r in enumerate(prior.rooms)}

    def sample(self, rooms: int, seed: int = 0, start: str | None = None) -> OnlineSample:
        """An S-Graph of ``rooms`` rooms (all of them where the plan has fewer), and its truth.

        ``start`` names the prior room to start from; None draws it. The same seed gives the same
        sample. Online ids and their order say nothing about the prior's.

        Raises:
            InputError: fewer than one room asked for, or no such room to start from.
        """
        if rooms < 1:
            raise InputError("sample", f"{rooms} rooms asked for", "ask for at least one")
        if start is not None and start not in self._row:
            raise InputError(
                "sample", f"no room {start!r} to start from", "name a room of the plan"
            )
        prior, config = self.prior, self.config
        rng = np.random.default_rng(seed)
        walk = self.links.walk(rooms, rng, None if start is None else self._row[start])
        frame = self._frame(walk.order[0], rng)
        bend = config.drift * (1.0 if rng.random() < 0.5 else -1.0)
        motions = room_motions(frame, walk, prior.center, bend)
        placement = frame
        if bend:
            centers = motions.points(prior.center[walk.order, :2], np.arange(len(walk.order)))
            placement = best_placement(motions.placements(frame.z), centers, frame.z)

        draft = Draft()
        seen = see_planes(walk, prior, config, rng)
        index = add_planes(draft, seen, prior, motions, walk, frame.z, config, rng)
        add_rooms(draft, seen, index, prior, motions, walk, frame.z, config, rng)
        add_objects(draft, seen, index, prior, motions, walk, frame.z, config, rng)
        add_false_rooms(draft, config, rng)
        return finished(draft, prior.graph, walk, motions, frame, placement, rng)

    def _frame(self, room: int, rng: Rng) -> Placement:
        """The map frame in the building: any yaw, an origin somewhere about the first room."""
        reach, lift = self.config.translation_range, self.config.height_range
        x, y = self.prior.center[room, :2] + rng.uniform(-reach, reach, 2)
        z = self.prior.floor[room] + rng.uniform(-lift, lift)
        return Placement(float(x), float(y), float(z), float(rng.uniform(-math.pi, math.pi)))


def sample_online(
    prior: SceneGraph,
    rooms: int,
    seed: int = 0,
    config: SamplerConfig = CLEAN,
    start: str | None = None,
) -> OnlineSample:
    """One S-Graph of ``prior``; for several of one building, keep a ``Sampler``."""
    return Sampler(prior, config).sample(rooms, seed, start)
