"""The look of a report page: style sheet and the small script for enlarging pictures.

The page needs nothing but itself: no network, no fonts, no images beside it. Its content security
policy forbids everything but its own style and this one script, named by its hash.
"""

from __future__ import annotations

import base64
import hashlib
from html import escape
from importlib import resources

from situgraph.view import palette


def _shipped(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def document(title: str, body: str) -> str:
    """A whole HTML page around ``body``, which must be HTML already."""
    style, script = _shipped("report.css"), _shipped("report.js")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = (
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
        f"script-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'"
    )
    colors = "".join(f"--{light[1:]}:{dark};" for light, dark in palette.DARK.items())
    dark = f"@media (prefers-color-scheme:dark){{:root{{{colors}}}}}"
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}{dark}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n<script>{script}</script>\n</body>\n</html>\n"
    )
