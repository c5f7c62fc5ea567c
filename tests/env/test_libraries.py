"""No function that a library computes in another way on each processor decides bits of an episode."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode

from tests.env.episode_hashes import TASKS

# what torch leaves to MKL on a CPU (aten/src/ATen/cpu/vml.h and native/cpu/BlasKernel.cpp of torch 2)
FUNCTIONS = "acos asin atan cos cosh erf erfc erfinv exp ln log log10 log2 sin sinh sqrt tan tanh"
ALGEBRA = "mm bmm addmm baddbmm mv addmv dot vdot _fft_r2c _fft_c2r _fft_c2c linalg_inv_ex _linalg_solve_ex"
LEFT = {f"aten.{name}" for name in (*FUNCTIONS.split(), *ALGEBRA.split())}
FRAMES = 30


class Watch(TorchDispatchMode):
    """Collects the operations of single precision that are left to a library."""

    def __init__(self) -> None:
        super().__init__()
        self.found: set[str] = set()

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        name = str(func.overloadpacket).removesuffix("_")
        if name in LEFT and any(isinstance(a, torch.Tensor) and a.dtype == torch.float32 for a in args):
            self.found.add(name)
        return func(*args, **(kwargs or {}))


def left_to_a_library(**options: Any) -> set[str]:
    """The names of such operations in the first frames of an episode."""
    env: Any = gym.make(obs_mode="state", render_backend="none", **options)
    with Watch() as watch:
        env.reset(seed=0)
        for _ in range(FRAMES):
            env.step(env.action_space.sample())
    env.close()
    return watch.found


@pytest.mark.parametrize(
    "options",
    [
        *({"id": env_id, "physics": "realistic"} for env_id in TASKS),
        {"id": "HazardCompound-v1", "hazards": ("fire", "wind"), "physics": "realistic"},
        {"id": "HazardFlood-v1", "robot_uids": "g1"},
    ],
    ids=lambda options: " ".join(map(str, options.values())),
)
def test_no_bit_is_left_to_a_library(options: dict[str, Any]) -> None:
    assert left_to_a_library(**options) == set()


def test_what_is_left_to_a_library_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hazard_ms.spec.rounding.cos", torch.cos)
    assert left_to_a_library(id=TASKS[0]) == {"aten.cos"}
