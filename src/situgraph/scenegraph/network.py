"""Scene graphs as networkx graphs and back, for users who want graph algorithms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from situgraph.errors import InputError
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.validation import validate

if TYPE_CHECKING:
    import networkx as nx

KINDS = ("storey", "room", "plane", "object", "keyframe")


def to_networkx(graph: SceneGraph) -> nx.Graph[Any]:
    """An undirected graph whose nodes are ``(kind, id)`` with the record as ``data``.

    Edges carry ``relation``: ``storey`` (storey-room), ``bounds`` (plane-room), ``in room`` and
    ``on plane``. The graph's own fields stand in ``graph.graph["scene"]``.
    """
    import networkx as nx

    out: nx.Graph[Any] = nx.Graph()
    out.graph["scene"] = graph.replace(storeys=(), rooms=(), planes=(), objects=(), keyframes=())
    for kind in KINDS:
        for order, node in enumerate(getattr(graph, f"{kind}s")):
            out.add_node((kind, node.id), kind=kind, data=node, order=order)
    for room in graph.rooms:
        if room.storey is not None:
            out.add_edge(("storey", room.storey), ("room", room.id), relation="storey")
        for plane in room.planes:
            out.add_edge(("plane", plane), ("room", room.id), relation="bounds")
    for item in graph.objects:
        for key in item.rooms:
            out.add_edge(("object", item.id), ("room", key), relation="in room")
        for key in item.planes:
            out.add_edge(("object", item.id), ("plane", key), relation="on plane")
    return out


def from_networkx(source: nx.Graph[Any]) -> SceneGraph:
    """The scene graph that ``to_networkx`` wrote; nodes removed since take their relations along.

    Raises:
        InputError: a node lacks ``kind`` or ``data``, or the result is not a valid scene graph.
    """
    found: dict[str, list[tuple[int, Any]]] = {kind: [] for kind in KINDS}
    for key, attributes in source.nodes(data=True):
        kind, data = attributes.get("kind"), attributes.get("data")
        if kind not in found or data is None:
            raise InputError(
                "networkx graph", f"node {key!r} has no kind or data", "use to_networkx"
            )
        found[kind].append((attributes.get("order", len(found[kind])), data))
    nodes = {k: [n for _, n in sorted(v, key=lambda item: item[0])] for k, v in found.items()}
    rooms = {r.id for r in nodes["room"]}
    planes = {p.id for p in nodes["plane"]}
    storeys = {s.id for s in nodes["storey"]}
    import msgspec

    change = msgspec.structs.replace
    graph: SceneGraph = source.graph.get("scene", SceneGraph())
    return validate(
        graph.replace(
            storeys=tuple(nodes["storey"]),
            planes=tuple(nodes["plane"]),
            keyframes=tuple(nodes["keyframe"]),
            rooms=tuple(
                change(
                    r,
                    planes=tuple(p for p in r.planes if p in planes),
                    storey=r.storey if r.storey in storeys else None,
                )
                for r in nodes["room"]
            ),
            objects=tuple(
                change(
                    o,
                    rooms=tuple(r for r in o.rooms if r in rooms),
                    planes=tuple(p for p in o.planes if p in planes),
                )
                for o in nodes["object"]
            ),
        ),
        "networkx graph",
    )
