"""The object-semantic relation generator, whole: camera frames in, objects with relations out."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.objects.association import ObjectMap, Track
from situgraph.objects.cloud import labelled_clouds, max_range
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.detections import Detector
from situgraph.objects.doorways import DOORWAY, doorways
from situgraph.objects.gaps import WallGap, in_walls, supported
from situgraph.objects.looks import MOST_LOOKS, Look, View
from situgraph.objects.openings import Openings, Seen, openings, stands
from situgraph.objects.reconcile import backed, reconciled, without_leaves
from situgraph.objects.relations import TWO_SIDED, RoomView, flat, relate, room_of, room_views
from situgraph.scenegraph.graph import Object, SceneGraph, Warning

TRACE = 0.2  # m; what was seen so near beside a place is of a thing there
NAMED = 3  # of the things that are left out for one reason are named in its sentence

__all__ = ["ObjectStage", "View"]


class ObjectStage:
    """Detects, places and keeps objects over a drive; relations are found when asked for."""

    def __init__(self, detector: Detector | None, config: ObjectsConfig | None = None) -> None:
        """``detector`` None: no camera; doorways from the trajectory are still found."""
        self.detector = detector
        self.config = config or ObjectsConfig()
        self.map = ObjectMap(self.config)
        self._looks: deque[Look] = deque(maxlen=MOST_LOOKS)
        #: What the last graph leaves out although it was seen repeatedly, and why.
        self.left_out: tuple[Warning, ...] = ()

    def feed(self, view: View) -> int:
        """Take in a frame; the number of objects it showed."""
        if self.detector is None:
            return 0
        detections = self.detector.detect(view.rgb, view.stamp)
        clouds = labelled_clouds(view.depth, view.camera, detections, self.config)
        turn, shift = view.keyframe_T_camera[:3, :3], view.keyframe_T_camera[:3, 3]
        parts: dict[str, list[tuple[float, Array]]] = {}
        for cloud in clouds:
            parts.setdefault(cloud.category, []).append(
                (cloud.score, cloud.points @ turn.T + shift)
            )
        self._looks.append(Look.of(view, max_range(view.camera, self.config)))
        expected = self._expected(view)
        tracks = self.map.add(
            view.keyframe, view.pose, self.map.observations(parts), view.keyframe_T_camera[:3, 3]
        )
        self.map.expect(list(dict.fromkeys([*expected, *tracks])))
        return len(tracks)

    def correct(self, poses: Mapping[str, Array]) -> None:
        """Corrected poses (4, 4) of keyframes by id: the objects they saw move along."""
        self.map.correct(poses)

    def annotated(self, graph: SceneGraph, path: Array, gaps: Sequence[WallGap] = ()) -> SceneGraph:
        """The graph with all objects and doorways and their relations.

        ``path`` (n, 3): the robot's positions in the graph's frame so far; ``gaps``: where the
        LiDAR saw openings in walls. A door that the camera saw too seldom to be sure of is one
        where the robot passed; a gap makes no door (walls have shadows) but confirms one.
        """
        views = room_views(graph, self.config)
        found, free = self._placed(views, gaps)
        passages = in_walls(doorways(path, graph, self.config), gaps, graph, self.config)
        sure, weak = (
            [relate(o, views, self.config) for o in held] for held in (found.given, found.weak)
        )
        doors = backed(weak, sure, passages, graph, self.config)
        # Where no wall was seen there is no opening in it.
        seen = [o for o in (*sure, *doors) if o.planes]
        others = [relate(o, views, self.config, eye) for o, eye in free]
        painted = [o for o in others if flat(o, graph, self.config)]
        seen += [o for o in others if o not in painted]
        objects = without_leaves(reconciled(seen, passages, graph, self.config), graph)
        unsure = [o for o in weak if o not in doors and _seen(o) >= self.config.min_seen]
        self.left_out = (
            *_reason("object-unsure", "not seen as often as it should be", unsure),
            *_reason("object-flat", "flat in its wall, a picture of one", painted),
        )
        return graph.replace(
            objects=supported(objects, gaps, graph, self.config),
            warnings=(*graph.warnings, *self.left_out),
            modelled_categories=tuple(sorted({DOORWAY, *self._able})),
        )

    @property
    def _able(self) -> Collection[str]:
        """What the camera can find; doorways are found without one, by the trajectory."""
        return () if self.detector is None else self.detector.categories

    def _placed(
        self, views: tuple[RoomView, ...], gaps: Sequence[WallGap]
    ) -> tuple[Openings, list[tuple[Object, Array]]]:
        """Doors and windows in their walls, whatever their confidence; and all other objects, each
        with the place (3,) that it was seen from.

        A door or window that lies in no wall of the room that holds it is none; where no room is
        known yet it stays as it was seen.
        """  # noqa: D205
        flat = [t for t in self.map.tracks if t.category in TWO_SIDED]
        found = openings([self._seen(t) for t in flat], views, self.config, gaps)
        lost = set(found.homeless)
        unknown = {
            t.number
            for t in flat
            if t.number in lost
            and t.seen >= self.config.min_seen_roomless
            and stands(t.shape, self.config)
            and room_of(t.center[None], views, 0.0)[0] is None
        }
        free = [
            (node, self.map.eye(track))
            for track, node in self.map.nodes()
            if track.category not in TWO_SIDED or track.number in unknown
        ]
        return found, free

    def _seen(self, track: Track) -> Seen:
        return Seen(
            track.number, track.category, self.map.points(track), track.hits,
            track.seen, track.expected, track.score, track.frames, track.due,
        )  # fmt: skip

    def _expected(self, view: View) -> list[Track]:
        """The known objects that this frame should show: in the image, in range, not hidden."""
        look = Look.of(view, max_range(view.camera, self.config))
        return [t for t in self.map.tracks if look.shows(t.center, view.depth)]

    def missed(self, category: str, place: Array, normal: Array, half: float) -> int:
        """How many images show a place in a wall and no trace of such an object was found there.

        A trace is what was seen twice of one, sure or not: it may have been hidden in part.

        Args:
            category: of the object.
            place: its middle (3,) in the map.
            normal: that of its wall (3,); images from aside, over 60 degrees off, do not count.
            half: half its width (m).
        """
        for track in self.map.tracks:
            if track.category == category and track.seen >= self.config.min_seen:
                apart = self.map.points(track)[:, :2] - place[:2]
                if float(np.linalg.norm(apart, axis=1).min()) <= half + TRACE:
                    return 0
        return sum(look.faces(place, normal) and look.shows(place) for look in self._looks)


def _seen(item: Object) -> int:
    """How many frames saw it."""
    return int(str(item.attributes.get("seen", 0)))


def _reason(code: str, why: str, items: Sequence[Object]) -> tuple[Warning, ...]:
    """Why these were left out; nothing where there are none."""
    if not items:
        return ()
    named = [f"{o.category} {o.id} (seen {_seen(o)} times)" for o in items[:NAMED]]
    more = f" and {len(items) - NAMED} more" if len(items) > NAMED else ""
    ids = tuple(o.id for o in items)
    return (Warning(code, f"left out, {why}: {', '.join(named)}{more}", ids),)
