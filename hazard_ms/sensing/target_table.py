"""What an agent is told about the things to rescue: names, values, properties. Never where they are: that it must see."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.catalogue import CATEGORIES
from hazard_ms.world import World

PROPERTIES = ("flammable", "waterproof", "ignition_temperature")  # attributes of the catalogue; the last in degrees Celsius


@dataclass(frozen=True)
class Target:
    """One thing to rescue, as the agent is told of it."""

    index: int  # along B, as in the segmentation and in `SemanticMap.objects`
    name: str
    category: str
    value: float  # 1 or 5
    flammable: bool
    waterproof: bool
    ignition_temperature: float  # [C]
    rescued: bool = False
    held: bool = False
    damaged: bool = False  # when it was last seen


class TargetTable:
    """The targets of E scenes, T columns: as many as `slots` says, else as the scene with the most has.

    index       [E, T]     index along B; -1 where the scene has fewer targets
    value       [E, T]     1 or 5; 0 where there is none
    properties  [E, T, 3]  flammable, waterproof (0 or 1), ignition temperature [C]
    """

    def __init__(self, world: World, slots: int | None = None) -> None:
        """`slots`: T, so that observations have one shape in every scene; None: as many as the scene with the most needs."""
        rows = [row.nonzero()[:, 0] for row in world.target]
        most = max(len(row) for row in rows) if slots is None else slots
        if max(len(row) for row in rows) > most:
            raise ValueError(f"a scene has {max(len(row) for row in rows)} targets; {most} slots are allowed")
        self.names = tuple(tuple(world.names[e][int(b)] for b in row) for e, row in enumerate(rows))
        self.index = torch.full((world.num_envs, most), -1, dtype=torch.int64, device=world.device)
        for e, row in enumerate(rows):
            self.index[e, : len(row)] = row
        self.there = self.index >= 0
        self._column = self.index.clamp(min=0)
        self.value = self.of(world.value)
        self.properties = torch.stack([self.of(world.lookup(name)) for name in PROPERTIES], dim=-1)

    def of(self, of_things: Tensor) -> Tensor:
        """The targets' entries, [E, T, ...], of a quantity of all things, [E, B, ...]; 0 or False where there is no target."""
        rows = torch.arange(self.index.shape[0], device=self.index.device)[:, None]
        taken = of_things[rows, self._column]
        there = self.there.reshape(self.there.shape + (1,) * (taken.ndim - 2))
        return torch.where(there, taken, torch.zeros_like(taken))

    def observe(self, world: World) -> dict[str, Tensor]:
        """The table as tensors of float32: value [E, T], properties [E, T, 3], held [E, T], rescued [E, T]."""
        return {
            "value": self.value,
            "properties": self.properties,
            "held": self.of(world.held).float(),
            "rescued": self.of(world.safe).float(),
        }

    def rows(self, world: World, env: int = 0, damaged: frozenset[int] | set[int] = frozenset()) -> tuple[Target, ...]:
        """The targets of one scene. `damaged`: indices along B of those last seen damaged, `SemanticMap.seen_damaged`."""
        made = []
        for b in self.index[env][self.there[env]].tolist():
            name = world.names[env][b]
            category = list(CATEGORIES)[int(world.category[env, b])]
            row = CATEGORIES[category]
            made.append(
                Target(
                    index=b,
                    name=name,
                    category=category,
                    value=float(world.value[env, b]),
                    flammable=bool(row.flammable),
                    waterproof=bool(row.waterproof),
                    ignition_temperature=float(row.ignition_temperature),
                    rescued=bool(world.safe[env, b]),
                    held=bool(world.held[env, b]),
                    damaged=b in damaged,
                )
            )
        return tuple(made)
