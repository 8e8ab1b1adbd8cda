"""Pages that list what the code declares list all of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def test_the_page_of_settings_is_that_of_the_code(repository: Path) -> None:
    command = [sys.executable, "scripts/settings_table.py"]
    table = subprocess.run(command, cwd=repository, capture_output=True, text=True, check=True)
    assert table.stdout.strip() in (repository / "docs" / "settings.md").read_text()
