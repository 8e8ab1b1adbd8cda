from __future__ import annotations

import numpy as np

from situgraph.objects.cloud import labelled_clouds, max_range
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.detections import Camera, Detection

CAMERA = Camera(386.0, 386.0, 319.5, 239.5)
CONFIG = ObjectsConfig()


def wall(distance: float = 2.0) -> np.ndarray:
    return np.full((480, 640), distance, dtype=np.float32)


def rectangle(top: int, bottom: int, left: int, right: int) -> np.ndarray:
    mask = np.zeros((480, 640), dtype=bool)
    mask[top:bottom, left:right] = True
    return mask


def test_points_of_a_door_on_a_wall_in_front() -> None:
    door = Detection(rectangle(100, 400, 250, 350), "door", 0.9)
    (cloud,) = labelled_clouds(wall(), CAMERA, [door], CONFIG)
    assert np.allclose(cloud.points[:, 2], 2.0)
    assert abs(np.ptp(cloud.points[:, 0]) - 2.0 * 99 / 386) < 0.05
    assert abs(np.ptp(cloud.points[:, 1]) - 2.0 * 299 / 386) < 0.05


def test_glass_takes_the_plane_of_the_wall_around_it() -> None:
    mask = rectangle(150, 300, 200, 400)
    depth = wall()
    depth[mask] = 0.0
    depth[200:220, 220:260] = 4.0  # something behind the glass
    (cloud,) = labelled_clouds(depth, CAMERA, [Detection(mask, "window", 0.8)], CONFIG)
    assert np.allclose(cloud.points[:, 2], 2.0, atol=0.01)
    assert len(cloud.points) > 5_000  # of 7500 pixels that are looked at


def test_a_picture_on_a_wall_is_no_window() -> None:
    mask = rectangle(150, 300, 200, 400)
    depth = wall()
    picture = Detection(mask, "window", 0.8)
    assert labelled_clouds(depth, CAMERA, [picture], CONFIG) == []
    depth[150:280, 200:400] = 4.0  # what shows through the glass
    assert len(labelled_clouds(depth, CAMERA, [picture], CONFIG)) == 1
    depth[150:200, 200:400] = 2.0  # a blind, half down
    depth[200:300, 200:400] = 0.0
    assert len(labelled_clouds(depth, CAMERA, [picture], CONFIG)) == 1


def test_far_pixels_and_depth_edges_are_not_used() -> None:
    depth = wall(max_range(CAMERA, CONFIG) + 0.1)
    mask = rectangle(100, 400, 250, 350)
    assert labelled_clouds(depth, CAMERA, [Detection(mask, "door", 0.9)], CONFIG) == []
    depth = wall()
    depth[:, 300:] = 3.0
    (cloud,) = labelled_clouds(depth, CAMERA, [Detection(mask, "door", 0.9)], CONFIG)
    u = cloud.points[:, 0] / cloud.points[:, 2] * CAMERA.fx + CAMERA.cx
    assert np.all((u < 299) | (u > 300))


def test_an_empty_mask_and_a_blind_depth_image_give_nothing() -> None:
    empty = Detection(np.zeros((480, 640), dtype=bool), "door", 0.9)
    blind = Detection(rectangle(100, 400, 250, 350), "window", 0.9)
    assert labelled_clouds(wall(), CAMERA, [empty], CONFIG) == []
    assert labelled_clouds(wall(0.0), CAMERA, [blind], CONFIG) == []
    nan = np.full((480, 640), np.nan, dtype=np.float32)
    assert labelled_clouds(nan, CAMERA, [blind], CONFIG) == []


def test_the_wall_that_shows_through_a_doorway_is_not_of_the_door() -> None:
    depth = wall(3.9)  # the next room, seen between the jambs
    for left in (200, 400):
        depth[:, left : left + 40] = 1.5
    (cloud,) = labelled_clouds(
        depth, CAMERA, [Detection(rectangle(40, 440, 200, 440), "door", 0.9)], CONFIG
    )
    assert cloud.points[:, 2].max() < 1.6
    assert np.ptp(cloud.points[:, 0]) > 0.8  # both jambs


def test_the_parts_of_a_mask_that_do_not_touch_are_each_what_they_are() -> None:
    depth = wall(1.5)
    depth[:, 320:] = 3.9
    mask = rectangle(100, 300, 100, 200) | rectangle(100, 300, 400, 500)
    (cloud,) = labelled_clouds(depth, CAMERA, [Detection(mask, "door", 0.9)], CONFIG)
    assert set(np.round(cloud.points[:, 2], 1)) == {1.5, 3.9}


def test_a_window_is_not_in_what_stands_before_a_far_wall() -> None:
    depth = wall(6.0)  # farther than depth is used
    depth[:, :200] = 2.0  # stairs at its side
    mask = rectangle(150, 300, 200, 400)
    depth[mask] = 0.0
    assert labelled_clouds(depth, CAMERA, [Detection(mask, "window", 0.9)], CONFIG) == []
    depth[depth == 6.0] = 3.0  # near enough: then it is in the wall behind
    (cloud,) = labelled_clouds(depth, CAMERA, [Detection(mask, "window", 0.9)], CONFIG)
    assert np.allclose(cloud.points[:, 2], 3.0, atol=0.02)
