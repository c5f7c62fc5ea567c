"""Asks what can be done on a GPU of this machine, and what is missing for it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

DRIVER = Path("/dev/nvidiactl")  # which NVIDIA's driver makes
PHYSICS_BUDGET = 600.0  # for SAPIEN's download [s] [ours]


def missing(driver: Path = DRIVER) -> str:
    """Say in a line what this machine lacks to compute on a GPU; empty if nothing.

    `driver`: a file that exists where there is a GPU.
    """
    if not driver.exists():
        return f"an NVIDIA GPU with its driver (there is no {driver})"
    import torch

    if not torch.cuda.is_available():
        return f"a GPU that torch {torch.__version__} can use (see nvidia-smi and hazard-ms doctor)"
    return ""


@cache
def without_physx() -> str:
    """Say in a line why nothing can be simulated on the GPU, which must be there; empty if it can."""
    from results.gpu.apart import StoppedError, apart

    try:
        apart("physics", PHYSICS_BUDGET)
    except StoppedError as error:
        return f"PhysX for GPUs, a file that SAPIEN downloads from GitHub into ~/.sapien/physx once ({error})"
    return ""
