"""Opening an IFC file that nobody vouches for: cheap checks first, the parser after.

The STEP physical file format (ISO 10303-21) begins with ``ISO-10303-21;`` and ends with
``END-ISO-10303-21;``: a file without the first is no IFC, one without the last was cut off. The
parser itself accepts truncated files silently, and knows only three schema names.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.scenegraph.graph import Warning

HEAD_BYTES = 65_536  # a header is a few lines; generous for long option lists
TAIL_BYTES = 4_096

# what a schema name begins with -> the schema it is read as, most specific first
_READ_AS = (
    ("IFC4X", "IFC4X3_ADD2"),
    ("IFC4", "IFC4"),
    ("IFC2X", "IFC2X3"),
)


class OpenModel(msgspec.Struct, frozen=True):
    """A parsed model (``ifcopenshell.file``), the schema its header names, and what is odd."""

    model: Any
    schema: str
    warnings: tuple[Warning, ...]


def check_ifc(path: str | os.PathLike[str], config: PlanConfig) -> None:
    """Refuse what cannot be an IFC file without reading all of it.

    Raises:
        InputError: not a file, empty, too large, not STEP, cut off, or of an unknown schema.
    """
    file = Path(path)
    if not file.exists():
        raise InputError(file, "there is no such file", "check the path")
    if not file.is_file():
        raise InputError(file, "is a directory, not an IFC file", "name the .ifc file in it")
    try:
        size = file.stat().st_size
        with file.open("rb") as stream:
            head = stream.read(HEAD_BYTES)
            stream.seek(max(0, size - TAIL_BYTES))
            tail = stream.read(TAIL_BYTES)
    except OSError as error:
        raise InputError(
            file, f"cannot be read ({error.strerror})", "check its permissions"
        ) from error
    _check_head(file, head)
    if size > config.max_file_mb * 1_000_000:
        raise InputError(
            file,
            f"has {size / 1e6:.0f} MB, more than the {config.max_file_mb} MB allowed",
            "raise plan.max_file_mb if you trust it",
        )
    if b"END-ISO-10303-21" not in tail:
        raise InputError(
            file, "the file is cut off before END-ISO-10303-21", "export or copy it again"
        )
    schema_of(head, file)


def _check_head(file: Path, head: bytes) -> None:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    if not head:
        raise InputError(file, "the file is empty", "export or copy it again")
    if text.startswith(b"PK"):
        raise InputError(file, "is a zip archive", "unpack it and name the .ifc file in it")
    if text.startswith(b"<"):
        raise InputError(file, "is XML, and ifcXML is not read", "export it as IFC-SPF (.ifc)")
    if b"ISO-10303-21" not in text[:4096]:
        raise InputError(file, "does not begin with ISO-10303-21", "name an IFC file (STEP, .ifc)")


def schema_of(head: bytes, file: object) -> tuple[str, str]:
    """The schema a header names and the one it is read as, e.g. ``IFC2X_FINAL`` and ``IFC2X3``.

    Raises:
        InputError: no schema named, or not one of IFC 2x, 2x3, 4 and 4.3.
    """
    found = re.search(rb"FILE_SCHEMA\s*\(\s*\(\s*'([^']{1,64})'", head)
    if found is None:
        raise InputError(file, "its header names no schema (FILE_SCHEMA)", "export it again")
    name = found[1].decode("ascii", "replace").strip()
    for prefix, known in _READ_AS:
        if name.upper().startswith(prefix):
            return name, known
    raise InputError(file, f"has the schema {name}", "export it as IFC2x3, IFC4 or IFC4.3")


def open_ifc(path: str | os.PathLike[str], config: PlanConfig) -> OpenModel:
    """The parsed model of an IFC file.

    A schema name that the parser does not know, such as ``IFC2X_FINAL`` or ``IFC4X3``, is read as
    its nearest relative.

    Raises:
        InputError: what :func:`check_ifc` refuses, a syntax error, or a bracket that never closes
            (the parser swallows the rest of the file silently).
    """
    import ifcopenshell

    check_ifc(path, config)
    file = Path(path)
    log: Callable[[], str] = ifcopenshell.get_log
    log()  # whatever was said of another file
    try:
        with file.open("rb") as stream:
            head = stream.read(HEAD_BYTES)
        name, known = schema_of(head, file)
        if name == known:
            model = ifcopenshell.open(file, ".ifc")
        else:
            text = file.read_bytes().replace(f"'{name}'".encode(), f"'{known}'".encode(), 1)
            model = ifcopenshell.file.from_string(text.decode("latin-1"))
    except MemoryError:
        raise InputError(
            file, "does not fit in memory", "raise plan.max_memory_mb if you trust it"
        ) from None
    except InputError:
        raise
    except Exception as error:
        raise InputError(file, f"is not valid STEP ({error})", "export or copy it again") from error
    errors = [line for line in log().splitlines() if line.startswith("[error]")]
    if any("'ENDSEC' not found" in line for line in errors):
        problem = "is damaged: the parser loses its way before the end"
        raise InputError(file, problem, "export or copy it again")
    return OpenModel(model, name, tuple(_complaints(name, known, errors)))


def _family(schema: str) -> str:
    """``IFC4X3`` of ``IFC4X3_ADD2``, ``IFC2X`` of ``IFC2X_FINAL``."""
    found = re.match(r"IFC\d(X\d?)?", schema.upper())
    return found.group() if found else schema


def _complaints(name: str, known: str, errors: Sequence[str]) -> Iterator[Warning]:
    if _family(name) != _family(known):
        yield Warning("schema-read-as", f"the schema {name} is read as {known}")
    if errors:
        first = re.sub(r"\[[^]]*\]\s*", "", errors[0])[:200]
        message = f"the parser finds {len(errors)} errors in the file, the first: {first}"
        yield Warning("damaged-file", message)
