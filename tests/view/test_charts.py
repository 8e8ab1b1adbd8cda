"""Charts of experiments and the pictures of a run."""

from __future__ import annotations

import numpy as np
import pytest
from defusedxml.ElementTree import fromstring
from hypothesis import given
from hypothesis import strategies as st
from tests.view.buildings import office
from tests.view.test_plan import texts

from situgraph.view import (
    Status,
    Surface,
    draw_history,
    draw_lines,
    draw_outcomes,
    draw_reliability,
    draw_scale,
    draw_surfaces,
    draw_track,
)
from situgraph.view.canvas import svg_text
from situgraph.view.experiments import power_law, wilson
from situgraph.view.lettering import percent, plain, seconds
from situgraph.view.surfaces import averaged

ROWS = [
    {"n": n, "ms": 0.01 * n**1.5 * f, "kind": kind, "half": None}
    for n in (10, 100, 1000)
    for f in (0.9, 1.0, 1.1)
    for kind in ("search", "<b>index</b>")
]
AXES = {"x_name": "rooms", "y_name": "ms"}


@given(st.floats(0.1, 10.0), st.floats(-3.0, 3.0))
def test_the_fit_gives_back_a_power_law(factor: float, exponent: float) -> None:
    x = np.array([1.0, 10.0, 50.0, 400.0])
    fit = power_law(x, factor * x**exponent)
    assert fit is not None
    assert (fit.factor, fit.exponent) == pytest.approx((factor, exponent), abs=1e-6)


def test_no_power_law_through_one_place() -> None:
    assert power_law(np.array([3.0, 3.0]), np.array([1.0, 2.0])) is None
    assert power_law(np.array([]), np.array([])) is None


def test_the_interval_of_a_share() -> None:
    low, high = wilson(81, 263)  # Newcombe, 1998, table I: 0.2553 to 0.3662
    assert (low, high) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert wilson(0, 20)[0] == pytest.approx(0.0, abs=1e-12)


def test_scale_says_the_exponent_and_the_runs() -> None:
    found = texts(svg_text(draw_scale(ROWS, "n", "ms", "kind", title="Cost", **AXES)))
    assert any("n^1.50" in t and "search" in t for t in found)
    assert any("18 runs" in t for t in found)
    assert any("<b>index</b>" in t for t in found)


def test_lines_pass_over_rows_without_a_number() -> None:
    rows = [*ROWS, {"n": 5, "ms": None, "kind": "search"}, {"kind": "other"}]
    svg = svg_text(draw_lines(rows, "n", "ms", "kind", title="Time", log_y=True, **AXES))
    assert "Time" in texts(svg)


@pytest.mark.parametrize("rows", [[], [{"p": None, "ok": True, "n": None, "ms": 3.0}]])
def test_charts_without_data_say_so(rows: list[dict[str, object]]) -> None:
    assert "no rows" in texts(svg_text(draw_lines(rows, "n", "ms", title="T", **AXES)))
    assert "no rows" in texts(svg_text(draw_scale(rows, "n", "ms", title="T", **AXES)))
    fromstring(svg_text(draw_reliability(rows, "p", "ok", title="T")))
    fromstring(svg_text(draw_outcomes({}, title="T")))
    surface = Surface("n", "p", "ms", "n", "p", "ms")
    fromstring(svg_text(draw_surfaces(rows, [surface], "kind", "sym", title="T")))


def test_reliability_counts_its_statements() -> None:
    rows = [{"p": 0.05 + 0.1 * i, "ok": i > 4} for i in range(10)] * 3
    found = texts(svg_text(draw_reliability(rows, "p", "ok", title="Reliable?")))
    assert any(t.startswith("30 statements") for t in found)


def test_outcomes_are_shares() -> None:
    found = texts(svg_text(draw_outcomes({"drift": {"right": 3, "wrong": 1}}, title="T")))
    assert {"drift", "75 %", "25 %", "4 runs"} <= set(found)


def test_surfaces_average_what_stands_above_one_place() -> None:
    rows = [{"a": a, "s": s, "z": z} for a in (1, 2) for s in (1, 2) for z in (10.0, 1000.0)]
    x, _, z = averaged(rows, Surface("a", "s", "z", "a", "s", "z"))
    assert len(x) == 4
    assert z == pytest.approx(505.0)
    _, _, logs = averaged(rows, Surface("a", "s", "z", "a", "s", "z", log_z=True))
    assert logs == pytest.approx(2.0)


def test_surfaces_have_a_column_for_each_symmetry() -> None:
    rows = [
        {"a": a, "s": s, "z": a * s + 1.0, "semantics": k, "symmetry": c}
        for a in (1, 2, 3) for s in (1, 2, 3)
        for k in ("none", "likelihood") for c in ("local", "global")
    ]  # fmt: skip
    surface = Surface("a", "s", "z", "A-rooms", "S-rooms", "solutions", log_z=True)
    figure = draw_surfaces(rows, [surface], "semantics", "symmetry", title="Solutions")
    assert {"local", "global", "● none", "● likelihood"} <= set(texts(svg_text(figure)))
    again = draw_surfaces(rows, [surface], "semantics", "symmetry", title="Solutions")
    assert svg_text(figure) == svg_text(again)


def test_a_track_over_two_storeys_tells_when_it_was_located() -> None:
    time = np.linspace(0.0, 240.0, 200)
    where = np.stack([time / 20.0, np.full(200, 1.9), np.where(time < 120, 0.3, 3.3)], axis=1)
    svg = svg_text(draw_track(office(storeys=3), time, where, located=30.0))
    found = texts(svg)
    assert {"Level 0", "Level 1", "located here", "0:00", "4:00"} <= set(found)
    assert "Level 2" not in found
    assert any("located after 30 s" in t for t in found)


def test_a_track_of_nothing_is_a_sentence() -> None:
    figure = draw_track(office(), [], np.zeros((0, 3)))
    assert "There is no trajectory to draw." in texts(svg_text(figure))


def test_a_history_shows_what_was_known() -> None:
    history = [Status(float(i), i, 2 * i, max(8 - i, 1), "ambiguous") for i in range(9)]
    assert {"seen so far", "placements that fit"} <= set(texts(svg_text(draw_history(history))))
    assert "no rows" in texts(svg_text(draw_history([])))


@given(st.text(max_size=200))
def test_plain_text_is_one_short_line_that_xml_can_hold(text: str) -> None:
    line = plain(text, 40)
    assert len(line) <= 40
    assert "\n" not in line
    fromstring(f"<a>{line.replace('&', '').replace('<', '')}</a>")


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.7, "70 %"), (0.9991, "99.91 %"), (1.0, "100 %"), (0.0, "0 %"), (1e-6, "0.0001 %"),
     (1 - 1e-12, "> 99.99999 %"), (1e-12, "< 0.00001 %")],
)  # fmt: skip
def test_probabilities_are_never_rounded_to_certainty(value: float, text: str) -> None:
    assert percent(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(4e-7, "0 µs"), (2.5e-4, "250 µs"), (0.0123, "12.3 ms"), (300, "5 min")]
)
def test_durations(value: float, text: str) -> None:
    assert seconds(value) == text
