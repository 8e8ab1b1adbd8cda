"""What a run leaves behind: graph, trajectory, match, settings, log and pictures in one folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.pipeline import Pipeline
    from situgraph.run import Run
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.view.report import Report


def save_run(
    folder: str | Path,
    run: Run,
    pipeline: Pipeline,
    settings: Settings,
    plan: SceneGraph | None = None,
    sections: Sequence[Callable[[Report], object]] = (),
) -> tuple[str, ...]:
    """Write everything into ``folder``, files of an earlier run replaced; returns the names.

    ``online.json`` (S-Graph in the map frame), ``trajectory.tum``, ``run.json``, ``settings.yaml``,
    ``log.txt``, ``map.png``; with a plan ``prior.json``, ``match.json``, ``history.png`` and
    ``report.html``; where a match is adopted also what ``run_building.save_located`` writes.
    ``sections`` add to the report, each called with it.

    Raises:
        InputError: the folder cannot be written to.
    """
    from situgraph.config import to_yaml
    from situgraph.io.tum import write_tum
    from situgraph.scenegraph.codec import write_json
    from situgraph.scenegraph.files import write_atomic
    from situgraph.view import draw_graph, save_figure

    target = Path(folder)
    graph = pipeline.graph.replace(name=run.log)
    stamps, poses = pipeline.slam.trajectory()
    write_json(graph, target / "online.json")
    write_tum(target / "trajectory.tum", stamps, poses)
    write_atomic(target / "settings.yaml", to_yaml(settings).encode())
    log = "".join(f"{w.code}: {w.message}\n" for w in run.warnings)
    write_atomic(target / "log.txt", log.encode())
    write_atomic(target / "run.json", msgspec.json.format(msgspec.json.encode(run), indent=1))
    save_figure(draw_graph(graph, settings.view), target / "map.png", settings.view.dpi)
    names = ["online.json", "trajectory.tum", "settings.yaml", "log.txt", "run.json", "map.png"]
    if plan is not None and pipeline.result is not None:
        names += _save_match(target, run, pipeline, settings, graph, plan, sections)
    return tuple(names)


def _save_match(
    target: Path,
    run: Run,
    pipeline: Pipeline,
    settings: Settings,
    graph: SceneGraph,
    plan: SceneGraph,
    sections: Sequence[Callable[[Report], object]],
) -> list[str]:
    from situgraph.run_building import save_located, tell_located
    from situgraph.scenegraph.codec import write_json
    from situgraph.scenegraph.files import write_atomic
    from situgraph.view import Status, draw_history, draw_match, match_report, save_figure

    result, view = pipeline.result, settings.view
    assert result is not None
    document = result.to_dict() | {"online": "online.json", "prior": "prior.json"}
    write_json(plan, target / "prior.json")
    text = msgspec.json.format(msgspec.json.encode(document), indent=1)
    write_atomic(target / "match.json", text)
    history = [
        Status(s.stamp, s.rooms, s.objects, s.solutions or 0, s.verdict or "")
        for s in pipeline.history
    ]
    figures: dict[str, Callable[[], object]] = {
        "match.png": lambda: draw_match(document, graph, plan, view),
        "history.png": lambda: draw_history(history),
    }
    names = ["prior.json", "match.json", "report.html"]
    if pipeline.located is not None:
        names += save_located(target, run, pipeline, settings, plan)
    for name, draw in figures.items():
        save_figure(draw(), target / name, view.dpi)  # type: ignore[arg-type]
    match_report(
        document,
        graph,
        plan,
        target / "report.html",
        sections=[*sections, lambda report: tell_located(report, run, pipeline, plan, settings)],
        config=view,
    )
    return [*names, *figures]
