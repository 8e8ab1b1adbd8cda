"""The drawing of a match, of rivals and of advice."""

from __future__ import annotations

import json
import math

import msgspec
import numpy as np
import pytest
from defusedxml.ElementTree import fromstring
from matplotlib.text import Text
from tests.view.buildings import ambiguous, match_of, office, seen
from tests.view.test_plan import texts

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement
from situgraph.view import ViewConfig, draw_advice, draw_match, draw_rivals, palette
from situgraph.view.canvas import svg_text
from situgraph.view.floors import survey
from situgraph.view.overlay import lay_over
from situgraph.view.record import Solution, read_record
from situgraph.view.wording import difference

ROOMS = ("r0-0-0", "r0-0-1", "r0-1-0")
MOVED = "p0-0-1-2"


def test_verdict_and_reason_are_the_title() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    found = texts(svg_text(draw_match(match_of(online), online, prior)))
    assert "Log in Office: unique" in found
    assert "one placement explains 3 of 4 rooms" in found
    assert any("99.91 %" in t for t in found)


def test_a_long_title_fits_its_page() -> None:
    name = "a building whose name is long"
    prior = msgspec.structs.replace(office(), name=name)
    online = msgspec.structs.replace(seen(prior, ROOMS), name=name)
    figure = draw_match(match_of(online), online, prior, config=ViewConfig(page_width=7.0))
    figure.canvas.draw()
    title = max(figure.findobj(Text), key=lambda text: float(text.get_fontsize()))
    assert name in title.get_text()
    assert title.get_window_extent().x1 <= figure.bbox.x1


def test_matched_rooms_have_one_colour_in_both_graphs() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    solution = read_record(match_of(online)).solutions[0]
    over = lay_over(survey(prior, ViewConfig()), online, solution, ViewConfig())
    assert over.colors == over.plan_colors
    assert len(set(over.colors.values())) == 3
    assert palette.MOVED not in palette.MATCH


def test_the_online_graph_lies_on_its_plan() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    solution = read_record(match_of(online)).solutions[0]
    over = lay_over(survey(prior, ViewConfig()), online, solution, ViewConfig())
    for room in over.online.graph.rooms:
        if room.id in prior.room_by_id:
            assert np.allclose(room.center, prior.room_by_id[room.id].center)


def test_moved_walls_are_red_with_their_offset() -> None:
    prior = office()
    online = seen(prior, ROOMS, moved=MOVED)
    svg = svg_text(draw_match(match_of(online, MOVED), online, prior))
    assert "+30 cm" in texts(svg)
    assert palette.MOVED in svg
    plain = svg_text(draw_match(match_of(seen(prior, ROOMS)), seen(prior, ROOMS), prior))
    assert palette.MOVED not in plain


def test_storeys_are_those_matched() -> None:
    prior = office(storeys=3)
    online = seen(prior, ("r1-0-0", "r1-0-1"))
    svg = svg_text(draw_match(match_of(online), online, prior))
    assert "Level 1" in texts(svg)
    assert "Level 0" not in texts(svg)


def test_no_placement_shows_both_graphs_apart() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    match = match_of(
        online, verdict="none", unique=False, solutions=[], count=0, reason="nothing fits"
    )
    found = texts(svg_text(draw_match(match, online, prior)))
    assert {"what was seen", "the plan", "nothing fits"} <= set(found)


def test_rivals_stand_side_by_side_with_their_probability_and_difference() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    figure = draw_rivals(ambiguous(online, prior), online, prior)
    found = texts(svg_text(figure))
    assert any(t.startswith("1   70 %") or t == "1 70 %" for t in found)
    assert any("turned 180°" in t for t in found)


def test_only_so_many_rivals_are_drawn() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    match = ambiguous(online, prior)
    match["solutions"] = match["solutions"] * 4  # type: ignore[operator]
    match["count"] = 500
    found = texts(svg_text(draw_rivals(match, online, prior, ViewConfig(max_rivals=3))))
    assert "The 3 most probable are drawn." in found
    assert any("500 placements fit" in t for t in found)


def test_advice_is_a_mark_and_a_sentence() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    found = texts(svg_text(draw_advice(ambiguous(online, prior), online, prior)))
    assert "1. window on the left wall of room 000: tells 1 from 2" in found


def test_advice_about_what_the_plan_does_not_hold_is_left_out() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    match = ambiguous(online, prior)
    match["disambiguation"] = [{"look_for": "door", "on_plane": "p99", "in_room": "r99"}]
    found = texts(svg_text(draw_advice(match, online, prior)))
    assert "Nothing that would tell the solutions apart is known." in found


def test_what_sets_a_rival_apart() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    best = Solution(Placement(), rooms={"a": "x", "b": "y"})
    other = Solution(Placement(0, 3, 3, math.pi / 2), rooms={"a": "x", "b": "z"})
    words = difference(best, other, online)
    assert "turned 90°" in words
    assert "other storey" in words
    assert "1 of 2 rooms elsewhere" in words


@pytest.mark.parametrize(
    "change",
    [
        {"format": "other"},
        {"version": 2},
        {"verdict": "maybe"},
        {"solutions": [{"rooms": {}}]},
        {"solutions": "none"},
        {"reason": object()},
    ],
)
def test_what_is_no_match_is_refused_in_a_sentence(change: dict[str, object]) -> None:
    prior = office(1, 1)
    with pytest.raises(InputError, match="match"):
        draw_match({**match_of(prior), **change}, prior, prior)


def test_ids_that_neither_graph_holds_are_passed_over() -> None:
    prior = office()
    online = seen(prior, ROOMS)
    text = json.dumps(match_of(online, MOVED)).replace("r0-0-1", "r-other").replace("p0-0", "q")
    fromstring(svg_text(draw_match(json.loads(text), online, prior)))


def test_the_same_match_gives_the_same_bytes() -> None:
    prior = office()
    online = seen(prior, ROOMS, moved=MOVED)
    match = match_of(online, MOVED)
    drawn = [svg_text(draw_match(match, online, prior)) for _ in range(2)]
    assert drawn[0] == drawn[1]
