"""What grows while a world is built: triangles, the parts they belong to, their looks."""

from __future__ import annotations

import msgspec

from situgraph.sim.looks import Looks, Material
from situgraph.sim.mesh import MeshBuilder


class Part(msgspec.Struct, frozen=True):
    """What an id image's number means: part ``name`` of a thing of ``category``.

    ``object`` is the id of the object it belongs to in the graph of the driven world, ``plane``
    that of a wall's face; None where there is none. Number 0 is nothing (the sky).
    """

    id: int
    category: str
    name: str
    object: str | None = None
    plane: str | None = None
    room: str | None = None


class Site:
    """Collects triangles and parts; part i has id i and looks like material i."""

    def __init__(self, looks: Looks) -> None:
        self.mesh = MeshBuilder()
        self.looks = looks
        self.parts = [Part(0, "nothing", "sky")]
        self.materials = [Material(0, (0.7, 0.8, 0.95), 1.0, 0.0, 0.0)]

    def part(
        self,
        category: str,
        name: str,
        owner: str | None = None,
        plane: str | None = None,
        room: str | None = None,
        look: Material | None = None,
    ) -> int:
        """A new part's number; its look is drawn by ``name`` unless given."""
        number = len(self.parts)
        self.parts.append(Part(number, category, name, owner, plane, room))
        self.materials.append(look or self.looks.draw(name))
        return number
