"""Synthetic layouts: the paper's 'Synthetic dataset', and kinds of buildings beyond it."""

from __future__ import annotations

import typing

import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement
from situgraph.plan.contacts import Contacts, Faces, find_contacts
from situgraph.plan.floor import Floor, inner_corners, inner_faces
from situgraph.plan.layout_config import Kind, LayoutConfig, Symmetry
from situgraph.plan.layout_floors import draw_floor
from situgraph.plan.layout_graph import build_graph, random_frame
from situgraph.plan.layout_items import Items, all_of
from situgraph.plan.layout_objects import arrangement, draw_others, thinned
from situgraph.plan.layout_openings import draw_openings
from situgraph.plan.layout_storeys import Storeys
from situgraph.plan.layout_symmetry import HalfTurn, half_turn_of
from situgraph.scenegraph.graph import SceneGraph

Rng = np.random.Generator

MAX_ROOMS = 1_000_000
MAX_DENSITY = 0.9


def make_layout(
    kind: Kind = "random",
    rooms: int = 12,
    seed: int = 0,
    symmetry: Symmetry = "none",
    object_density: float | None = None,
    *,
    storeys: int | None = None,
    shape: tuple[int, int] | None = None,
    frame: Placement | None = None,
    config: LayoutConfig | None = None,
) -> SceneGraph:
    """A synthetic building as a prior graph (paper, 'Synthetic dataset').

    ``object_density`` is the share of objects among all nodes (rooms, planes, objects), 0 to 0.9,
    reached within rounding; None furnishes the building naturally. ``symmetry``: 'local' gives
    every room the same arrangement of objects, which also maps onto itself by the room's half
    turn; 'global' makes geometry and objects map onto themselves by a half turn of the layout.
    ``storeys`` (default 1; up to 3 for the kind 'storeys') repeats one floor plan; a last storey
    may have fewer rooms. ``shape`` (columns, rows) is for the kind 'grid'. ``frame`` places the
    layout's centre in the building frame; None draws yaw and position.

    Each room side is one plane with its normal into the room; footprints run counter-clockwise.
    Raises InputError for a request that cannot be met.
    """
    config = config or LayoutConfig()
    _check(kind, rooms, symmetry, object_density, storeys, shape)
    rng = np.random.default_rng(seed)
    levels = _levels(kind, rooms, symmetry, storeys)
    per_floor = -(-rooms // levels)
    frame = frame or random_frame(config, rng)
    floor = draw_floor(kind, per_floor, config, rng, symmetry == "global", shape)
    faces = inner_faces(floor, inner_corners(floor))
    stack = Storeys(levels, rooms, floor.count, len(faces.room), config.storey_height)
    contacts = find_contacts(faces, 2.0 * config.thickness_max, 0.3)
    if symmetry == "local":
        items = _same_everywhere(floor, faces, stack, object_density, config, rng)
    else:
        turn = half_turn_of(floor, faces.start, faces) if symmetry == "global" else None
        items = _furnished(floor, faces, contacts, stack, turn, object_density, config, rng)
    name = f"{kind} layout, {rooms} rooms, symmetry {symmetry}, seed {seed}"
    return build_graph(floor, faces, items, rooms, levels, config, frame, name)


def _furnished(
    floor: Floor,
    faces: Faces,
    contacts: Contacts,
    stack: Storeys,
    turn: HalfTurn | None,
    density: float | None,
    config: LayoutConfig,
    rng: Rng,
) -> Items:
    """Openings and other objects of all storeys; with ``turn``, in pairs of images."""
    share = 1 if turn is None else 2
    openings = draw_openings(faces, contacts, floor.thickness, config, rng)
    openings = turn.canonical(openings) if turn else openings
    both = all_of([openings, turn.image(openings)]) if turn else openings
    fixed = all_of([stack.repeated(openings), stack.stairs(floor, faces, turn, rng)])
    others = round(config.others_per_room * stack.rooms / share)
    nodes = stack.rooms + stack.planes(floor)
    wanted = fixed.count + others
    if density is not None:
        wanted = round(density / (1.0 - density) * nodes / share)
        others = max(others, wanted - fixed.count)
    parts = [fixed]
    for level, number in enumerate(stack.split(others)):
        drawn = draw_others(
            number, stack.seen(faces, level), both, rng, turn.fold if turn else None
        )
        parts.append(stack.raised(drawn, level))
    items = all_of(parts)
    items = thinned(items, min(wanted, items.count), rng)
    return all_of([items, stack.image(items, turn)]) if turn else items


def _same_everywhere(
    floor: Floor,
    faces: Faces,
    stack: Storeys,
    density: float | None,
    config: LayoutConfig,
    rng: Rng,
) -> Items:
    """Local symmetry on all storeys; the density is met within one object a room."""
    count = round(config.others_per_room) + 3
    if density is not None:
        nodes = stack.rooms + stack.planes(floor)
        rectangular = max(1, stack.rectangular(floor))
        count = round(density / (1.0 - density) * nodes / rectangular)
    return stack.repeated(arrangement(count, faces, rng))


def _levels(kind: Kind, rooms: int, symmetry: Symmetry, storeys: int | None) -> int:
    if storeys is None and kind == "storeys":
        fitting = [k for k in (3, 2, 4, 5, 1) if symmetry != "global" or rooms % k == 0]
        storeys = fitting[0]
    levels = min(storeys or 1, rooms)
    per_floor = -(-rooms // levels)
    return -(-rooms // per_floor)


def _check(
    kind: Kind,
    rooms: int,
    symmetry: Symmetry,
    density: float | None,
    storeys: int | None,
    shape: tuple[int, int] | None,
) -> None:
    where = "layout"
    if kind not in typing.get_args(Kind):
        raise InputError(where, f"no kind {kind!r}", f"choose one of {typing.get_args(Kind)}")
    if symmetry not in typing.get_args(Symmetry):
        raise InputError(
            where, f"no symmetry {symmetry!r}", f"choose one of {typing.get_args(Symmetry)}"
        )
    if not 1 <= rooms <= MAX_ROOMS:
        raise InputError(where, f"{rooms} rooms", f"ask for 1 to {MAX_ROOMS}")
    if density is not None and not 0.0 <= density <= MAX_DENSITY:
        raise InputError(where, f"object density {density}", f"it lies between 0 and {MAX_DENSITY}")
    if storeys is not None and not 1 <= storeys <= 200:
        raise InputError(where, f"{storeys} storeys", "ask for 1 to 200")
    if storeys is not None and symmetry == "global" and rooms % storeys:
        raise InputError(
            where,
            f"{rooms} rooms do not fill {storeys} equal storeys",
            "global symmetry needs a multiple",
        )
    if shape is not None and (kind != "grid" or shape[0] * shape[1] * (storeys or 1) != rooms):
        raise InputError(
            where,
            f"shape {shape} for {rooms} rooms",
            "columns x rows x storeys must give the rooms",
        )
