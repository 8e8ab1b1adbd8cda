"""Settings of the objects stage."""

from __future__ import annotations

from typing import Annotated

import msgspec

from situgraph.setting import setting


class ObjectsConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the objects stage."""

    pixel_step: Annotated[
        int,
        setting(
            "every so-manieth pixel of depth and masks is used, both ways",
            "px",
            "docs/objects.md",
            ge=1,
            le=8,
        ),
    ] = 2
    max_depth_sigma: Annotated[
        float,
        setting("depth pixels noisier than this are not used", "m", "docs/objects.md", gt=0),
    ] = 0.07
    depth_baseline: Annotated[
        float,
        setting("stereo baseline in sigma_z = z^2 s / (f b)", "m", "D435 data sheet", gt=0),
    ] = 0.05
    disparity_sigma: Annotated[
        float,
        setting("sub-pixel noise s in sigma_z = z^2 s / (f b)", "px", "FACTS: D435 depth", gt=0),
    ] = 0.08
    depth_step: Annotated[
        float,
        setting(
            "a depth jump between neighbours over this share of the depth is an edge",
            "1",
            "docs/objects.md",
            gt=0,
        ),
    ] = 0.05
    mask_erosion: Annotated[
        int,
        setting(
            "mask border that is not trusted (in the image as it came)",
            "px",
            "docs/objects.md",
            ge=0,
        ),
    ] = 2
    ring_width: Annotated[
        int,
        setting(
            "width of the ring around a mask whose depth gives the wall behind glass",
            "px",
            "docs/objects.md",
            gt=0,
        ),
    ] = 8
    glass_share: Annotated[
        float,
        setting(
            "a window with less of its image without depth, or with depth behind its wall, is none",
            "1",
            "docs/objects.md",
            ge=0,
            le=1,
        ),
    ] = 0.4
    min_points: Annotated[
        int,
        setting("fewest voxels of a cluster", "1", "docs/objects.md", gt=0),
    ] = 12
    voxel: Annotated[
        float,
        setting(
            "voxel that thins the points of clusters and objects", "m", "FACTS: clustering", gt=0
        ),
    ] = 0.05
    cluster_gap: Annotated[
        float,
        setting(
            "points of one category farther apart than this are two objects",
            "m",
            "docs/objects.md",
            gt=0,
        ),
    ] = 0.25
    ellipsoid_floor: Annotated[
        float,
        setting("thinnest semi-axis of an ellipsoid", "m", "FACTS: ellipsoids", gt=0),
    ] = 0.05
    stray_share: Annotated[
        float,
        setting(
            "share of a cluster's farthest points left out of its ellipsoid",
            "1",
            "docs/objects.md",
            ge=0,
            lt=0.5,
        ),
    ] = 0.02
    min_seen_roomless: Annotated[
        int,
        setting(
            "the same for a door or window where no room is known", "1", "docs/objects.md", ge=1
        ),
    ] = 4
    merge_reach: Annotated[
        float,
        setting(
            "ellipsoids of things that stand free are grown by this when compared",
            "m",
            "docs/objects.md",
            ge=0,
        ),
    ] = 0.1
    core_share: Annotated[
        float,
        setting(
            "points seen in fewer frames than this share of the most seen are left out",
            "1",
            "docs/objects.md",
            ge=0,
            lt=1,
        ),
    ] = 0.2
    min_seen: Annotated[
        int,
        setting(
            "frames that must have shown an object before it is given out",
            "1",
            "docs/objects.md",
            ge=1,
        ),
    ] = 2
    max_object_points: Annotated[
        int,
        setting("most points kept for one object", "1", "docs/objects.md", gt=0),
    ] = 4000
    min_confidence: Annotated[
        float,
        setting(
            "objects below this confidence stay out of the scene graph",
            "1",
            "docs/objects.md",
            ge=0,
            le=1,
        ),
    ] = 0.4
    forget_confidence: Annotated[
        float,
        setting("objects below this confidence are forgotten", "1", "docs/objects.md", ge=0, le=1),
    ] = 0.15
    max_unsure: Annotated[
        int,
        setting(
            "most objects kept that are not sure enough to be given out",
            "1",
            "docs/objects.md",
            ge=1,
        ),
    ] = 300
    visibility_margin: Annotated[
        float,
        setting(
            "share of the ray from room centre to object behind a wall that is allowed",
            "1",
            "paper, 'Objects in rooms' (epsilon)",
            ge=0,
            lt=1,
        ),
    ] = 0.1
    wall_distance: Annotated[
        float,
        setting(
            "farthest a wall-mounted object's centre may be from its wall face",
            "m",
            "paper, 'Objects on wall planes' (tau)",
            gt=0,
        ),
    ] = 0.3
    stands_out: Annotated[
        float,
        setting(
            "a radiator, sink or extinguisher nearer to its wall's face is a picture of one",
            "m",
            "half of what a flat radiator stands out",
            ge=0,
        ),
    ] = 0.05
    wall_thickness: Annotated[
        float,
        setting("thickest wall whose two faces share a door", "m", "docs/objects.md", gt=0),
    ] = 0.6
    opening_gap: Annotated[
        float,
        setting(
            "openings in one wall with as much wall between them are two",
            "m",
            "docs/objects.md",
            gt=0,
        ),
    ] = 0.2
    opening_overlap: Annotated[
        float,
        setting(
            "openings that share this much of the narrower one are the same",
            "1",
            "docs/objects.md",
            gt=0,
            le=1,
        ),
    ] = 0.3
    opening_width: Annotated[
        float,
        setting(
            "what is seen of a door or window must be at least this wide and high",
            "m",
            "docs/objects.md",
            gt=0,
        ),
    ] = 0.35
    frame_width: Annotated[
        float,
        setting(
            "pieces of doors in one wall that fit in this width are one frame",
            "m",
            "usual door with its frame",
            gt=0,
        ),
    ] = 1.2
    door_widest: Annotated[
        float,
        setting(
            "what is wider than this is two doors, if it can be parted",
            "m",
            "usual double door",
            gt=0,
        ),
    ] = 2.2
    door_confidence: Annotated[
        float,
        setting(
            "the same for a door where the LiDAR saw no gap and the robot did not pass",
            "1",
            "docs/objects.md",
            ge=0,
            le=1,
        ),
    ] = 0.57
    door_narrowest: Annotated[
        float,
        setting(
            "what is narrower than this is part of a door: its opening is looked for",
            "m",
            "usual door leaf",
            gt=0,
        ),
    ] = 0.55
    door_highest: Annotated[
        float,
        setting("what reaches higher over the floor is no door", "m", "usual door", gt=0),
    ] = 2.6
    opening_top: Annotated[
        float,
        setting(
            "a door or window reaches at least as high over the floor",
            "m",
            "usual window sill and door",
            ge=0,
        ),
    ] = 1.2
    door_sill: Annotated[
        float,
        setting(
            "what begins higher over the floor than this is no door", "m", "docs/objects.md", gt=0
        ),
    ] = 0.6
    extent_margin: Annotated[
        float,
        setting(
            "how far past the seen end of a face an object may still hang on it",
            "m",
            "docs/objects.md",
            ge=0,
        ),
    ] = 0.5
    storey_height: Annotated[
        float,
        setting("height of a storey that does not tell its own", "m", "docs/objects.md", gt=0),
    ] = 3.0
    doorway_width: Annotated[
        float,
        setting("width of a doorway known from the trajectory alone", "m", "usual door leaf", gt=0),
    ] = 0.9
    doorway_height: Annotated[
        float,
        setting(
            "height of a doorway known from the trajectory alone", "m", "usual door leaf", gt=0
        ),
    ] = 2.1
    doorway_merge: Annotated[
        float,
        setting("two doorways of one wall closer than this are one", "m", "docs/objects.md", gt=0),
    ] = 0.8
    doorway_not_passed: Annotated[
        float,
        setting(
            "without a camera, a door of a room that the robot was in is not passed",
            "1", "docs/slam.md", gt=0, lt=1,
        ),
    ] = 0.5  # fmt: skip
