from __future__ import annotations

from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph, Storey
from situgraph.scenegraph.network import from_networkx, to_networkx


def small() -> SceneGraph:
    planes = (Plane("1", (1.0, 0.0, 0.0), 0.0), Plane("2", (0.0, 1.0, 0.0), 0.0))
    rooms = (Room("1", (1.0, 1.0, 1.0), ("1", "2"), "s"), Room("2", (-1.0, 1.0, 1.0), ("2",)))
    door = Object("1", "door", (0.0, 1.0, 1.0), rooms=("1", "2"), planes=("1",))
    return SceneGraph(name="x", storeys=(Storey("s"),), rooms=rooms, planes=planes, objects=(door,))


def test_there_and_back_is_the_same_graph() -> None:
    assert from_networkx(to_networkx(small())) == small()


def test_relations_are_edges() -> None:
    network = to_networkx(small())
    assert network.edges[("object", "1"), ("room", "2")]["relation"] == "in room"
    assert network.edges[("plane", "2"), ("room", "1")]["relation"] == "bounds"
    assert network.number_of_nodes() == 6


def test_a_removed_node_takes_its_relations_along() -> None:
    network = to_networkx(small())
    network.remove_node(("room", "2"))
    graph = from_networkx(network)
    assert [r.id for r in graph.rooms] == ["1"]
    assert graph.objects[0].rooms == ("1",)
