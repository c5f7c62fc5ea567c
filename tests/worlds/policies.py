"""Policies that were never trained, in files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch

from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.agents.learned.weights import ENDING, contents

TEMPERATURE = ((20.0, 600.0),)  # usual ends of the level of fire [C]
# numbers of hazards of the tasks that untrained policies are made for, with ends of levels that any level fits
RANGES = {"HazardFire-v1": 1, "HazardFlood-v1": 1, "HazardWind-v1": 1, "HazardCompound-v1": 2}


def stored(path: Path, task: str = "HazardFire-v1") -> Path:
    """The file `path`, which holds an untrained policy for `task` now."""
    torch.manual_seed(0)
    packed, told = contents(SetPolicy(Shape(TEMPERATURE * RANGES[task])), task, {})
    path.parent.mkdir(exist_ok=True, parents=True)
    path.write_bytes(packed)
    path.with_suffix(".json").write_text(told)
    return path


def stored_map(path: Path, task: str = "HazardFire-v1", **more: Any) -> Path:
    """The file `path`, which holds an untrained policy over the six actions for `task` now, of a shape with `more`."""
    torch.manual_seed(0)
    shape = MapShape(TEMPERATURE * RANGES[task], **{"share": 0.125, **more})
    packed, told = contents(MapPolicy(shape), task, {})
    path.parent.mkdir(exist_ok=True, parents=True)
    path.write_bytes(packed)
    path.with_suffix(".json").write_text(told)
    return path


def ship(folder: Path) -> Path:
    """A folder with untrained policies of all learned agents, as the package has one."""
    for task in RANGES:
        for name in ("bc", "rl"):
            stored(folder / f"{name}_{task}{ENDING}", task)
        stored_map(folder / f"rl_paper_{task}{ENDING}", task)
    return folder
