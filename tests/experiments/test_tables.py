"""Summaries as tables."""

from __future__ import annotations

from situgraph.experiments.tables import Table, markdown, summary_tables


def test_cases_with_the_same_kind_of_figures_share_a_table() -> None:
    summary = {"clean": {"right": 3, "wrong": 0}, "noisy": {"right": 2, "none": 1}}
    assert list(summary_tables(summary)) == [
        Table(
            "",
            ("case", "right", "wrong", "none"),
            [("clean", 3, 0, None), ("noisy", 2, None, 1)],
        )
    ]


def test_single_figures_and_deeper_levels_have_tables_of_their_own() -> None:
    summary = {"median": 1.23456, "by building": {"A": {"3 rooms": {"right": 1}}}}
    single, nested = summary_tables(summary)
    assert single == Table("", ("figure", "value"), [("median", 1.235)])
    assert nested == Table("by building / A", ("case", "right"), [("3 rooms", 1)])


def test_small_groups_of_a_case_are_spread_over_columns() -> None:
    summary = {"A": {"drives": 2, "ate": {"median": 0.1, "max": 0.2}}}
    (table,) = summary_tables(summary)
    assert table.columns == ("case", "drives", "ate median", "ate max")
    assert table.rows == [("A", 2, 0.1, 0.2)]


def test_markdown_leaves_absent_figures_empty() -> None:
    table = Table("t", ("case", "a", "b"), [("x", 1, None)])
    assert markdown(table) == "**t**\n\n| case | a | b |\n| --- | --- | --- |\n| x | 1 |  |\n"
