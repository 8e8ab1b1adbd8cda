"""Experiment ``matching``: the paper's figure, and the evidence that the matcher is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from situgraph.experiments import certificate, exactness, paper_figure
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment

# What each size computes; any of them may be given as an extra parameter.
SIZES = {
    "layouts": (2, 10),
    "growth": (15, 100),
    "oracle_cases": (200, 5_000),
    "trials": (2_000, 22_000),  # of 22,000 more than 20,000 are admissible
    "astray": (1_000, 12_000),  # of them 9,900 are admissible
    "beyond": (1_000, 10_000),
    "pairs": (200, 200),
    "share": (100, 500),
}
SOLVERS: Mapping[str, Callable[[Mapping[str, Any]], dict[str, Any]]] = {
    "figure": paper_figure.solve_figure,
    "growth": paper_figure.solve_growth,
    "oracle": exactness.solve_oracle,
    "grid": exactness.solve_grid,
    "trial": certificate.solve_trial,
    "foreign": certificate.solve_cross,
    "mirrored": certificate.solve_cross,
    "foreign_large": certificate.solve_cross,
    "mirrored_large": certificate.solve_cross,
    "share": certificate.solve_share,
}
SUMMARIES: Mapping[str, Callable[[list[dict[str, Any]]], dict[str, Any]]] = {
    "figure": paper_figure.summarise_figure,
    "growth": paper_figure.summarise_growth,
    "oracle": exactness.summarise_oracle,
    "grid": exactness.summarise_grids,
    "trial": certificate.summarise_trials,
    "foreign": certificate.summarise_cross,
    "mirrored": certificate.summarise_cross,
    "foreign_large": certificate.summarise_cross,
    "mirrored_large": certificate.summarise_cross,
    "share": certificate.summarise_share,
}


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the figures.

    Extra parameters: ``layouts``, ``growth``, ``oracle_cases``, ``trials``, ``astray``, ``beyond``,
    ``pairs``, ``share``.
    """
    size = {
        name: int(options.extra.get(name, sizes[options.full])) for name, sizes in SIZES.items()
    }
    seed = options.seed
    answers = brute_force(seed, size["oracle_cases"], options) if size["oracle_cases"] else []
    tasks = [
        *paper_figure.figure_tasks(seed, size["layouts"]),
        *paper_figure.growth_tasks(seed, size["growth"]),
        *exactness.grid_tasks(options.full),
        *exactness.oracle_tasks(answers),
        *certificate.trial_tasks(seed, size["trials"], "covered"),
        *certificate.trial_tasks(seed, size["astray"], "astray"),
        *certificate.trial_tasks(seed, size["beyond"], "beyond"),
        *certificate.cross_tasks(seed, size["pairs"]),
        *certificate.share_tasks(seed, size["share"]),
    ]
    experiment = Experiment("matching", tasks, solve, summarise, seed, revision=2)
    result = run_experiment(experiment, options)
    if options.folder is not None:
        draw(result, options.folder)
    return result


def brute_force(seed: int, cases: int, options: RunOptions) -> list[dict[str, Any]]:
    """The brute force's answers, kept apart: a change of the search does not ask for them anew."""
    tasks = list(exactness.brute_force_tasks(seed, cases))
    experiment = Experiment(
        "brute-force", tasks, exactness.solve_brute_force, lambda rows: {}, seed
    )
    return run_experiment(experiment, options).rows


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One row of whatever part the task belongs to."""
    return SOLVERS[task["part"]](task)


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The summaries of all parts; parts that were not run are left out."""
    summary: dict[str, Any] = {}
    for part, summarise_part in SUMMARIES.items():
        mine = [r for r in rows if r["part"] == part]
        if mine:
            summary |= summarise_part(mine)
    return summary


def draw(result: ExperimentResult, folder: Path) -> None:
    """The paper's surfaces and the reliability diagram."""
    from situgraph.view.experiments import draw_reliability
    from situgraph.view.surfaces import Surface, draw_surfaces

    rows = [r for r in result.rows if r["part"] == "figure"]
    surfaces = [
        Surface(x, y, z, x_name, y_name, z, log_z=True)
        for z in ("solutions", "ms")
        for x, y, x_name, y_name in (
            ("seen", "planned", "S-rooms", "A-rooms"),
            ("ratio", "object_share", "S/A ratio", "objects among nodes"),
        )
    ]
    title = "Solutions and time of a match"
    draw_surfaces(rows, surfaces, "semantics", "symmetry", title=title).savefig(
        folder / "surfaces.png", dpi=150
    )
    said = certificate.statements([r for r in result.rows if r["part"] == "trial"])
    draw_reliability(said, "probability", "right", title="Probability of a solution").savefig(
        folder / "reliability.png", dpi=150
    )
