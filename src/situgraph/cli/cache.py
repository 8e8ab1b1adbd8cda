"""``situgraph cache``: what is kept in the user's cache folder, and a way to clear it."""

from __future__ import annotations

import click

from situgraph.cli.console import emit_json, print_table
from situgraph.cli.options import json_option


@click.command()
@click.option("--clear", is_flag=True, help="Remove everything that is cached.")
@json_option
def command(clear: bool, as_json: bool) -> None:
    """What is cached: plans read before, compiled code. $SITUGRAPH_CACHE names another folder."""
    from situgraph.cache import cache_use, clear_cache

    use = clear_cache() if clear else cache_use()
    if as_json:
        emit_json({"cleared": clear, "kinds": use})
        return
    rows = [(u.kind, u.files, f"{u.bytes / 1e6:.1f} MB", u.folder) for u in use]
    print_table("Removed" if clear else "Cached", ("kind", "files", "size", "folder"), rows)
