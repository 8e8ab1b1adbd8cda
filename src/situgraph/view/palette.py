"""Colours, and how they change in the dark.

Every colour of a drawing is one of these, so that a report can swap them by name when the reader's
system is dark. Room and series colours are those of Okabe and Ito ("Color Universal Design", 2008),
without its vermilion: red is kept for what is wrong.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

PAPER: Final = "#ffffff"
FLOOR: Final = "#f6f5f1"
FLOOR_EDGE: Final = "#dcd9d0"
INK: Final = "#1f2530"
MUTED: Final = "#6a7280"
HAIRLINE: Final = "#d3d7de"
WALL: Final = "#3a4150"
WALL_ONE: Final = "#b4bac5"
DOOR: Final = "#8a6642"
WINDOW: Final = "#2f86b5"
OBJECT: Final = "#59626f"
PATH: Final = "#7a4fa3"
ONLINE: Final = "#0a5a9c"
MOVED: Final = "#d1242f"
UNEXPLAINED: Final = "#8b93a0"
ADVICE: Final = "#c77700"
GOOD: Final = "#1a7f4b"

MATCH: Final = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#a08a00",
    "#7b6fd0",
    "#8c564b",
)
SERIES: Final = MATCH

# light -> dark
DARK: Final = MappingProxyType(
    {
        PAPER: "#15181d",
        FLOOR: "#20242b",
        FLOOR_EDGE: "#333943",
        INK: "#e9ebef",
        MUTED: "#9ba4b1",
        HAIRLINE: "#3a414c",
        WALL: "#c6ccd6",
        WALL_ONE: "#5d6674",
        DOOR: "#d3a878",
        WINDOW: "#6fc0ea",
        OBJECT: "#aab2bf",
        PATH: "#c39be8",
        ONLINE: "#6db6f5",
        MOVED: "#ff6f73",
        UNEXPLAINED: "#7d8694",
        ADVICE: "#f2ab45",
        GOOD: "#4fc487",
        MATCH[0]: "#4fa3dd",
        MATCH[2]: "#35c79b",
        MATCH[5]: "#d3bd3c",
        MATCH[6]: "#a59cf0",
        MATCH[7]: "#c98d80",
    }
)

VERDICTS: Final = MappingProxyType({"unique": GOOD, "ambiguous": ADVICE, "none": MOVED})
