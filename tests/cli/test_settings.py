"""Settings: a file, overrides, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import msgspec
import pytest

from situgraph import config
from situgraph.config import Settings, describe, load_settings, to_yaml
from situgraph.errors import ConfigError


class Inner(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    rates: dict[str, Annotated[float, msgspec.Meta(ge=0, le=1)]] = msgspec.field(
        default_factory=lambda: {"door": 0.9, "window": 0.8}
    )
    sizes: tuple[float, ...] = (1.0, 2.0)


class Stage(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    plane_offset_tolerance: Annotated[
        float,
        msgspec.Meta(gt=0, description="Fits: this near.", extra={"unit": "m", "source": "paper"}),
    ] = 0.15
    name: str = "default"
    workers: int = 1
    inner: Inner = msgspec.field(default_factory=Inner)


class House(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    matching: Stage = msgspec.field(default_factory=Stage)
    slam: Stage = msgspec.field(default_factory=Stage)


@pytest.fixture(autouse=True)
def house(monkeypatch: pytest.MonkeyPatch) -> None:
    """Settings of our own, so that these tests do not depend on the stages'."""
    monkeypatch.setattr(config, "Settings", House)


def load(*overrides: str, file: Path | None = None) -> Any:
    return load_settings(file, overrides)


def test_defaults_then_file_then_overrides(tmp_path: Path) -> None:
    file = tmp_path / "settings.yaml"
    file.write_text("matching: {plane_offset_tolerance: 0.2, name: a}\nslam:\n  workers: 4\n")
    settings = load("matching.name=b", file=file)
    assert settings.matching.plane_offset_tolerance == 0.2
    assert settings.matching.name == "b"
    assert settings.slam.workers == 4
    assert settings.slam.plane_offset_tolerance == 0.15


@pytest.mark.parametrize(
    ("override", "read", "expected"),
    [
        ("matching.plane_offset_tolerance=1e-3", lambda s: s.matching.plane_offset_tolerance, 1e-3),
        ("matching.plane_offset_tolerance=2", lambda s: s.matching.plane_offset_tolerance, 2.0),
        ("slam.inner.rates.door=0.5", lambda s: s.slam.inner.rates, {"door": 0.5, "window": 0.8}),
        ("slam.inner.rates={chair: 1}", lambda s: s.slam.inner.rates["chair"], 1.0),
        ("slam.inner.sizes=[3, 4]", lambda s: s.slam.inner.sizes, (3.0, 4.0)),
        ("slam.name=it: is", lambda s: s.slam.name, "it: is"),
        ("slam.name=12", lambda s: s.slam.name, "12"),
    ],
)
def test_an_override_takes_yaml_values(override: str, read: Any, expected: Any) -> None:
    assert read(load(override)) == expected


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("matching.plane_ofset_tolerance=1", "nearest is matching.plane_offset_tolerance"),
        ("matchin.workers=1", "the nearest is matching"),
        ("plane_offset_tolerance=1", "the nearest is matching.plane_offset_tolerance"),
        (
            "matching.plane_offset_tolerance=-1",
            "matching.plane_offset_tolerance: expected `float` >",
        ),
        ("matching.plane_offset_tolerance=.nan", "must be a finite number"),
        ("matching.plane_offset_tolerance=inf", "must be a finite number"),
        (
            "matching.plane_offset_tolerance=wide",
            "matching.plane_offset_tolerance: expected `float`",
        ),
        ("matching.workers=1.5", "matching.workers: expected `int`"),
        ("slam.inner.rates.door=2", "slam.inner.rates"),
        ("matching=3", "matching must be a mapping"),
        ("matching.workers", "expected KEY=VALUE"),
        ("matching.workers={", "not YAML"),
        ("=3", "unknown setting"),
    ],
)
def test_a_bad_override_is_refused(override: str, problem: str) -> None:
    with pytest.raises(ConfigError, match=problem):
        load(override)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("matching: {workers: 1", "not YAML"),
        ("- matching", "must be a mapping"),
        ("wall_colour: red", "unknown setting wall_colour"),
        ("a: &a [1]\nb: *a", "aliases"),
        ("matching: !!python/object/apply:os.system ['true']", "not YAML"),
        ("[" * 5000, "not YAML"),
        ("#" * 1_000_001, "larger than"),
        ("\0", "not YAML"),
    ],
)
def test_a_bad_file_is_refused(tmp_path: Path, text: str, problem: str) -> None:
    file = tmp_path / "settings.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError, match=problem) as caught:
        load(file=file)
    assert str(file) in str(caught.value)


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(ConfigError, match="cannot be read"):
            load(file=path)
    (tmp_path / "empty.yaml").touch()
    assert load(file=tmp_path / "empty.yaml") == House()


def test_settings_are_described_and_written_as_yaml(tmp_path: Path) -> None:
    settings = load("slam.inner.rates.door=0.1", "matching.name='yes'")
    listed = {item.key: item for item in describe(settings)}
    tolerance = listed["matching.plane_offset_tolerance"]
    assert (tolerance.unit, tolerance.source) == ("m", "paper")
    assert tolerance.description == "Fits: this near."
    assert listed["slam.inner.rates"].value != listed["slam.inner.rates"].default
    text = to_yaml(settings)
    assert "  # Fits: this near. [m]\n  plane_offset_tolerance: 0.15\n" in text
    file = tmp_path / "settings.yaml"
    file.write_text(text)
    assert load(file=file) == settings


def test_the_stages_settings_survive_yaml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(config, "Settings", Settings)
    file = tmp_path / "settings.yaml"
    file.write_text(to_yaml(Settings()))
    assert load_settings(file) == Settings()
