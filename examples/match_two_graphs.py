"""Place a hand-made S-Graph of two rooms in a hand-made plan of three, and print where it lies."""

from __future__ import annotations

import math

import situgraph as sg
from situgraph.geometry.planes import from_footprint
from situgraph.scenegraph.graph import Plane, Room
from situgraph.scenegraph.transform import transformed


def graph(kind: str, *rectangles: tuple[float, float, float, float]) -> sg.SceneGraph:
    """Rooms from rectangles x0 y0 x1 y1 (m), each with four planes whose normals point inwards."""
    rooms, planes = [], []
    for number, (x0, y0, x1, y1) in enumerate(rectangles):
        normals, offsets = from_footprint([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        faces = [
            Plane(f"p{number}{side}", (float(nx), float(ny), 0.0), float(d))
            for side, (nx, ny), d in zip("swne", normals, offsets)
        ]
        center = ((x0 + x1) / 2, (y0 + y1) / 2, 1.3)
        rooms.append(Room(f"r{number}", center, tuple(face.id for face in faces)))
        planes += faces
    return sg.SceneGraph(kind=kind, rooms=tuple(rooms), planes=tuple(planes))  # type: ignore[arg-type]


plan = graph("prior", (0.0, 0.0, 4.0, 3.0), (4.2, 0.0, 9.2, 3.0), (0.0, 3.2, 4.0, 8.2))

# The robot saw the first two rooms; its map frame is turned and shifted against the building.
start = sg.Placement(x=1.0, y=2.0, yaw=math.radians(30))
seen = transformed(graph("online", (0.0, 0.0, 4.0, 3.0), (4.2, 0.0, 9.2, 3.0)), start.inverse())

index = sg.PlanIndex(plan)  # once for each building
result = sg.match(seen, index)

print(f"{result.verdict}: {result.reason}")
if result.best is not None:
    place = result.best.transform
    yaw = math.degrees(place.yaw)
    print(f"map to building: x {place.x:.2f} m, y {place.y:.2f} m, yaw {yaw:.1f} deg")
    print(f"rooms: {dict(result.best.rooms)}")
