"""Bad building models end in one sentence: never a crash, a traceback or words on stdout."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from tests.plan.ifc_author import Author, rectangle, two_rooms

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc import build_graph, read_ifc, read_measured

HERE = PlanConfig(isolate=False)
HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
)


@pytest.fixture
def good(tmp_path: Path) -> Path:
    author = Author()
    two_rooms(author, author.storey("EG", 0.0))
    return author.save(tmp_path / "good.ifc")


def refused(path: Path, config: PlanConfig = HERE) -> str:
    with pytest.raises(InputError) as caught:
        read_ifc(path, config)
    sentence = str(caught.value)
    assert sentence.startswith(str(path))
    assert "\n" not in sentence
    return sentence


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "empty"),
        (b"\0" * 5000, "ISO-10303-21"),
        (b"PK\x03\x04 and so on", "zip"),
        (b"<?xml version='1.0'?><ifcXML/>", "XML"),
        (b"hello", "ISO-10303-21"),
        (HEADER.encode() + b"ENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;", "no schema"),
        (
            HEADER.encode()
            + b"FILE_SCHEMA(('AP214'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;",
            "AP214",
        ),
        (
            HEADER.encode() + b"FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n#1=IFCWALL((((;\n"
            b"ENDSEC;\nEND-ISO-10303-21;",
            "damaged",
        ),
    ],
)
def test_files_that_are_no_ifc(tmp_path: Path, content: bytes, expected: str) -> None:
    path = tmp_path / "bad.ifc"
    path.write_bytes(content)
    assert expected in refused(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("IFCCARTESIANPOINT((", "IFCCARTESIANPOINT('x' 'y' ((("),
        ("(0.,0.,1.))", "(0.,0.,1.)"),
        ("#20=", "#### garbage ;; #20="),
    ],
)
def test_damage_within(good: Path, old: str, new: str) -> None:
    text = good.read_text()
    assert old in text
    good.write_text(text.replace(old, new, 1))
    sentence = refused(good)
    assert "STEP" in sentence or "damaged" in sentence


def test_small_damage_is_a_warning(good: Path) -> None:
    text = good.read_text()
    good.write_text(text.replace("IFCRELVOIDSELEMENT(", "IFCRELNOSUCHTHING(", 1))
    graph = build_graph(good, HERE)
    assert "damaged-file" in {w.code for w in graph.warnings}


@pytest.mark.parametrize("share", [0.2, 0.5, 0.99])
def test_truncated(good: Path, share: float) -> None:
    text = good.read_bytes()
    good.write_bytes(text[: int(len(text) * share)])
    assert "cut off" in refused(good)


def test_missing_and_directory(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "none.ifc")
    assert "directory" in refused(tmp_path)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.ifc"
    with path.open("wb") as stream:
        stream.write(HEADER.encode())
        stream.truncate(2_000_000_000)
    assert "MB" in refused(path)
    zeros = tmp_path / "zeros.ifc"
    with zeros.open("wb") as stream:
        stream.truncate(2_000_000_000)
    assert "ISO-10303-21" in refused(zeros)


def test_neither_spaces_nor_walls(tmp_path: Path) -> None:
    author = Author()
    author.element("IfcFurniture", (0.0, 0.0), (1.0, 1.0))
    assert "neither spaces nor walls" in refused(author.save(tmp_path / "bare.ifc"))


def test_walls_that_enclose_nothing(tmp_path: Path) -> None:
    author = Author()
    author.wall((0, 0), (4, 0))
    assert "enclose no room" in refused(author.save(tmp_path / "fence.ifc"))


def test_rooms_in_the_wrong_unit_are_refused(tmp_path: Path) -> None:
    author = Author()  # metres are stated, millimetres meant
    author.space("A", rectangle(0, 0, 4000, 3000), height=2500)
    author.wall((0, 0), (4000, 0))
    assert "metres" in refused(author.save(tmp_path / "mm.ifc"))


def test_a_body_without_floor_or_with_wild_numbers_is_named(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    flat = author.space("flat", rectangle(0, 0, 1e-9, 1e-9))
    made["window a"].Representation = None
    graph = build_graph(author.save(tmp_path / "odd.ifc"), HERE)
    assert [r.name for r in graph.rooms] == ["A", "B"]
    said = {w.code: w for w in graph.warnings}
    assert said.keys() & {"room-without-floor", "no-geometry"}
    assert any(flat.GlobalId in w.ids for w in graph.warnings)


# ---------------------------------------------------------------------- the child process


def test_the_child_gives_the_same_graph(good: Path, capfd: pytest.CaptureFixture[str]) -> None:
    reading = read_measured(good)
    assert reading.graph == build_graph(good, HERE)
    assert reading.seconds > 0.0
    assert reading.peak_mb > 10.0
    assert capfd.readouterr() == ("", "")


def test_the_child_says_what_is_wrong(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    author = Author()
    author.element("IfcFurniture", (0.0, 0.0), (1.0, 1.0))
    sentence = refused(author.save(tmp_path / "bare.ifc"), PlanConfig())
    assert sentence.count(str(tmp_path)) == 1
    assert capfd.readouterr() == ("", "")


def test_too_slow_and_too_large_for_the_child(good: Path) -> None:
    assert "takes more than" in refused(good, PlanConfig(max_seconds=0.01))
    if sys.platform == "linux":
        assert "MB" in refused(good, PlanConfig(max_memory_mb=128))


def test_a_crash_of_the_parser_stays_in_the_child(
    good: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    crashing = tmp_path / "crash"
    (crashing / "ifcopenshell").mkdir(parents=True)
    source = "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n"
    (crashing / "ifcopenshell" / "__init__.py").write_text(source)
    monkeypatch.syspath_prepend(str(crashing))
    assert "crashes the IFC parser" in refused(good, PlanConfig())


def test_the_memory_of_a_child_is_its_own() -> None:
    child = "from situgraph.plan.ifc import peak_memory_mb; print(peak_memory_mb())"
    parent = (
        "import subprocess, sys; kept = bytearray(b'x') * 400_000_000; "
        f"subprocess.run([sys.executable, '-c', {child!r}], check=True)"
    )
    done = subprocess.run([sys.executable, "-c", parent], capture_output=True, check=True)
    assert 5.0 < float(done.stdout) < 350.0
