from __future__ import annotations

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.objects.classmap import ClassMap, class_map
from situgraph.objects.panoptic import OnnxPanopticDetector, PanopticConfig, fuse

onnx = pytest.importorskip("onnx")

MAP = ClassMap(3, {1: "Door", 2: "window"}, stuff=(2,))


def proposals(*parts):
    """(class, score logit, rows, columns) -> class logits and mask logits of 40x60 proposals."""
    scores = np.full((len(parts), 4), -4.0, np.float32)
    masks = np.full((len(parts), 40, 60), -9.0, np.float32)
    for k, (channel, logit, rows, columns) in enumerate(parts):
        scores[k, channel] = logit
        masks[k, slice(*rows), slice(*columns)] = 9.0
    return scores, masks


def found(*parts, shape=(40, 60)):
    return fuse(*proposals(*parts), shape, MAP, PanopticConfig())


def test_two_instances_of_one_thing_stay_two() -> None:
    doors = found((1, 4.0, (5, 30), (5, 15)), (1, 4.0, (5, 30), (40, 50)))
    assert [d.category for d in doors] == ["door", "door"]
    assert doors[0].mask.sum() == 250


def test_stuff_is_one_mask() -> None:
    (window,) = found((2, 4.0, (5, 30), (5, 15)), (2, 4.0, (5, 30), (40, 50)))
    assert window.mask.sum() == 500


def test_background_takes_its_pixels_and_gives_no_object() -> None:
    assert found((0, 4.0, (0, 40), (0, 60))) == []


def test_a_proposal_under_a_stronger_one_is_dropped() -> None:
    detections = found((1, 6.0, (5, 30), (5, 25)), (2, 1.0, (5, 30), (5, 20)))
    assert [d.category for d in detections] == ["door"]


def test_unsure_proposals_are_dropped() -> None:
    assert found((3, 9.0, (5, 30), (5, 25))) == []
    assert found((1, -4.0, (5, 30), (5, 25)))[0:] == found((1, -4.0, (5, 30), (5, 25)))


def test_masks_are_brought_to_the_size_of_the_image() -> None:
    (door,) = found((1, 4.0, (10, 30), (10, 20)), shape=(80, 120))
    assert door.mask.shape == (80, 120)
    assert abs(int(door.mask.sum()) - 800) < 80


def test_the_included_maps_name_doors_and_windows() -> None:
    ade, coco = class_map("ade20k"), class_map("coco")
    assert (ade.category(8), ade.category(14), ade.category(58)) == ("window", "door", "door")
    assert coco.category(86) == "door"
    assert "radiator" in ade.categories
    assert ade.category(0) is None


@pytest.mark.parametrize("text", ["classes: 3", "a: [", "classes: 3\nnames: {5: door}", "- 1"])
def test_a_wrong_map_is_refused(text, tmp_path) -> None:
    file = tmp_path / "map.yaml"
    file.write_text(text)
    with pytest.raises(InputError, match=r"map\.yaml"):
        class_map(file)


def model(path, *, outputs=("cls_scores", "mask_preds"), deformable=False):
    """A small ONNX graph with the contract: one proposal, a door where the image is bright."""
    from onnx import TensorProto, helper, numpy_helper

    def constant(name, array):
        return numpy_helper.from_array(np.asarray(array, np.float32), name)

    nodes, initial = [], [constant("scores", [[[-4, 6, -4, -4]]]), constant("gain", 8.0)]
    image = "image"
    if deformable:  # a 1x1 deformable convolution without offsets is the identity
        initial.append(constant("kernel", np.eye(3).reshape(3, 3, 1, 1)))
        initial.append(constant("offset", np.zeros((1, 2, 64, 96))))
        nodes.append(helper.make_node("DeformConv", ["image", "kernel", "offset"], ["same"]))
        image = "same"
    nodes += [
        helper.make_node("ReduceMean", [image, "axes"], ["bright"], keepdims=1),
        helper.make_node("Mul", ["bright", "gain"], [outputs[1]]),
        helper.make_node("Identity", ["scores"], [outputs[0]]),
    ]
    initial.append(numpy_helper.from_array(np.array([1], np.int64), "axes"))
    graph = helper.make_graph(
        nodes,
        "panoptic",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, 64, 96])],
        [
            helper.make_tensor_value_info(outputs[0], TensorProto.FLOAT, [1, 1, 4]),
            helper.make_tensor_value_info(outputs[1], TensorProto.FLOAT, [1, 1, 64, 96]),
        ],
        initial,
    )
    file = path / "model.onnx"
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 19)], ir_version=9)
    onnx.save(made, file)
    return file


def picture():
    rgb = np.zeros((128, 192, 3), np.uint8)
    rgb[20:100, 40:90] = 250
    return rgb


@pytest.mark.parametrize("deformable", [False, True])
def test_an_exported_network_runs(tmp_path, deformable) -> None:
    detector = OnnxPanopticDetector(model(tmp_path, deformable=deformable), MAP)
    (door,) = detector.detect(picture())
    assert door.category == "door"
    assert door.mask.shape == (128, 192)
    overlap = door.mask[20:100, 40:90].sum() / max(1, door.mask.sum())
    assert overlap > 0.9
    assert door.mask.sum() > 0.9 * 80 * 50


def test_other_outputs_are_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="cls_scores"):
        OnnxPanopticDetector(model(tmp_path, outputs=("logits", "boxes")), MAP)


def test_a_map_of_another_network_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="150 classes"):
        OnnxPanopticDetector(model(tmp_path), "ade20k").detect(picture())


def test_what_is_no_model_is_refused(tmp_path) -> None:
    file = tmp_path / "model.onnx"
    with pytest.raises(InputError, match="no such model"):
        OnnxPanopticDetector(file)
    file.write_bytes(b"\0" * 100)
    with pytest.raises(InputError, match="no ONNX model"):
        OnnxPanopticDetector(file)
