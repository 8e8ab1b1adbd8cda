"""Following references between IFC entities without trusting that they lead anywhere.

A damaged file may name nothing, or an entity of another kind, in any place. What is missing or
wrong is None, or left out of a list.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

MAX_DEPTH = 20  # levels of aggregation followed; more is a loop


def one(entity: Any, name: str) -> Any | None:
    """The entity that an attribute refers to, or None."""
    found = getattr(entity, name, None)
    return found if hasattr(found, "is_a") else None


def many(entity: Any, name: str) -> tuple[Any, ...]:
    """The entities that a list attribute or an inverse refers to."""
    found = getattr(entity, name, None)
    if not isinstance(found, tuple | list):
        return ()
    return tuple(item for item in found if hasattr(item, "is_a"))


def products(model: Any, *classes: str) -> Iterator[Any]:
    """Entities of these classes and their subclasses, each once, in file order class by class."""
    seen = set()
    for name in classes:
        try:
            found = model.by_type(name)
        except RuntimeError:  # a class this schema does not have
            continue
        for entity in sorted(found, key=lambda e: int(e.id())):
            if entity.id() not in seen:
                seen.add(entity.id())
                yield entity


def has_body(entity: Any) -> bool:
    """Whether a product has a shape of its own."""
    return bool(many(one(entity, "Representation"), "Representations"))


def parent(entity: Any) -> Any | None:
    """The whole that an entity is part of."""
    for relation in many(entity, "Decomposes"):
        return one(relation, "RelatingObject")
    return None


def hole(filling: Any) -> Any | None:
    """The opening that a door or window fills, if it has a body."""
    for relation in many(filling, "FillsVoids"):
        opening = one(relation, "RelatingOpeningElement")
        return opening if opening is not None and has_body(opening) else None
    return None


def host(opening: Any) -> Any | None:
    """The wall or slab that an opening is in."""
    for relation in many(opening, "VoidsElements"):
        return one(relation, "RelatingBuildingElement")
    return None


def level(entity: Any) -> int | None:
    """The number of the storey an entity stands in, through aggregates, holes and hosts."""
    at: Any | None = entity
    for _ in range(MAX_DEPTH):
        if at is None:
            return None
        if at.is_a("IfcBuildingStorey"):
            return int(at.id())
        inside = many(at, "ContainedInStructure")
        at = one(inside[0], "RelatingStructure") if inside else parent(at) or _voided(at)
    return None


def _voided(entity: Any) -> Any | None:
    if entity.is_a("IfcOpeningElement"):
        return host(entity)
    for relation in many(entity, "FillsVoids"):
        return one(relation, "RelatingOpeningElement")
    return None


def roots(entities: Iterable[Any]) -> list[Any]:
    """Those that are no part of another of them: a flight belongs to its stair."""
    found = list(entities)
    ids = {e.id() for e in found}
    return [e for e in found if (p := parent(e)) is None or p.id() not in ids]


def leaves(spaces: Iterable[Any]) -> list[Any]:
    """Spaces that are not made of other spaces: a flat's outline is no room beside its rooms."""
    found = list(spaces)
    whole = {p.id() for e in found if has_body(e) and (p := parent(e)) is not None}
    return [e for e in found if e.id() not in whole]


def parts(entity: Any) -> list[Any]:
    """What an aggregate without a body of its own is made of; doors are not part of the wall."""
    if has_body(entity):
        return []
    out: list[Any] = []
    queue, seen = [entity], {entity.id()}
    while queue:
        for relation in many(queue.pop(0), "IsDecomposedBy"):
            for part in many(relation, "RelatedObjects"):
                if part.id() in seen or not part.is_a("IfcElement"):
                    continue
                seen.add(part.id())
                queue.append(part)
                if not part.is_a("IfcDoor") and not part.is_a("IfcWindow"):
                    out.append(part)
    return out
