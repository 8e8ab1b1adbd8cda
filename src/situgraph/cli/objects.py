"""``situgraph objects``: what a camera with known poses saw, without LiDAR and SLAM."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from situgraph.cli.options import json_option, output_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.objects.posed import Looked


@click.command()
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--rooms",
    type=click.Path(path_type=Path),
    metavar="GRAPH",
    help="Scene graph with rooms and planes in the frame of the poses, for relations.",
)
@click.option(
    "--detector",
    default="network",
    show_default=True,
    metavar="NAME",
    help="network, oracle (simulated logs only), or an ONNX file.",
)
@click.option("--classes", metavar="MAP", help="Class map of the ONNX file: ade20k, coco, a YAML.")
@output_option("Scene graph with the objects [default: LOG's name with -objects.json].")
@seed_option
@settings_options
@json_option
def command(
    log: Path,
    rooms: Path | None,
    detector: str,
    classes: str | None,
    output: Path | None,
    seed: int,
    settings: Settings,
    as_json: bool,
) -> None:
    """Place the objects of an RGB-D folder in TUM layout, or of any recording with poses."""
    from situgraph.cli.console import emit_json
    from situgraph.scenegraph.codec import to_dict, write_json

    found = _looked(log, rooms, detector, classes, seed, settings)
    target = output or Path(f"{log.resolve().name}-objects.json")
    write_json(found.graph, target)
    if as_json:
        emit_json(to_dict(found.graph))
        return
    _show(found, target)


def _looked(
    log: Path, rooms: Path | None, detector: str, classes: str | None, seed: int, settings: Settings
) -> Looked:
    from dataclasses import replace

    import numpy as np

    from situgraph.detectors import make_detector
    from situgraph.errors import InputError
    from situgraph.geometry.poses import pose_to_matrix
    from situgraph.io.recording import Frame, Odometry, Stream, open_recording
    from situgraph.objects.panoptic import OnnxPanopticDetector
    from situgraph.objects.posed import look
    from situgraph.objects.stage import ObjectStage
    from situgraph.scenegraph.codec import read_json

    sees = (
        make_detector(detector, log, seed=seed)
        if classes is None
        else OnnxPanopticDetector(detector, classes)
    )
    if sees is None:
        raise InputError("--detector none", "sees nothing", "name a detector")
    recording = open_recording(log)
    if recording.info.base_T_camera is None or not recording.info.counts.get("frames"):
        raise InputError(log, "has no images", "give a recording with an RGB-D camera")
    poses_only: tuple[Stream, ...] = ("odometry",)
    images_only: tuple[Stream, ...] = ("frames",)
    odometry = [m for m in recording.messages(poses_only) if isinstance(m, Odometry)]
    poses = np.array([m.pose for m in odometry]).reshape(-1, 7)
    found = look(
        log,
        (m for m in recording.messages(images_only) if isinstance(m, Frame)),
        np.array([m.stamp for m in odometry]),
        poses,
        pose_to_matrix(recording.info.base_T_camera),
        ObjectStage(sees, settings.objects),
        None if rooms is None else read_json(rooms),
    )
    kept = {w.code for w in found.warnings}
    more = tuple(w for w in recording.warnings if w.code not in kept)
    graph = found.graph.replace(name=recording.info.name)
    return replace(found, graph=graph, warnings=(*found.warnings, *more))


def _show(found: Looked, target: Path) -> None:
    from situgraph.cli.console import console, print_table

    rows = [
        (
            item.id, item.category, ", ".join(f"{v:.2f}" for v in item.center),
            f"{item.confidence or 0.0:.2f}", " ".join(item.rooms), " ".join(item.planes),
        )
        for item in found.graph.objects
    ]  # fmt: skip
    title = f"{len(rows)} objects in {found.used} of {found.images} images"
    print_table(title, ("id", "category", "place (m)", "confidence", "rooms", "planes"), rows)
    for warning in found.warnings:
        console().print(f"warning: {warning.code}: {warning.message}", markup=False, soft_wrap=True)
    console().print(f"written: {target}", markup=False, soft_wrap=True)
