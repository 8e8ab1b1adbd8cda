"""The shipped network: a small depthwise U-Net that labels every pixel with a category.

Input (1, 3, 240, 320) float32 in 0..1, output logits (1, classes, 120, 160). About a quarter of a
million weights, so that it runs in milliseconds on one core and its ONNX file fits in the wheel.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

WIDTHS = (16, 32, 48, 80, 112)


class Separable(nn.Module):
    """Depthwise 3x3 then pointwise, each with batch norm, with a shortcut where shapes agree."""

    def __init__(self, inputs: int, outputs: int, stride: int = 1, dilation: int = 1) -> None:
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(inputs, inputs, 3, stride, dilation, dilation, groups=inputs, bias=False),
            nn.BatchNorm2d(inputs),
            nn.ReLU(inplace=True),
            nn.Conv2d(inputs, outputs, 1, bias=False),
            nn.BatchNorm2d(outputs),
        )
        self.shortcut = stride == 1 and inputs == outputs

    def forward(self, x: Tensor) -> Tensor:
        y = self.body(x)
        return torch.relu(y + x if self.shortcut else y)


class Net(nn.Module):
    """Five scales down, three up with skip connections, and a summary of the whole image."""

    def __init__(self, classes: int) -> None:
        super().__init__()
        w = WIDTHS
        self.stem = nn.Sequential(
            nn.Conv2d(3, w[0], 3, 2, 1, bias=False), nn.BatchNorm2d(w[0]), nn.ReLU(inplace=True)
        )
        self.refine = Separable(w[0], w[0])
        self.down = nn.ModuleList(
            nn.Sequential(Separable(a, b, stride=2), Separable(b, b), Separable(b, b, dilation=d))
            for a, b, d in zip(w[:-1], w[1:], (1, 1, 2, 2), strict=True)
        )
        self.image = nn.Sequential(nn.AdaptiveAvgPool2d(1), nn.Conv2d(w[4], w[4], 1), nn.Sigmoid())
        self.up = nn.ModuleList(
            Separable(a + b, b) for a, b in zip(w[:0:-1], w[-2::-1], strict=True)
        )
        self.head = nn.Sequential(Separable(w[0], 32), nn.Conv2d(32, classes, 1))

    def forward(self, x: Tensor) -> Tensor:
        x = self.refine(self.stem((x - 0.5) * 4.0))
        skips = []
        for stage in self.down:
            skips.append(x)
            x = stage(x)
        x = x * self.image(x)
        for stage, skip in zip(self.up, reversed(skips), strict=True):
            x = nn.functional.interpolate(x, size=skip.shape[2:], mode="bilinear")
            x = stage(torch.cat([x, skip], 1))
        return self.head(x)
