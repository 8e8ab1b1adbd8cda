"""Settings of the objects stage."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta


class ObjectsConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the objects stage."""

    pixel_step: Annotated[
        int,
        Meta(
            ge=1,
            le=8,
            description="every so-manieth pixel of depth and masks is used, both ways",
            extra={"unit": "px", "source": "docs/objects.md"},
        ),
    ] = 2
    max_depth_sigma: Annotated[
        float,
        Meta(
            gt=0,
            description="depth pixels noisier than this are not used",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.07
    depth_baseline: Annotated[
        float,
        Meta(
            gt=0,
            description="stereo baseline in sigma_z = z^2 s / (f b)",
            extra={"unit": "m", "source": "D435 data sheet"},
        ),
    ] = 0.05
    disparity_sigma: Annotated[
        float,
        Meta(
            gt=0,
            description="sub-pixel noise s in sigma_z = z^2 s / (f b)",
            extra={"unit": "px", "source": "FACTS: D435 depth"},
        ),
    ] = 0.08
    depth_step: Annotated[
        float,
        Meta(
            gt=0,
            description="a depth jump between neighbours over this share of the depth is an edge",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 0.05
    mask_erosion: Annotated[
        int,
        Meta(
            ge=0,
            description="mask border that is not trusted (in the image as it came)",
            extra={"unit": "px", "source": "docs/objects.md"},
        ),
    ] = 2
    ring_width: Annotated[
        int,
        Meta(
            gt=0,
            description="width of the ring around a mask whose depth gives the wall behind glass",
            extra={"unit": "px", "source": "docs/objects.md"},
        ),
    ] = 8
    min_points: Annotated[
        int,
        Meta(
            gt=0,
            description="fewest voxels of a cluster",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 12
    voxel: Annotated[
        float,
        Meta(
            gt=0,
            description="voxel that thins the points of clusters and objects",
            extra={"unit": "m", "source": "FACTS: clustering"},
        ),
    ] = 0.05
    cluster_gap: Annotated[
        float,
        Meta(
            gt=0,
            description="points of one category farther apart than this are two objects",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.25
    ellipsoid_floor: Annotated[
        float,
        Meta(
            gt=0,
            description="thinnest semi-axis of an ellipsoid",
            extra={"unit": "m", "source": "FACTS: ellipsoids"},
        ),
    ] = 0.05
    stray_share: Annotated[
        float,
        Meta(
            ge=0,
            lt=0.5,
            description="share of a cluster's farthest points left out of its ellipsoid",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 0.02
    min_seen_roomless: Annotated[
        int,
        Meta(
            ge=1,
            description="the same for a door or window where no room is known",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 5
    merge_reach: Annotated[
        float,
        Meta(
            ge=0,
            description="ellipsoids of things that stand free are grown by this when compared",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.1
    core_share: Annotated[
        float,
        Meta(
            ge=0,
            lt=1,
            description="points seen in fewer frames than this share of the most seen are left out",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 0.2
    min_seen: Annotated[
        int,
        Meta(
            ge=1,
            description="frames that must have shown an object before it is given out",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 2
    max_object_points: Annotated[
        int,
        Meta(
            gt=0,
            description="most points kept for one object",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 4000
    min_confidence: Annotated[
        float,
        Meta(
            ge=0,
            le=1,
            description="objects below this confidence stay out of the scene graph",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 0.4
    visibility_margin: Annotated[
        float,
        Meta(
            ge=0,
            lt=1,
            description="share of the ray from room centre to object behind a wall that is allowed",
            extra={"unit": "1", "source": "paper, 'Objects in rooms' (epsilon)"},
        ),
    ] = 0.1
    wall_distance: Annotated[
        float,
        Meta(
            gt=0,
            description="farthest a wall-mounted object's centre may be from its wall face",
            extra={"unit": "m", "source": "paper, 'Objects on wall planes' (tau)"},
        ),
    ] = 0.3
    wall_thickness: Annotated[
        float,
        Meta(
            gt=0,
            description="thickest wall whose two faces share a door",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.6
    opening_gap: Annotated[
        float,
        Meta(
            gt=0,
            description="openings in one wall with as much wall between them are two",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.2
    opening_overlap: Annotated[
        float,
        Meta(
            gt=0,
            le=1,
            description="openings that share this much of the narrower one are the same",
            extra={"unit": "1", "source": "docs/objects.md"},
        ),
    ] = 0.3
    opening_width: Annotated[
        float,
        Meta(
            gt=0,
            description="what is seen of a door or window must be at least this wide and high",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.35
    frame_width: Annotated[
        float,
        Meta(
            gt=0,
            description="pieces of doors in one wall that fit in this width are one frame",
            extra={"unit": "m", "source": "usual door with its frame"},
        ),
    ] = 1.2
    door_widest: Annotated[
        float,
        Meta(
            gt=0,
            description="what is wider than this is two doors, if it can be parted",
            extra={"unit": "m", "source": "usual double door"},
        ),
    ] = 2.2
    door_sill: Annotated[
        float,
        Meta(
            gt=0,
            description="what begins higher over the floor than this is no door",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.9
    extent_margin: Annotated[
        float,
        Meta(
            ge=0,
            description="how far past the seen end of a face an object may still hang on it",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.5
    storey_height: Annotated[
        float,
        Meta(
            gt=0,
            description="height of a storey that does not tell its own",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 3.0
    doorway_width: Annotated[
        float,
        Meta(
            gt=0,
            description="width of a doorway known from the trajectory alone",
            extra={"unit": "m", "source": "usual door leaf"},
        ),
    ] = 0.9
    doorway_height: Annotated[
        float,
        Meta(
            gt=0,
            description="height of a doorway known from the trajectory alone",
            extra={"unit": "m", "source": "usual door leaf"},
        ),
    ] = 2.1
    doorway_merge: Annotated[
        float,
        Meta(
            gt=0,
            description="two doorways of one wall closer than this are one",
            extra={"unit": "m", "source": "docs/objects.md"},
        ),
    ] = 0.8
