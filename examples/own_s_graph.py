"""Another system's scene graph: place it in the plan, couple both, tell what was built differently.

The other system is made up here: rooms as rectangles in its own frame, a door or two. Whatever
yours gives, write it as a `SceneGraph` (docs/graph-format.md); normals point into the rooms.
"""

from __future__ import annotations

import math
from pathlib import Path

import situgraph as sg
from situgraph.coupling import locate, pairs_of, write_bcf
from situgraph.geometry.planes import from_footprint
from situgraph.scenegraph.graph import Object, Plane, Room
from situgraph.scenegraph.transform import transformed

Box = tuple[float, float, float, float]  # x0, y0, x1, y1 in metres


def graph(kind: str, boxes: list[Box], doors: list[tuple[float, float, str, str]]) -> sg.SceneGraph:
    """Rooms r0, r1 ...; the planes of r0 are p0s, p0e, p0n, p0w. A door names its two planes."""
    rooms, planes = [], []
    for number, (x0, y0, x1, y1) in enumerate(boxes):
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        normals, offsets = from_footprint(corners)
        for k, side in enumerate("senw"):
            n, ends = normals[k], (corners[k], corners[(k + 1) % 4])
            normal = (float(n[0]), float(n[1]), 0.0)
            planes.append(Plane(f"p{number}{side}", normal, float(offsets[k]), ends))
        center = ((x0 + x1) / 2, (y0 + y1) / 2, 1.3)
        ids = tuple(p.id for p in planes[-4:])
        rooms.append(Room(f"r{number}", center, ids, footprint=tuple(corners)))
    objects = tuple(
        Object(f"o{i}", "door", (x, y, 1.0), rooms=(f"r{a[1]}", f"r{b[1]}"), planes=(a, b))
        for i, (x, y, a, b) in enumerate(doors)
    )
    return sg.SceneGraph(
        kind=kind,  # type: ignore[arg-type]
        rooms=tuple(rooms),
        planes=tuple(planes),
        objects=objects,
    )


planned = [(0.0, 0.0, 4.0, 3.0), (4.2, 0.0, 9.2, 3.0), (0.0, 3.2, 4.0, 8.2)]
doors = [(4.1, 1.0, "p0e", "p1w"), (2.0, 3.1, "p0n", "p2s")]
plan = graph("prior", planned, doors)

# As built, the far wall of the second room stands 12 cm farther out than planned.
built = graph("online", [*planned[:1], (4.2, 0.0, 9.32, 3.0), *planned[2:]], doors)
map_in_building = sg.Placement(x=1.0, y=2.0, yaw=math.radians(30))
seen = transformed(built, map_in_building.inverse())

result = sg.match(seen, plan)
print(f"{result.verdict}: {result.reason}")
if result.unique and result.best is not None:
    located = locate(seen, plan, pairs_of(result.best))
    place = located.placement
    yaw = math.degrees(place.yaw)
    print(f"map to building: x {place.x:.3f} m, y {place.y:.3f} m, yaw {yaw:.2f} deg")
    for deviation in located.deviations:
        print(f"{deviation.kind}: {deviation.message}")
    issues = write_bcf(located.deviations, plan, Path("deviations.bcfzip"))
    print(f"issues for a BIM viewer: {issues.name}")
