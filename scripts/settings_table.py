"""Print every setting as a Markdown table, stage by stage (used by docs/settings.md)."""

from __future__ import annotations

from itertools import groupby

from situgraph.config import Setting, describe


def cell(text: object) -> str:
    return " ".join(str(text).split()).replace("|", "\\|")


def stage(setting: Setting) -> str:
    return setting.key.partition(".")[0]


for name, settings in groupby(describe(), key=stage):
    print(f"\n## {name}\n")
    print("| setting | default | unit | meaning | source |\n|---|---|---|---|---|")
    for s in settings:
        row = (f"`{s.key}`", f"`{cell(s.default)}`", s.unit, s.description, s.source)
        print("| " + " | ".join(cell(c) for c in row) + " |")
