"""Episodes in which nobody acts and nothing moves, many at once on any device, without a simulator.

All things rest at their places; the forces on them are computed before each physics step, and move nothing. Everything
else of a frame is real: the hazards advance, and damage is recorded.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.presets import FREQUENCIES
from hazard_ms.simulation import building
from hazard_ms.simulation.world import World
from hazard_ms.tasks import task_of
from hazard_ms.tasks.episode.episode import Episode

SPLIT = "train"  # whose scenes a batch has, each in turn [ours]


class Resting:
    """A simulator's handles of bodies that rest whatever happens; it keeps what they were pushed with last."""

    def __init__(self, world: World) -> None:
        self.force, self.torque = (torch.zeros_like(world.position) for _ in range(2))  # [N], [N m]
        self._asleep = torch.ones(world.num_envs, 0, dtype=torch.bool)

    def push(self, force: Tensor, torque: Tensor | None) -> None:
        """Keep force [N] and torque [N m], [E, B, 3]."""
        self.force[:], self.torque[:] = force, 0.0 if torque is None else torque

    def let_go(self) -> None:
        """Forget the last push: where nothing pushes, none comes."""
        self.force.zero_()
        self.torque.zero_()

    def asleep(self) -> Tensor:
        """No bodies are told apart: bool [E, 0]."""
        return self._asleep

    def read(self, world: World) -> None:
        """All is where it was."""

    def place(self, rows: Tensor, base: Tensor, rotation: Tensor) -> None:
        """All is where it was, as positions [m], [E, B, 3], and rotations, [E, B, 4], say."""

    def loosen(self, loose: Tensor) -> None:
        """Do nothing with the mask `loose` [E, B]: furniture rests, too."""

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Nothing moves, frozen or not, from positions [m], [E, B, 3], and rotations, [E, B, 4]."""

    def put_to_sleep(self, asleep: Tensor) -> None:
        """No bodies are told apart: bool [E, 0]."""


class Batch:
    """Episodes of one task; those of a batch have the seeds from `seed` on."""

    def __init__(self, env_id: str, num_envs: int, device: torch.device | str, physics: str, seed: int = 0) -> None:
        """Begin `num_envs` episodes on a `device`, with the `physics` of a preset.

        Raises ValueError for unknown names.
        """
        task = task_of(env_id, physics)
        names = tuple(task.scenes(SPLIT))
        specs = [task.build(name) for name in names[:num_envs]]
        world = building.make_world(tuple(specs[k % len(specs)] for k in range(num_envs)), torch.device(device))
        self.handles = world.handles = Resting(world)
        self.episode = Episode(world, task.hazards, task.safe_place)
        self.control, self.rate = FREQUENCIES[physics]
        rows = torch.arange(num_envs, device=world.device)
        self.episode.begin(rows, seed + rows)
        self.episode.begin_hazards(rows)

    def step(self) -> None:
        """Let a frame pass."""
        for _ in range(self.rate // self.control):
            self.handles.let_go()
            self.episode.push(1.0 / self.rate)
        self.episode.advance(1.0 / self.control)
