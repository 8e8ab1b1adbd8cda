"""``situgraph synth``: synthetic layouts and partial S-Graphs of them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.console import console, emit_json, print_table
from situgraph.cli.options import json_option, output_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.plan.sampler_config import SamplerConfig
    from situgraph.scenegraph.graph import SceneGraph

KINDS = ("random", "modular", "grid", "wings", "corridor", "lshaped", "storeys")
# option -> field of SamplerConfig, the option's unit in that of the field, and what it says
NOISE = {
    "wall-noise": ("plane_offset_sigma", 1.0, "Noise of wall offsets, m."),
    "angle-noise": ("plane_yaw_sigma", math.pi / 180.0, "Noise of wall directions, deg."),
    "tilt-noise": ("plane_tilt_sigma", math.pi / 180.0, "Noise of wall tilts, deg."),
    "extent-noise": ("extent_sigma", 1.0, "Noise of wall ends, m."),
    "center-noise": ("center_sigma", 1.0, "Noise of room centres, m."),
    "object-noise": ("object_sigma", 1.0, "Noise of object centres, m."),
    "missing-planes": ("missing_planes", 1.0, "Share of planes not seen."),
    "false-rooms": ("false_rooms", 1.0, "Rooms that do not exist, for one that does."),
    "moved-walls": ("moved_walls", 1.0, "Share of walls not built where planned."),
    "moved-min": ("moved_min", 1.0, "Least offset of a moved wall, m."),
    "moved-max": ("moved_max", 1.0, "Largest offset of a moved wall, m."),
    "drift": ("drift", math.pi / 180.0 / 50.0, "Heading drift, deg in 50 m."),
}
RATES = {
    "missed": "Share of objects not found.",
    "false": "False objects for one real object.",
    "duplicated": "Share found twice.",
    "confused": "Share found under another category's name.",
    "wrong-wall": "Share related to a wrong wall.",
}


def _rates(ctx: Any, param: Any, values: tuple[str, ...]) -> list[tuple[str, float]]:
    """Each ``RATE`` or ``CATEGORY=RATE`` as category ('' for all) and rate."""
    found = []
    for value in values:
        category, _, number = value.rpartition("=")
        if re.fullmatch(r"\d{0,3}(\d\.?|\.\d{1,9})", number) is None:
            raise click.BadParameter(f"{value!r} is no rate; give e.g. 0.05 or door=0.05")
        found.append((category, float(number)))
    return found


def _shape(ctx: Any, param: Any, value: str | None) -> tuple[int, int] | None:
    if value is None:
        return None
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", value)
    if found is None:
        raise click.BadParameter("give columns and rows, e.g. 4x3")
    return int(found[1]), int(found[2])


def _noise_options(function: Any) -> Any:
    for name, help_text in reversed(RATES.items()):
        metavar = "[CATEGORY=]RATE"
        function = click.option(
            f"--{name}", multiple=True, callback=_rates, metavar=metavar, help=help_text
        )(function)
    for name, (_, _, help_text) in reversed(NOISE.items()):
        function = click.option(f"--{name}", type=click.FloatRange(min=0.0), help=help_text)(
            function
        )
    return function


@click.command()
@click.option(
    "--kind", type=click.Choice(KINDS), default="random", show_default=True, help="Kind of layout."
)
@click.option("--rooms", type=int, default=12, show_default=True, help="Rooms of the layout.")
@click.option("--storeys", type=int, help="Repeat one floor plan on so many storeys.")
@click.option("--shape", callback=_shape, metavar="CxR", help="Columns and rows of a grid.")
@click.option(
    "--symmetry",
    type=click.Choice(["none", "local", "global"]),
    default="none",
    show_default=True,
    help="Same objects in every room, or a layout that is its own half turn.",
)
@click.option("--density", type=float, help="Share of objects among all nodes, 0 to 0.9.")
@click.option("--six-rooms", type=int, metavar="N", help="The embedded building's first N rooms.")
@click.option(
    "--plan", type=click.Path(path_type=Path), metavar="FILE", help="Sample this plan instead."
)
@click.option(
    "--break", "broken", type=click.Choice(["object", "wall"]), help="Break the symmetry by one."
)
@click.option("--mirror", is_flag=True, help="Turn the plan into its mirror image.")
@click.option("--see", type=int, metavar="N", help="Sample an S-Graph of N rooms.")
@click.option("--start", metavar="ROOM", help="Room to start from.")
@click.option(
    "--noise",
    type=click.Choice(["none", "realistic"]),
    default="none",
    show_default=True,
    help="Where noise and errors start from; the options below change it.",
)
@_noise_options
@output_option("Write prior.json, and online.json and truth.json of a sample, to a new folder.")
@click.option("--ifc", is_flag=True, help="Write the plan as prior.ifc, too.")
@seed_option
@settings_options
@json_option
def command(
    kind: Any,
    rooms: int,
    storeys: int | None,
    shape: tuple[int, int] | None,
    symmetry: Any,
    density: float | None,
    six_rooms: int | None,
    plan: Path | None,
    broken: Any,
    mirror: bool,
    see: int | None,
    start: str | None,
    noise: str,
    output: Path | None,
    ifc: bool,
    seed: int,
    settings: Settings,
    as_json: bool,
    **errors: Any,
) -> None:
    """Make a synthetic layout, and of it, or of any plan, the S-Graph of a partial view.

    Everything follows from --seed. Without -o only the summary is printed.
    """
    from situgraph.plan.layout_changes import break_symmetry
    from situgraph.plan.sampler import Sampler
    from situgraph.plan.synthesis import Synthesis
    from situgraph.scenegraph.mirror import mirrored

    if see is None and (start is not None or noise != "none" or any(map(_given, errors.values()))):
        raise click.UsageError("noise, errors and --start are those of a sample: add --see N")
    if plan is not None and six_rooms is not None:
        raise click.UsageError("give --plan or --six-rooms, not both")
    if plan is not None:
        from situgraph.api import load_prior

        prior = load_prior(plan, plan=settings.plan)
    elif six_rooms is not None:
        from situgraph.plan.six_rooms import six_rooms as building

        prior = building(six_rooms)
    else:
        from situgraph.plan.layouts import make_layout

        prior = make_layout(kind, rooms, seed, symmetry, density, storeys=storeys, shape=shape)
    if broken is not None:
        prior = break_symmetry(prior, seed, broken)
    prior = mirrored(prior) if mirror else prior
    sample = None
    if see is not None:
        sample = Sampler(prior, _sampler_config(noise, errors)).sample(see, seed, start)
    made = Synthesis(prior, sample)
    files = [] if output is None else made.save(output, ifc=ifc)
    summary = made.summary() | {"files": [str(f) for f in files]}
    if as_json:
        emit_json(summary)
    else:
        _show(summary, prior)


def _given(value: object) -> bool:
    return value is not None and value != []


def _sampler_config(noise: str, errors: dict[str, Any]) -> SamplerConfig:
    """The record that the options describe.

    Raises:
        InputError: a value its field does not allow.
    """
    import msgspec

    from situgraph.errors import InputError
    from situgraph.plan.sampler_config import CLEAN, REALISTIC, DetectionRates, SamplerConfig

    record = msgspec.to_builtins(REALISTIC if noise == "realistic" else CLEAN)
    for name, (field, unit, _) in NOISE.items():
        value = errors[name.replace("-", "_")]
        if value is not None:
            record[field] = value * unit
    everywhere: dict[str, float] = {}
    single: dict[str, dict[str, float]] = {}
    for name in RATES:
        field = name.replace("-", "_")
        pairs: Sequence[tuple[str, float]] = errors[field]
        for category, rate in pairs:
            (single.setdefault(category, {}) if category else everywhere)[field] = rate
    record["detection_default"] |= everywhere
    record["detection"] = {c: everywhere | rates for c, rates in single.items()}
    try:
        for rates in record["detection"].values():
            msgspec.convert(rates, DetectionRates)
        return msgspec.convert(record, SamplerConfig)
    except msgspec.ValidationError as error:
        raise InputError("synth", str(error), "see situgraph synth --help") from error


def _show(summary: dict[str, Any], prior: SceneGraph) -> None:
    counted = ("storeys", "rooms", "planes", "objects", "object_density")
    rows = [(part, *(summary[part][c] for c in counted)) for part in ("prior", "online")
            if part in summary]  # fmt: skip
    print_table(prior.name or "plan", ("graph", *counted), rows)
    if "truth" in summary:
        truth = dict(summary["truth"])
        at = truth.pop("placement")
        truth["placement"] = (
            f"{at['x']:.2f}, {at['y']:.2f}, {at['z']:.2f} m, {math.degrees(at['yaw']):.1f} deg"
        )
        print_table("truth about the sample", ("", ""), list(truth.items()))
    for file in summary["files"]:
        console().print(file, markup=False, soft_wrap=True)
