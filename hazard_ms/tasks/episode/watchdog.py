"""Watches every step for faults that PhysX never reports: NaN, runaway speeds, and bodies that left the world.

A fault ends the episode.
"""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
from collections import deque
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.watching import broken
from hazard_ms.simulation.world import World

MAX_TURN = 2.0  # largest number of a rotation: that of a unit quaternion is 1 [ours]
MAX_SPEED = 50.0  # highest speed of a body [m/s]: nothing in a room moves faster (docs/reliability.md 5)
MAX_SPIN = 1000.0  # highest angular velocity of a body [rad/s]; PhysX itself limits bodies to 100
LOST = 5.0  # distance outside the room at which a body counts as lost [m] [ours]
LONGEST_NAME = 80  # characters of a scene in the name of a file [ours]
HISTORY = 20  # number of the last states that are written when an episode breaks [frames]


class Limits:
    """The places [m] where bodies can be: within `half` of `centre`, [E, 3] each."""

    def __init__(self, world: World) -> None:
        height = world.room.new_tensor([[s.room.height] for s in world.specs])
        self.centre = torch.cat([world.room, height], dim=1) / 2
        beyond = world.room.new_tensor([[s.room.beyond, s.room.beyond, 0.0] for s in world.specs])
        self.half = self.centre + beyond + LOST
        self._new = torch.zeros(world.num_envs, dtype=torch.bool, device=world.device)

    def mark(self, world: World, qpos: Tensor, broken_ones: Tensor) -> Tensor:
        """Mark in `broken_ones`, bool [E], the environments whose simulation broke; those that are new, bool [E].

        `qpos`: the robot's joints [rad], [E, J]. The result holds until the next call.
        """
        limits = (self.centre, self.half, qpos, MAX_TURN, MAX_SPEED, MAX_SPIN)
        marks = (world.launches.struct(Bodies, world), broken_ones, self._new)
        world.launches.run(broken, (world.num_envs,), *limits, *marks)
        return self._new


class FlightRecorder:
    """Keeps the last states of the bodies, which are written to a file when an episode breaks."""

    def __init__(self) -> None:
        self.states: deque[dict[str, Tensor]] = deque(maxlen=HISTORY)

    def keep(self, world: World) -> None:
        """Keep a copy of the state of all bodies as they are now."""
        self.states.append(
            {"frame": world.frame.clone(), "position": world.position.clone(), "velocity": world.velocity.clone()}
        )

    def dump(self, world: World, env: int) -> str:
        """Write the last states of environment `env` as JSON to $HAZARD_MS_DUMPS, or a new folder of our own.

        Returns the path of the file, or why there is none: no episode may fail because its end cannot be written.
        """
        rows = [{k: _plain(v[env]) for k, v in s.items()} for s in self.states]
        seed, scene = int(world.chance.seed[env]), world.specs[env].name
        name = f"hazard_ms_sim_error_{re.sub('[^A-Za-z0-9_-]', '_', scene)[:LONGEST_NAME]}_{seed}_"
        text = json.dumps({"scene": scene, "seed": seed, "names": world.names[env], "states": rows})
        try:
            return _written(name, text)
        except OSError as error:
            reason = error.strerror or str(error)
            return f"not written: {reason}; set HAZARD_MS_DUMPS to a folder with free space that you may write to"


def _written(name: str, text: str) -> str:
    """Path of a new file with `text`, which only we may read, and whose name begins with `name`.

    Raises OSError where it cannot be written; then there is none.
    """
    folder = os.environ.get("HAZARD_MS_DUMPS")
    if folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
    file, path = tempfile.mkstemp(".json", name, folder or tempfile.mkdtemp(prefix="hazard_ms_dump_"))
    try:
        with open(file, "w", encoding="utf-8") as opened:
            opened.write(text)
    except OSError:
        os.unlink(path)
        raise
    return path


def _plain(values: Tensor) -> Any:
    """Numbers as nested lists for JSON, None in place of those that are not finite."""
    flat = [x if math.isfinite(x) else None for x in values.flatten().tolist()]
    if values.ndim == 0:
        return flat[0]
    width = values.shape[-1]
    return flat if values.ndim == 1 else [flat[i : i + width] for i in range(0, len(flat), width)]
