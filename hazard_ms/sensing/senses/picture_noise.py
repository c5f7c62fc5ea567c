"""Noise of a sensor in colour pictures, for evaluations under other conditions than those of training."""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.simulation.chance import Chance

# standard deviation by level, 0 to 3, as a share of white: severities 1 to 3 of Gaussian noise in ImageNet-C
# [Hendrycks and Dietterich 2019, arXiv 1903.12261]
DEVIATIONS = (0.0, 0.08, 0.12, 0.18)


def noisy(picture: Tensor, level: int, chance: Chance, name: str) -> Tensor:
    """A picture, uint8 [E, H, W, 3], with Gaussian noise of a `level` in each of its numbers.

    The noise follows from seed and frame of `chance`, and from the `name` of the camera.
    """
    normal = chance.normal(f"perturbed picture {name}", *picture.shape[1:]).to(picture.device)
    return (picture.float() + 255.0 * DEVIATIONS[level] * normal).round().clamp(0.0, 255.0).to(torch.uint8)
