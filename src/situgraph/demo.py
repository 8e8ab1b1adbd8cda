"""The quick demo: a building model, a view of a few of its rooms, and where the robot must be.

The building is the embedded one, authored as IFC and read back like any other, or the user's own.
What the robot sees is sampled; the truth is used only to say whether the answers are right. The
whole system, sensors included, is in ``demo_drive``.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, Placement, wrap_angle

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.matching import MatchResult, PlanIndex
    from situgraph.plan.sample_truth import OnlineSample
    from situgraph.plan.sampler_config import SamplerConfig
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.view.report import Report

Policy = Literal["none", "containment", "likelihood"]
POLICIES: tuple[Policy, ...] = ("none", "containment", "likelihood")
NAMES = {
    "none": "walls alone",
    "containment": "objects, the paper's filter",
    "likelihood": "objects by likelihood",
}
# How near an answer must be to the truth to count as right (DESIGN section 1, 'candidate').
RIGHT_DISTANCE = 0.3  # m
RIGHT_ANGLE = math.radians(10.0)


class Answer(msgspec.Struct, frozen=True):
    """One match: its verdict, how many solutions, the probability of the best, how long it took.

    ``right`` says of a unique answer whether it is the truth, of an ambiguous one whether the
    truth is among its solutions; None where there is no solution. ``reason`` is the match's.
    """

    semantics: str
    verdict: str
    solutions: int
    probability: float | None
    milliseconds: float
    right: bool | None
    reason: str


class Step(msgspec.Struct, frozen=True):
    """The answers after so many rooms."""

    rooms: int
    objects: int
    answers: tuple[Answer, ...]


class Demo(msgspec.Struct, frozen=True):
    """What the demo did; the report shows the match after ``shown`` rooms by ``shown_policy``."""

    building: str
    rooms: int
    planes: int
    objects: int
    shown: int
    shown_policy: str
    steps: tuple[Step, ...]
    seconds: dict[str, float]
    files: tuple[str, ...]


def run_demo(
    folder: str | os.PathLike[str],
    settings: Settings,
    *,
    plan: str | os.PathLike[str] | None = None,
    seed: int = 0,
    rooms: int = 6,
    advance: Callable[[str], object] = lambda stage: None,
) -> Demo:
    """Run the demo and leave its files in ``folder``: graphs, match, pictures and ``report.html``.

    Args:
        folder: made where it does not exist; files of an earlier demo in it are replaced.
        settings: those of all stages.
        plan: a building model of the user's; None authors the embedded six-room building.
        seed: where the robot starts, where it goes, and its noise.
        rooms: how many rooms it sees at most.
        advance: told the name of each stage when it is done.

    Raises:
        InputError: the plan cannot be read or has no rooms, or the folder cannot be written.
    """
    from situgraph.plan.sampler import Sampler

    clock = _Clock(advance)
    target = Path(folder)
    source = Path(plan) if plan is not None else authored(target)
    clock.done("building")
    prior = read_rooms(source, settings)
    clock.done("plan")
    whole = Sampler(prior, _noise()).sample(min(rooms, len(prior.rooms)), seed)
    clock.done("sample")
    index, seen = _prepared(prior, whole, settings)
    clock.done("index")
    steps, results = [], []
    for count in range(1, len(whole.truth.order) + 1):
        part = seen(count)
        found = [_match(part.online, index, policy) for policy in POLICIES]
        results.append((part, found))
        steps.append(_step(part, found))
    clock.done("match")
    shown, policy = telling(steps)
    part, found = results[shown - 1]
    chosen = found[POLICIES.index(policy)]
    files = _saved(target, prior, part, (found[0], chosen), steps, clock.seconds, settings)
    clock.done("report")
    written = [source.name] if plan is None else []
    return Demo(
        building=prior.name or source.stem,
        rooms=len(prior.rooms),
        planes=len(prior.planes),
        objects=len(prior.objects),
        shown=shown,
        shown_policy=policy,
        steps=tuple(steps),
        seconds=clock.seconds,
        files=tuple(str(target / name) for name in (*written, *files)),
    )


STAGES = ("building", "plan", "sample", "index", "match", "report")


class _Clock:
    """Seconds by stage."""

    def __init__(self, advance: Callable[[str], object]) -> None:
        import time

        self._now = time.perf_counter
        self._last = self._now()
        self._advance = advance
        self.seconds: dict[str, float] = {}

    def done(self, stage: str) -> None:
        now = self._now()
        self.seconds[stage] = now - self._last
        self._last = now
        self._advance(stage)


def _noise() -> SamplerConfig:
    """A careful robot: realistic noise, the paper's detector, walls where they were planned."""
    from situgraph.plan.sampler_config import PAPER_DETECTOR, REALISTIC

    return msgspec.structs.replace(
        REALISTIC, missing_planes=0.05, false_rooms=0.0, moved_walls=0.0, detection=PAPER_DETECTOR
    )


def authored(folder: Path) -> Path:
    """The embedded building as an IFC file in ``folder``."""
    from situgraph.plan.ifc_writer import write_ifc
    from situgraph.plan.six_rooms import six_rooms

    return write_ifc(six_rooms(), folder / "six-rooms.ifc")


def read_rooms(source: Path, settings: Settings) -> SceneGraph:
    """The plan in a file.

    Raises:
        InputError: it cannot be read or has no rooms.
    """
    from situgraph.api import read_plan
    from situgraph.errors import InputError

    prior = read_plan(source, settings.plan)
    if not prior.rooms:
        raise InputError(source, "has no rooms", "choose a plan with rooms")
    return prior


