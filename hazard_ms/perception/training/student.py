"""The contract of networks that can be trained."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor

from hazard_ms.sensing.detection.detector import Detector


class Student(abc.ABC):
    """A network that learns from pictures, and the optimiser of its weights."""

    network: torch.nn.Module
    optimiser: torch.optim.Optimizer
    classes: list[str]  # categories that it tells, in the order of its numbers for them

    @abc.abstractmethod
    def losses(self, chance: np.random.Generator) -> Mapping[str, Tensor]:
        """The parts of the loss, 0-dimensional [...] [-], by name, of a batch that is drawn with `chance`.

        Their sum is made smaller.
        """

    @abc.abstractmethod
    def pace(self, step: int, share: float) -> float:
        """The rate of learning at `step`, when this `share` of the training is over [-]."""

    @abc.abstractmethod
    def detector(self) -> Detector:
        """The detector that the network is now; it stays right until the next step."""

    @abc.abstractmethod
    def weights(self) -> dict[str, Tensor]:
        """The tensors that the detector loads, [...] [-], by name."""

    @abc.abstractmethod
    def recipe(self) -> dict[str, Any]:
        """The contents of the file beside the weights: plain data."""

    def learned(self) -> None:  # noqa: B027 most keep nothing beside their weights
        """Called after each step of the optimiser."""

    def state(self) -> dict[str, Any]:
        """All that is needed to go on: plain data and tensors."""
        return {"network": self.network.state_dict(), "optimiser": self.optimiser.state_dict()}

    def resume(self, state: Mapping[str, Any]) -> None:
        """Go on from what `state` gave. Raises an error of torch's for anything else."""
        self.network.load_state_dict(state["network"])
        self.optimiser.load_state_dict(state["optimiser"])


class AveragedStudent(Student):
    """A student that tells what the average of its weights over the last steps would."""

    average: torch.nn.Module  # of the network
    decay: float  # share of the averaged weights that a step leaves
    steps = 0

    @torch.no_grad()
    def learned(self) -> None:
        """Move the average to the weights of now, the faster the fewer steps there were."""
        self.steps += 1
        kept = min(self.decay, (1 + self.steps) / (10 + self.steps))
        for mean, now in zip(self.average.state_dict().values(), self.network.state_dict().values(), strict=True):
            mean.copy_(torch.lerp(now, mean, kept) if mean.is_floating_point() else now)

    def state(self) -> dict[str, Any]:
        return {**super().state(), "average": self.average.state_dict(), "steps": self.steps}

    def resume(self, state: Mapping[str, Any]) -> None:
        super().resume(state)
        self.average.load_state_dict(state["average"])
        self.steps = int(state["steps"])


def device() -> torch.device:
    """The processor on which networks learn: a GPU of NVIDIA's if there is one."""
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")


def half_precision(where: torch.device) -> bool:
    """Whether it is quicker to multiply in bfloat16, which takes hardware made for it.

    A step of `small` takes 0.20 s of a core with AVX-512 BF16 in bfloat16, 0.32 s in float32 (measured).
    """
    if where.type == "cuda":
        return torch.cuda.is_bf16_supported(including_emulation=False)
    told: dict[str, bool] = getattr(torch.cpu, "get_capabilities", dict)()  # not in older versions of torch
    return any(told.get(name, False) for name in ("amx_bf16", "avx512_bf16"))


def relit(colours: Tensor, chance: np.random.Generator, light: float, tint: float, contrast: float) -> Tensor:
    """The `colours` of pictures, [N, 3, H, W], -1 to 1, in another light for each.

    `light`, `tint` and `contrast`: standard deviations of the logarithms of brightness, of that of each colour, and of
    the exponent of colours.
    """
    count = len(colours)
    gain = np.exp(chance.normal(0.0, light, (count, 1)) + chance.normal(0.0, tint, (count, 3)))
    gamma = np.exp(chance.normal(0.0, contrast, (count, 1)))
    by, power = (torch.from_numpy(a).float().to(colours.device)[:, :, None, None] for a in (gain, gamma))
    return (by * (0.5 * colours + 0.5).clamp(min=1e-3) ** power).clamp(0.0, 1.0) * 2.0 - 1.0
