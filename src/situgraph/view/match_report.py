"""The report of a match: where the robot is, how sure, and what speaks against it."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view.advice import draw_advice, spots
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.lettering import metres, number, percent, seconds
from situgraph.view.match import draw_match
from situgraph.view.plan import draw_graph
from situgraph.view.record import Match, MatchRecord, Solution, read_record
from situgraph.view.report import Report, Tone
from situgraph.view.rivals import draw_rivals
from situgraph.view.wording import difference

_VERDICTS: dict[str, tuple[str, Tone]] = {
    "unique": ("Located", "good"),
    "ambiguous": ("Ambiguous", "doubt"),
    "none": ("Not in this plan", "bad"),
}
_STAGES = {"type": "of the same type", "semantic": "after semantics", "geometric": "after geometry"}


def match_report(
    match: Match,
    online: SceneGraph,
    prior: SceneGraph,
    path: str | os.PathLike[str],
    *,
    timings: Mapping[str, float] | None = None,
    sections: Sequence[Callable[[Report], object]] = (),
    settings: Mapping[str, object] | None = None,
    config: ViewConfig = USUAL,
) -> Path:
    """Write a self-contained HTML report of a match and return its path.

    Args:
        match: a match result or its JSON as a dict (DESIGN.md section 3).
        online: the S-Graph that was matched, in its map frame.
        prior: the A-Graph.
        path: the HTML file.
        timings: seconds by stage.
        sections: further content; each is called with the report before warnings are added.
        settings: settings to list, by name.
        config: sizes and limits.

    Raises:
        InputError: ``match`` is no match JSON, or the file cannot be written.
    """
    return build_match_report(
        match, online, prior, timings=timings, sections=sections, settings=settings, config=config
    ).save(path)


def build_match_report(
    match: Match,
    online: SceneGraph,
    prior: SceneGraph,
    *,
    timings: Mapping[str, float] | None = None,
    sections: Sequence[Callable[[Report], object]] = (),
    settings: Mapping[str, object] | None = None,
    config: ViewConfig = USUAL,
) -> Report:
    """The report of ``match_report``, not yet written."""
    record, plan = read_record(match), survey(prior, config)
    names = (online.name or "online graph", prior.name or "plan")
    report = Report(f"{names[0]} in {names[1]}", "Where the robot is in the building", config)
    word, tone = _VERDICTS[record.verdict]
    report.banner(word, record.reason, tone)
    _facts(report, record, len(online.rooms))
    where = report.section("Where it is" if record.solutions else "What was seen, and the plan")
    where.picture(draw_match(record, online, plan, config, heading=False), _caption(record))
    if record.count > 1:
        _rivals(report, record, online, plan, config)
    if record.solutions and record.solutions[0].deviations:
        _deviations(report, record.solutions[0], prior)
    if record.solutions:
        _rooms(report, record.solutions[0], online, prior)
    _search(report, record, timings)
    for add in sections:
        add(report)
    graphs = report.section("The two graphs")
    for graph, what in ((online, "What was seen, in its own frame"), (plan, "The plan")):
        graphs.picture(draw_graph(graph, config, heading=False), what)
    report.warnings(online.warnings, "Warnings about what was seen")
    report.warnings(prior.warnings, "Warnings about the plan")
    if settings:
        report.settings(settings)
    return report


def _facts(report: Report, record: MatchRecord, rooms: int) -> None:
    if record.solutions:
        best = record.solutions[0]
        at = best.transform
        report.fact("rooms explained", f"{len(best.rooms)} of {rooms}")
        if best.probability is not None:
            report.fact("probability", percent(best.probability), "of the best placement")
        if best.rms is not None:
            report.fact("residual", metres(best.rms), "rms over the walls that fit")
        report.fact(
            "placement",
            f"{at.x:.2f}, {at.y:.2f} m",
            f"yaw {math.degrees(at.yaw):.1f}°, z {at.z:.2f} m",
        )
        if best.deviations:
            report.fact("moved walls", len(best.deviations))
    report.fact("placements that fit", number(record.count), "solutions")
    if record.probability_outside is not None:
        report.fact("outside the plan", percent(record.probability_outside), "probability")
    certificate = "complete search, within the model" if record.certified else ""
    report.fact("certified", record.certified, certificate)
    total = _seconds(record).get("total")
    if total is not None:
        report.fact("time", seconds(total), "of the match")


def _seconds(record: MatchRecord) -> dict[str, float]:
    found = record.stats.get("seconds")
    items = found.items() if isinstance(found, dict) else ()
    return {str(k): float(v) for k, v in items if isinstance(v, int | float)}


def _caption(record: MatchRecord) -> str:
    if not record.solutions:
        return "No placement explains what was seen; each graph is drawn in its own frame."
    text = "What was seen, in colour, laid over the plan, in grey"
    return (
        f"{text}: the most probable of {number(record.count)} placements."
        if record.count > 1
        else f"{text}."
    )


def _rivals(
    report: Report, record: MatchRecord, online: SceneGraph, plan: Building, config: ViewConfig
) -> None:
    section = report.section("Rival placements")
    section.picture(draw_rivals(record, online, plan, config, heading=False))
    best = record.solutions[0]
    rows = [
        (
            i + 1,
            None if s.probability is None else percent(s.probability),
            len(s.rooms),
            len(s.objects),
            len(s.deviations),
            "" if i == 0 else difference(best, s, online),
        )
        for i, s in enumerate(record.solutions)
    ]
    columns = ("", "probability", "rooms", "objects", "moved walls", "against the first")
    section.table(columns, rows)
    if spots(record.disambiguation, plan):
        advice = report.section("What to look for next")
        advice.text("Each of these observations would rule out some of the placements that fit.")
        advice.picture(draw_advice(record, online, plan, config, heading=False))
        found = spots(record.disambiguation, plan)
        advice.table(("", "look for"), [(s.number, s.sentence) for s in found])


def _deviations(report: Report, best: Solution, prior: SceneGraph) -> None:
    rows = []
    for d in sorted(best.deviations, key=lambda d: -abs(d.offset)):
        planned = best.planes.get(d.plane, "")
        rooms = ", ".join(
            prior.room_by_id[r].name or r for r in prior.rooms_by_plane.get(planned, ())
        )
        sigma = None if d.sigma is None else f"± {100.0 * d.sigma:.1f} cm"
        tilt = None if d.tilt is None else f"{math.degrees(d.tilt):.1f}°"
        rows.append((d.plane, planned, rooms, f"{100.0 * d.offset:+.0f} cm", sigma, tilt))
    section = report.section("Walls beside their planned place")
    section.text("Offsets are positive into the room that the planned face looks at.")
    section.table(("seen as", "planned as", "of room", "offset", "deviation", "tilt"), rows)


def _rooms(report: Report, best: Solution, online: SceneGraph, prior: SceneGraph) -> None:
    rows = []
    for room in online.rooms:
        planned = best.rooms.get(room.id)
        known = prior.room_by_id.get(planned or "")
        more = ", ".join(
            prior.room_by_id[r].name or r
            for r in best.also_covers.get(room.id, ())
            if r in prior.room_by_id
        )
        fits = sum(1 for p in room.planes if p in best.planes)
        items = online.objects_by_room.get(room.id, ())
        agree = sum(1 for o in items if o.id in best.objects)
        name = "not explained" if known is None else known.name or known.id
        rows.append(
            (
                room.name or room.id,
                name,
                more,
                f"{fits} of {len(room.planes)}",
                f"{agree} of {len(items)}",
            )
        )
    section = report.section("Rooms")
    section.table(("seen as", "in the plan", "also covers", "faces", "objects"), rows)


def _search(report: Report, record: MatchRecord, timings: Mapping[str, float] | None) -> None:
    section = report.section("How it was found")
    model = record.stats.get("model")
    if model:
        word = "The search is complete and certified" if record.certified else "The model is"
        section.text(f"{word}: {model}.")
    for key, what in (("room_candidates", "Room pairs"), ("plane_candidates", "Face pairs")):
        counts: Any = record.stats.get(key)
        if isinstance(counts, dict) and any(counts.values()):
            rows = [
                (_STAGES.get(str(k), str(k)), float(v), number(v))
                for k, v in counts.items()
                if isinstance(v, int | float)
            ]
            section.bars(rows, f"{what} still possible")
    stages = dict(timings) if timings else _seconds(record)
    if stages:
        section.timings(stages, "Time by stage")