def _prepared(
    prior: SceneGraph, whole: OnlineSample, settings: Settings
) -> tuple[PlanIndex, Callable[[int], OnlineSample]]:
    """The index, after a match of each kind that is not timed: compiled code is loaded there."""
    from situgraph.matching import PlanIndex
    from situgraph.plan.sample_prefix import first_rooms

    index = PlanIndex(prior, settings.matching)
    for policy in POLICIES:
        _match(whole.online, index, policy)
    return index, lambda count: first_rooms(whole, prior, count)


def _match(online: SceneGraph, index: PlanIndex, policy: Policy) -> MatchResult:
    from situgraph.matching import match

    return match(online, index, semantics=policy)


def _step(part: OnlineSample, found: list[MatchResult]) -> Step:
    online = part.online
    center = np.mean([online.room_by_id[r].center for r in part.truth.order], axis=0)
    answers = answers_of(found, part.truth.placement, center)
    return Step(len(part.truth.order), len(online.objects), answers)


def answers_of(found: Sequence[MatchResult], truth: Placement, center: Array) -> tuple[Answer, ...]:
    """What the policies answered, and whether it is right at ``center`` (3,) of the map."""
    answers = []
    for policy, result in zip(POLICIES, found):
        best = result.best
        near = [_near(s.transform, truth, center) for s in result.solutions]
        answers.append(
            Answer(
                semantics=policy,
                verdict=result.verdict,
                solutions=result.count,
                probability=None if best is None else float(best.probability),
                milliseconds=1e3 * float(result.stats["seconds"]["total"]),
                right=any(near) if near else None,
                reason=result.reason,
            )
        )
    return tuple(answers)


def _near(found: Placement, true: Placement, center: Array) -> bool:
    away = float(np.linalg.norm(found.points(center[:2]) - true.points(center[:2])))
    turn = abs(float(wrap_angle(found.yaw - true.yaw)))
    return away <= RIGHT_DISTANCE and turn <= RIGHT_ANGLE


def telling(steps: list[Step]) -> tuple[int, Policy]:
    """Rooms and policy to show: the first unique answer that walls alone did not give.

    Of two policies at one step the likelihood is shown; without any such answer, its last one.
    """
    for step in steps:
        walls, *others = step.answers
        for answer, policy in zip(reversed(others), reversed(POLICIES)):
            if answer.verdict == "unique" and walls.verdict != "unique":
                return step.rooms, policy
    return steps[-1].rooms, POLICIES[-1]


def _saved(
    folder: Path,
    prior: SceneGraph,
    part: OnlineSample,
    found: tuple[MatchResult, MatchResult],
    steps: list[Step],
    seconds: dict[str, float],
    settings: Settings,
) -> list[str]:
    """Write graphs, match, pictures and report; give their names."""
    from situgraph.scenegraph.codec import write_json
    from situgraph.scenegraph.files import write_atomic
    from situgraph.view import draw_match, draw_rivals, match_report, save_figure

    view = settings.view
    count = len(part.truth.order)
    online = part.online.replace(name="One room" if count == 1 else f"{count} rooms")
    walls, objects = (r.to_dict() for r in found)
    write_json(prior, folder / "prior.json")
    write_json(online, folder / "online.json")
    document = objects | {"online": "online.json", "prior": "prior.json"}
    write_atomic(
        folder / "match.json", msgspec.json.format(msgspec.json.encode(document), indent=1)
    )

    def story(report: Report) -> None:
        told = report.section("Room by room")
        told.text(
            "The same walk, matched after each room: with walls alone, with objects by the "
            "paper's filter, and with objects by their likelihood. Numbers in brackets count the "
            "placements that fit. What the robot saw was sampled from the plan, with noise."
        )
        told.table(*table_of(steps))
        if walls["count"] > 1:
            other = report.section("The same view without objects")
            other.text(str(walls["reason"]))
            other.picture(draw_rivals(walls, online, prior, view, heading=False))

    write = save_figure(draw_match(objects, online, prior, view), folder / "match.png", view.dpi)
    names = ["prior.json", "online.json", "match.json", write.name]
    if walls["count"] > 1:
        rivals = draw_rivals(walls, online, prior, view)
        names.append(save_figure(rivals, folder / "walls-alone.png", view.dpi).name)
    match_report(
        objects, online, prior, folder / "report.html", timings=seconds, sections=[story],
        config=view,
    )  # fmt: skip
    return [*names, "report.html"]


def refusals(steps: Sequence[Step]) -> str:
    """Why the paper's filter let nothing pass where it first did so; nothing where it never did."""
    for step in steps:
        for answer in step.answers:
            if answer.semantics == "containment" and answer.verdict == "none":
                return (
                    "The paper's filter takes an object that the plan lacks, or has fewer of, as "
                    "proof against a room, so one false detection is enough to refuse the true "
                    f"one. With {step.rooms} of the rooms: {answer.reason}."
                )
    return ""


def table_of(steps: list[Step] | tuple[Step, ...]) -> tuple[list[str], list[list[Any]]]:
    """Columns and rows of the story, for people."""
    columns = ["rooms", "objects", *(NAMES[p] for p in POLICIES)]
    rows = []
    for step in steps:
        row: list[Any] = [step.rooms, step.objects]
        for answer in step.answers:
            many = f" ({answer.solutions})" if answer.solutions > 1 else ""
            wrong = ", WRONG" if answer.right is False else ""
            row.append(f"{answer.verdict}{many}{wrong}, {answer.milliseconds:.1f} ms")
        rows.append(row)
    return columns, rows
