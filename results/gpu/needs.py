"""Asks what can be done on a GPU of this machine, and what is missing for it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from hazard_ms.machine.survey import LAVAPIPE, MANIFEST_VARIABLES, manifest_paths, read_manifest

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


def without_gpu(root: Path = Path("/"), environ: Mapping[str, str] | None = None) -> dict[str, str]:
    """The variables under which a process sees no other Vulkan driver than lavapipe, which draws on the CPU.

    SAPIEN draws on a GPU where it sees one, also for render_backend="cpu". Lavapipe is looked for among the drivers
    that the loader reads now, then in the system's folders. Empty if there is none.
    """
    for variables in (os.environ if environ is None else environ, {}):
        paths = manifest_paths(root, variables)
        found = [str(path) for path in paths if LAVAPIPE in read_manifest(path, frozenset()).library]
        if found:
            return {name: ":".join(found) for name in MANIFEST_VARIABLES}
    return {}
