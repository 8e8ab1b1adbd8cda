from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.objects.detections import Detector
from situgraph.objects.network import NetworkDetector

onnx = pytest.importorskip("onnx")

NAMES = ["background", "door", "window"]


def painted(folder: Path, thresholds: dict[str, float] | None = None) -> Path:
    """A model whose chances are the colours of the image: red is a door, blue a window."""
    from onnx import TensorProto, helper

    pick = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]], np.float32).reshape(3, 3, 1, 1)
    weight = helper.make_tensor("pick", TensorProto.FLOAT, pick.shape, pick.ravel())
    nodes = [
        helper.make_node("Conv", ["image", "pick"], ["full"]),
        helper.make_node("MaxPool", ["full"], ["chance"], kernel_shape=[2, 2], strides=[2, 2]),
    ]
    ends = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, 3, h, w])
        for name, h, w in (("image", 48, 64), ("chance", 24, 32))
    ]
    graph = helper.make_graph(nodes, "painted", ends[:1], ends[1:], [weight])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9)
    (folder / "rooms.onnx").write_bytes(model.SerializeToString())
    card = {"names": NAMES, "thresholds": thresholds or {"door": 0.5, "window": 0.5}}
    (folder / "rooms.json").write_text(json.dumps(card))
    return folder


def picture() -> np.ndarray:
    rgb = np.zeros((96, 128, 3), np.uint8)
    rgb[20:80, 12:40, 0] = 255
    rgb[20:60, 60:80, 2] = 200
    rgb[20:60, 92:112, 2] = 200
    return rgb


def test_what_touches_is_one_instance(tmp_path: Path) -> None:
    found = NetworkDetector(painted(tmp_path)).detect(picture())
    assert sorted(d.category for d in found) == ["door", "window", "window"]
    (door,) = (d for d in found if d.category == "door")
    assert door.mask.shape == (96, 128)
    assert np.array_equal(door.mask, picture()[..., 0] > 0)
    assert door.score == pytest.approx(1.0)


def test_thresholds_are_those_of_the_card(tmp_path: Path) -> None:
    found = NetworkDetector(painted(tmp_path, {"door": 0.5, "window": 0.9})).detect(picture())
    assert [d.category for d in found] == ["door"]


def test_a_category_without_threshold_is_not_offered(tmp_path: Path) -> None:
    detector = NetworkDetector(painted(tmp_path, {"window": 0.5}))
    assert detector.categories == {"window"}
    assert {d.category for d in detector.detect(picture())} == {"window"}


def test_an_absent_or_foreign_model_gives_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="model file is not there"):
        NetworkDetector(tmp_path)
    painted(tmp_path)
    (tmp_path / "rooms.onnx").write_bytes(b"no model")
    with pytest.raises(InputError, match="no ONNX model"):
        NetworkDetector(tmp_path).detect(picture())
    (tmp_path / "rooms.json").write_text('{"names": ["background"], "thresholds": {"door": 0.5}}')
    with pytest.raises(InputError, match="no model card"):
        NetworkDetector(tmp_path)


def test_the_shipped_network_is_small_and_knows_doors_and_windows() -> None:
    from importlib import resources

    detector = NetworkDetector()
    assert isinstance(detector, Detector)
    assert {"door", "window"} <= detector.categories
    assert detector.name == "network"
    file = resources.files("situgraph.objects") / "model" / "rooms.onnx"
    assert len(file.read_bytes()) <= 4_000_000
    rgb = np.random.default_rng(0).integers(0, 256, (480, 640, 3), np.uint8)
    first, second = detector.chances(rgb), NetworkDetector().chances(rgb)
    assert np.array_equal(first, second)
    assert np.allclose(first.sum(axis=0), 1.0, atol=1e-4)
