"""Train the shipped network on frames from ``generate.py`` and export it as ONNX.

    python training/train.py FRAMES/ -o src/situgraph/objects/model/

Runs on the CPU within an hour on two cores; the same seed and thread count give the same weights.
Score thresholds are chosen on the validation frames and stored in the model's class map. Needs the
``train`` extra (torch, onnx).
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")

import numpy as np
import torch
from net import Net
from torch import Tensor, nn

CROP = (160, 208)  # rows, columns; crops see less at once and train three times faster
IGNORE = 255
LEAST_IOU = 0.5  # on validation frames; a category that is told worse is not offered


def load(folder: Path, split: str) -> tuple[np.ndarray, np.ndarray]:
    """Images (n, 240, 320, 3) uint8 and labels (n, 240, 320) uint8 of one split."""
    return (
        np.load(folder / f"{split}-images.npy", mmap_mode="r", allow_pickle=False),
        np.load(folder / f"{split}-labels.npy", mmap_mode="r", allow_pickle=False),
    )


def augmented(image: np.ndarray, label: np.ndarray, rng: np.random.Generator) -> tuple:
    """A random crop, mirrored or not, with other light, colour, noise and now and then a blur."""
    h, w = label.shape
    top, left = rng.integers(0, h - CROP[0] + 1), rng.integers(0, w - CROP[1] + 1)
    x = image[top : top + CROP[0], left : left + CROP[1]].astype(np.float32) / 255.0
    y = label[top : top + CROP[0], left : left + CROP[1]]
    if rng.random() < 0.5:
        x, y = x[:, ::-1], y[:, ::-1]
    x = np.clip(x, 0, 1) ** rng.uniform(0.6, 1.6)
    x = (x - 0.5) * rng.uniform(0.7, 1.3) + 0.5 + rng.uniform(-0.12, 0.12)
    x = x * rng.uniform(0.85, 1.15, 3).astype(np.float32)
    if rng.random() < 0.3:
        x = (x + np.roll(x, 1, 0) + np.roll(x, 1, 1)) / 3.0
    x = x + rng.normal(0.0, rng.uniform(0.0, 0.04), x.shape)
    return np.clip(x, 0, 1).astype(np.float32), np.ascontiguousarray(y)


def loss(logits: Tensor, label: Tensor, weight: Tensor) -> Tensor:
    """Weighted cross entropy and soft Dice over the categories, at the network's resolution."""
    label = label[:, ::2, ::2].long()
    entropy = nn.functional.cross_entropy(logits, label, weight, ignore_index=IGNORE)
    keep = (label != IGNORE).unsqueeze(1)
    chance = torch.softmax(logits, 1) * keep
    hot = nn.functional.one_hot(label.where(label != IGNORE, 0), logits.shape[1])
    hot = hot.permute(0, 3, 1, 2) * keep
    both, either = (chance * hot).sum((0, 2, 3)), (chance + hot).sum((0, 2, 3))
    dice = 1.0 - (2.0 * both[1:] + 1.0) / (either[1:] + 1.0)
    return entropy + dice.mean()


def predict(net: Net, images: np.ndarray) -> np.ndarray:
    """Category chances (n, classes, 120, 160) float16 of images (n, 240, 320, 3)."""
    net.eval()
    out = []
    with torch.no_grad():
        for k in range(0, len(images), 16):
            x = torch.from_numpy(images[k : k + 16].astype(np.float32) / 255.0).permute(0, 3, 1, 2)
            out.append(torch.softmax(net(x), 1).to(torch.float16).numpy())
    net.train()
    return np.concatenate(out)


def scores(chance: np.ndarray, labels: np.ndarray, names: list[str]) -> dict:
    """Pixel IoU of each category and the chance above which it is taken, best for its IoU."""
    small = labels[:, ::2, ::2]
    found = {}
    for k, name in enumerate(names[1:], start=1):
        truth = small == k
        best = max(
            (
                (float((p & truth).sum() / max(1, (p | truth).sum())), float(t))
                for t in np.arange(0.25, 0.8, 0.05)
                for p in [chance[:, k] > t]
            ),
        )
        found[name] = {"iou": round(best[0], 4), "threshold": round(best[1], 2)}
    return found


def offered(validation: dict) -> dict[str, float]:
    """The thresholds of the categories that the network can tell."""
    return {k: v["threshold"] for k, v in validation.items() if v["iou"] >= LEAST_IOU}


def fit(net: Net, folder: Path, epochs: int, batch: int, seed: int, names: list[str]) -> None:
    """Train ``net`` in place."""
    images, labels = load(folder, "train")
    rng = np.random.default_rng(seed)
    counts = np.bincount(labels[::7].ravel(), minlength=256)[: len(names)].astype(float)
    share = np.maximum(counts / counts.sum(), 1e-4)
    weight = torch.tensor(np.clip(share**-0.35 / share[0] ** -0.35, 1.0, 8.0), dtype=torch.float32)
    steps = epochs * (len(images) // batch)
    best = torch.optim.AdamW(net.parameters(), 3e-3, weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.OneCycleLR(best, 6e-3, total_steps=steps, pct_start=0.15)
    started = time.monotonic()
    for epoch in range(epochs):
        total = 0.0
        order = rng.permutation(len(images))
        for k in range(0, len(order) - batch + 1, batch):
            pairs = [augmented(images[i], labels[i], rng) for i in order[k : k + batch]]
            x = torch.from_numpy(np.stack([p[0] for p in pairs])).permute(0, 3, 1, 2)
            y = torch.from_numpy(np.stack([p[1] for p in pairs]))
            value = loss(net(x.contiguous(memory_format=torch.channels_last)), y, weight)
            best.zero_grad(set_to_none=True)
            value.backward()
            best.step()
            schedule.step()
            total += value.item() * batch
        minutes = (time.monotonic() - started) / 60.0
        print(
            f"epoch {epoch + 1}/{epochs}  loss {total / len(order):.4f}  {minutes:.1f} min",
            flush=True,
        )


def export(net: Net, path: Path) -> None:
    """Write the network as ONNX with the softmax at its end."""
    net.eval()
    whole = nn.Sequential(net, nn.Softmax(1))
    torch.onnx.export(
        whole,
        (torch.zeros(1, 3, 240, 320),),
        str(path),
        input_names=["image"],
        output_names=["chance"],
        opset_version=18,
        dynamo=False,
    )


def main() -> None:
    """Train, choose thresholds, export and report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("frames", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--epochs", type=int, default=16)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    torch.manual_seed(options.seed)
    torch.set_num_threads(options.threads)
    torch.use_deterministic_algorithms(True)
    card = json.loads((options.frames / "frames.json").read_text())
    names = card["names"]
    net = Net(len(names)).to(memory_format=torch.channels_last)
    started = time.monotonic()
    fit(net, options.frames, options.epochs, options.batch, options.seed, names)
    report = {"training_minutes": round((time.monotonic() - started) / 60.0, 1)}
    for split in ("validation", "test"):
        images, labels = load(options.frames, split)
        report[split] = scores(predict(net, images), np.asarray(labels), names)
    options.output.mkdir(parents=True, exist_ok=True)
    export(net, options.output / "rooms.onnx")
    thresholds = offered(report["validation"])
    model = {"names": names, "thresholds": thresholds, "frames": card, "report": report}
    (options.output / "rooms.json").write_text(json.dumps(model, indent=1) + "\n")
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
