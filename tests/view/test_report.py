"""Reports: self-contained, escaped, the same bytes again."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from tests.view.buildings import ambiguous, match_of, office, seen

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Warning
from situgraph.view import Report, ViewConfig, draw_graph, graph_report, match_report

HOSTILE = "<script>alert('x')</script><img src=x onerror=y>"
ROOMS = ("r0-0-0", "r0-0-1", "r0-1-0")
VOID = {"meta", "img", "br"}


class Page(HTMLParser):
    """Tags, attributes and text of a page; every tag must be closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, k, v or "") for k, v in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, k, v or "") for k, v in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(self.words)


def read(path: Path) -> Page:
    return Page(path.read_text())


def assert_self_contained(page: Page) -> None:
    allowed = ("http://www.w3.org/", "#", "data:image/png;base64,")
    for tag, key, value in page.attributes:
        assert not key.startswith("on"), (tag, key)
        if key in ("src", "href", "xlink:href", "action"):
            assert value.startswith(allowed), (tag, key, value)
    assert page.tags.count("script") == 1
    assert not {"iframe", "object", "embed", "link", "form", "base"} & set(page.tags)


def test_a_match_report_says_it_all_and_needs_nothing(tmp_path: Path) -> None:
    prior = office()
    online = seen(prior, ROOMS, moved="p0-0-1-2")
    path = match_report(
        match_of(online, "p0-0-1-2"),
        online,
        prior,
        tmp_path / "m.html",
        timings={"reading": 0.5, "match": 0.002},
        settings={"matching.rival_ratio": 0.01},
        sections=[lambda report: report.section("More").text("of it")],
    )
    page = read(path)
    assert_self_contained(page)
    for words in (
        "Located", "one placement explains 3 of 4 rooms", "99.91 %", "+30 cm", "± 2.0 cm",
        "not explained", "at least 3 of 4 rooms", "of it", "matching.rival_ratio", "500 ms",
    ):  # fmt: skip
        assert words in page.text, words
    assert page.tags.count("svg") == 3


def test_an_ambiguous_report_shows_rivals_and_advice(tmp_path: Path) -> None:
    prior = office()
    online = seen(prior, ROOMS)
    page = read(match_report(ambiguous(online, prior), online, prior, tmp_path / "m.html"))
    for words in ("Ambiguous", "Rival placements", "turned 180°", "What to look for next"):
        assert words in page.text, words
    assert page.tags.count("svg") == 5


def test_none_is_said_plainly(tmp_path: Path) -> None:
    prior = office(1, 1)
    online = seen(office(), ROOMS)
    match = match_of(online, verdict="none", unique=False, solutions=[], count=0)
    page = read(match_report(match, online, prior, tmp_path / "m.html"))
    assert "Not in this plan" in page.text


def test_hostile_names_are_escaped_everywhere(tmp_path: Path) -> None:
    prior = office(name=HOSTILE)
    rooms = tuple(
        type(r)(r.id, r.center, r.planes, r.storey, HOSTILE, r.footprint) for r in prior.rooms
    )
    warnings = (Warning(HOSTILE, HOSTILE, (HOSTILE,)),)
    prior = prior.replace(rooms=rooms, warnings=warnings, attributes={HOSTILE: HOSTILE})
    online = seen(prior, ROOMS).replace(name=HOSTILE)
    match = ambiguous(online, prior)
    match["reason"] = HOSTILE
    match["disambiguation"][0]["look_for"] = HOSTILE
    match["stats"]["model"] = HOSTILE
    match["stats"]["room_candidates"] = {HOSTILE: 3}
    for path in (
        match_report(match, online, prior, tmp_path / "m.html", settings={HOSTILE: HOSTILE},
                     timings={HOSTILE: 1.0}),
        graph_report(prior, tmp_path / "g.html"),
    ):  # fmt: skip
        page = read(path)
        assert_self_contained(page)
        assert "img" not in page.tags
        assert "alert" in page.text


def test_reports_are_the_same_again(tmp_path: Path) -> None:
    graph = office(storeys=2)
    first, second = (graph_report(graph, tmp_path / f"{i}.html") for i in (1, 2))
    assert first.read_bytes() == second.read_bytes()


def test_a_graph_report_counts_and_groups_warnings(tmp_path: Path) -> None:
    warnings = [Warning("sliver", f"face {i} is thin", (f"p{i}",)) for i in range(5)]
    warnings.append(Warning("door-without-room", "o1 is in no room"))
    page = read(graph_report(office().replace(warnings=tuple(warnings)), tmp_path / "g.html"))
    assert page.text.index("sliver") < page.text.index("door-without-room")
    assert "face 4 is thin (p4)" in page.text
    assert "000" in page.text


def test_very_large_drawings_enter_as_png() -> None:
    config = ViewConfig(inline_svg_limit=10_000, dpi=40)
    report = Report("r", config=config)
    report.section("s").picture(draw_graph(office(), config), "a plan")
    page = Page(report.html())
    assert "svg" not in page.tags
    assert ("img", "alt", "a plan") in page.attributes


def test_long_tables_are_cut_and_say_so() -> None:
    report = Report("r", config=ViewConfig(max_rows=5))
    report.section("s").table(("n", "name"), [(i, f"row {i}") for i in range(12)])
    page = Page(report.html())
    assert "row 4" in page.text
    assert "row 5" not in page.text
    assert "7 further rows are not shown." in page.text


def test_pictures_on_one_page_do_not_share_ids() -> None:
    report = Report("r")
    section = report.section("s")
    section.picture(draw_graph(office(1, 1))).picture(draw_graph(office(1, 1)))
    ids = [v for _, k, v in Page(report.html()).attributes if k == "id"]
    assert len(ids) == len(set(ids))


def test_only_the_shipped_script_may_run() -> None:
    page = Report("r").html()
    policy = re.search(r'content="(default-src[^"]*)"', page)
    assert policy is not None
    assert "default-src 'none'" in policy[1]
    assert "script-src 'sha256-" in policy[1]


def test_a_folder_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a directory"):
        Report("r").save(tmp_path)
