"""The second stage of the detector `small`: it looks at one thing at a time and tells its category anew.

The first stage sees a thing of 20 pixels as 20 pixels. This one sees it and what is around it at SIDE x SIDE pixels,
whatever its size in the picture, with which of these are of the thing, and how large it is in metres.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from hazard_ms.perception.detectors.small_network import CHANNELS, Block, convolution
from hazard_ms.sensing.detection.detector import box_of

PREFIX = "second."  # of the names of its weights beside those of the first stage
SIDE = 64  # of a patch [pixels] [ours]
MARGIN = 1.5  # side of what a patch shows, as a multiple of the longer side of the thing's box [ours]
LEAST_PIXELS = 40  # of a thing about which it is asked; it learns from none with fewer [ours]
LEAST_SIDE = 8.0  # of that box [pixels] [ours]
WIDTH = 24  # channels after the first convolution [ours]
SIZES = 8  # numbers that `sizes_of` tells
BETWEEN = (5.0, 95.0)  # percentiles between which a thing lies: pixels at its edge show what is behind it [ours]
DROPPED = 0.3  # share of what is seen that a step of its training leaves out [ours]
FIRST, SECOND = 0.85, 0.85  # exponents of the chances of the two stages (docs/perception.md) [ours]
LEAST = 1e-4  # chance that a stage gives anything [ours]


class SecondNetwork(nn.Module):
    """The network itself: patches and sizes of things in, logits of their categories out."""

    def __init__(self, classes: int) -> None:
        """Make an untrained network for so many `classes`, other things (last) included."""
        super().__init__()
        w = WIDTH
        self.body = nn.Sequential(
            convolution(CHANNELS + 1, w, 2),
            convolution(w, w),
            convolution(w, 2 * w, 2),
            Block(2 * w),
            convolution(2 * w, 3 * w, 2),
            Block(3 * w),
            convolution(3 * w, 4 * w, 2),
            Block(4 * w),
        )
        self.large = nn.Sequential(nn.BatchNorm1d(SIZES), nn.Linear(SIZES, 64), nn.ReLU(), nn.Linear(64, 4 * w))
        self.drop = nn.Dropout(DROPPED)
        self.head = nn.Linear(8 * w, classes)

    def forward(self, patches: Tensor, sizes: Tensor) -> Tensor:
        """Logits, [N, L] [-], of things by their `patches`, [N, CHANNELS + 1, SIDE, SIDE], and `sizes`, [N, SIZES]."""
        seen = self.body(patches)
        mask = functional.adaptive_avg_pool2d(patches[:, -1:].clamp(0.0, 1.0), seen.shape[-2:]) + 0.02
        inside = (seen * mask).sum((2, 3)) / mask.sum((2, 3))
        told: Tensor = self.head(self.drop(torch.cat([inside + self.large(sizes), seen.mean((2, 3))], 1)))
        return told


class SecondStage:
    """A trained network, asked about things that a first stage found."""

    def __init__(self, network: SecondNetwork, device: torch.device) -> None:
        """Ask `network` on a `device`."""
        self._network, self._device = network.eval().to(device), device

    @torch.inference_mode()
    def chances(
        self,
        given: Tensor,
        depth: NDArray[np.float32],
        camera: tuple[NDArray[np.floating], NDArray[np.floating]],
        masks: Sequence[NDArray[np.bool_]],
    ) -> NDArray[np.float64]:
        """Chances of each category, and last of none, [N, L + 1] [-], of things by their `masks`, [H, W] each.

        `given`: what `features` tells of the picture, [CHANNELS, H, W]; `depth` [m], [H, W]; `camera`: its matrix
        [pixels], [3, 3], and its pose [m], [4, 4].
        """
        patches = torch.stack([patch_of(given, mask, SIDE, MARGIN) for mask in masks])
        sizes = np.stack([sizes_of(depth, camera, mask) for mask in masks])
        logits = self._network(patches, torch.from_numpy(sizes).to(self._device))
        told: NDArray[np.float64] = logits.double().softmax(-1).cpu().numpy()
        return told


def both(first: NDArray[np.floating], second: NDArray[np.floating]) -> NDArray[np.float64]:
    """Chances of each category, [N, L] [-], by what two stages say: `first`, [N, L], and `second`, [N, L + 1].

    What is missing to 1 in `first` is the chance of none, which `second` tells last. Logarithms are added with weights.
    """
    none = 1.0 - first.sum(-1, keepdims=True)
    mine = np.concatenate([first, none], -1).clip(LEAST) ** FIRST * second.clip(LEAST) ** SECOND
    told: NDArray[np.float64] = mine[:, :-1] / mine.sum(-1, keepdims=True)
    return told


def patch_of(given: Tensor, mask: NDArray[np.bool_], side: int, margin: float) -> Tensor:
    """A thing and what is around it, [CHANNELS + 1, side, side]: features, and whether a pixel is of the thing.

    `given`: what `features` tells of the picture, [CHANNELS, H, W]; `mask`, [H, W], of the thing; `margin`: side of
    what is seen as a multiple of the longer side of its box. Beside the picture its edge goes on.
    """
    height, width = mask.shape
    left, top, right, bottom = box_of(mask)
    reach = margin * max(right - left, bottom - top, LEAST_SIDE) / 2.0
    steps = (torch.arange(side, dtype=torch.float32) + 0.5) / side * 2.0 - 1.0
    across = ((left + right) / 2.0 + reach * steps) / width * 2.0 - 1.0
    down = ((top + bottom) / 2.0 + reach * steps) / height * 2.0 - 1.0
    grid = torch.stack([across.expand(side, side), down[:, None].expand(side, side)], -1)[None].to(given.device)
    seen = functional.grid_sample(given[None], grid, "bilinear", "border", align_corners=False)
    own = torch.from_numpy(mask).to(given.device, torch.float32)[None, None]
    mine = functional.grid_sample(own, grid, "bilinear", "zeros", align_corners=False)
    return torch.cat([seen[0], mine[0]])


def sizes_of(
    depth: NDArray[np.float32],
    camera: tuple[NDArray[np.floating], NDArray[np.floating]],
    mask: NDArray[np.bool_],
) -> NDArray[np.float32]:
    """Sizes of a thing, float32 [SIZES].

    Logarithms of its height, length and width [m]; the heights of its lower and upper end above the floor [m];
    logarithms of its distance [m], of its pixels, and of the side of a square of its area [m]. `depth` [m], [H, W];
    `camera`: its matrix [pixels], [3, 3], and its pose [m], [4, 4], looking along -z with y up.
    """
    intrinsic, cam2world = camera
    left, top, right, bottom = map(int, box_of(mask))
    window = slice(top, bottom), slice(left, right)
    rows, columns = np.nonzero(mask[window] & (depth[window] > 0.0))
    if len(rows) < 2:
        return np.zeros(SIZES, np.float32)
    rows, columns = rows + top, columns + left
    far = depth[rows, columns].astype(np.float64)
    across = (columns + 0.5 - intrinsic[0, 2]) / intrinsic[0, 0] * far
    up = (intrinsic[1, 2] - rows - 0.5) / intrinsic[1, 1] * far
    points = np.stack([across, up, -far], -1) @ np.asarray(cam2world)[:3, :3].T + np.asarray(cam2world)[:3, 3]
    low, high = np.percentile(points[:, 2], BETWEEN)
    flat = points[:, :2] - points[:, :2].mean(0)
    wide, long = np.sqrt(np.linalg.eigvalsh(flat.T @ flat / len(flat)).clip(1e-8))
    middle, count = float(np.median(far)), float(mask.sum())
    area = count * middle**2 / float(intrinsic[0, 0] * intrinsic[1, 1])
    logs = np.log([high - low + 0.01, 4.0 * long + 0.01, 4.0 * wide + 0.01])
    return np.array([*logs, low, high, np.log(middle), np.log(count), 0.5 * np.log(area + 1e-5)], np.float32)


def loaded(weights: Mapping[str, Tensor], classes: int) -> SecondNetwork | None:
    """The second stage among the `weights`, [...] [-], of a detector that tells so many `classes`, or None without.

    Raises RuntimeError for weights of another network.
    """
    mine = {name.removeprefix(PREFIX): value.float() for name, value in weights.items() if name.startswith(PREFIX)}
    if not mine:
        return None
    network = SecondNetwork(classes + 1)
    network.load_state_dict(mine)
    return network
