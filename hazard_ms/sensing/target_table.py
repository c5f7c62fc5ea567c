"""Table of the things to rescue, as agents are told of them: names, values and properties.

It never holds their places, which an agent must see for itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.gathering import tell
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES


@dataclass(frozen=True)
class Target:
    """One thing to rescue, as the agent is told of it."""

    index: int  # index along B, as in the segmentation and in `SemanticMap.objects`
    name: str
    category: str
    value: float  # 1 or 5
    flammable: bool
    waterproof: bool
    ignition_temperature: float  # [C]
    rescued: bool = False
    held: bool = False
    damaged: bool = False  # whether it was damaged when last seen
    belief: float = 1.0  # the chance that it is what it seems to be, and there: 1 with the truth


class TargetTable:
    """The targets of E scenes, in T columns: `index`, [E, T], along B; -1 where the scene has fewer targets."""

    def __init__(self, world: World, slots: int | None = None) -> None:
        """Make the table of the targets of `world` with T = `slots` columns, so that all scenes give the same shape.

        None: as many columns as the scene with the most targets needs. Raises ValueError for too few `slots`.
        """
        rows = [row.nonzero()[:, 0] for row in world.target]
        most = max(len(row) for row in rows) if slots is None else slots
        if max(len(row) for row in rows) > most:
            raise ValueError(f"a scene must have at most {most} targets, got {max(len(row) for row in rows)}")
        self.names = tuple(tuple(world.names[e][int(b)] for b in row) for e, row in enumerate(rows))
        self.index = torch.full((world.num_envs, most), -1, dtype=torch.int64, device=world.device)
        for e, row in enumerate(rows):
            self.index[e, : len(row)] = row
        self.there = self.index >= 0
        self._absent, self._launches = ~self.there, world.launches
        self._layouts: dict[tuple[int, ...], tuple[Tensor, Tensor]] = {}  # by the widths of terms, see `told`
        starts = torch.arange(world.num_envs, device=world.device)[:, None] * world.num_bodies
        self._row = (starts + self.index.clamp(min=0)).flatten()  # in a list of the things of all scenes

    def of(self, of_things: Tensor) -> Tensor:
        """Numbers of the targets, [E, T, ...], taken from those of all things, [E, B, ...]; 0 without a target."""
        taken = of_things.flatten(0, 1).index_select(0, self._row).view(*self.index.shape, *of_things.shape[2:])
        absent = self._absent if taken.ndim == 2 else self._absent[..., None]
        return taken.masked_fill_(absent, 0)

    @property
    def slots(self) -> int:
        """Number of columns, T."""
        return self.index.shape[1]

    def told(self, of_things: Tensor, widths: Sequence[int]) -> Tensor:
        """Numbers of the targets, [E, T K], taken from those of all things, [E, B, K] [-]; 0 without a target.

        They come one term after the other, target by target; `widths` says how many of the K numbers each term has.
        """
        layout = self._layouts.get(tuple(widths))
        if layout is None:
            first = [sum(widths[:k]) for k, width in enumerate(widths) for _ in range(width)]
            wide = [width for width in widths for _ in range(width)]
            layout = torch.tensor(first, device=of_things.device), torch.tensor(wide, device=of_things.device)
            self._layouts[tuple(widths)] = layout
        environments, count = self.index.shape
        made = of_things.new_empty(environments, count * of_things.shape[2])
        size = (environments, count, of_things.shape[2])
        self._launches.run(tell, size, of_things.contiguous(), self.index, *layout, made)
        return made

    def rows(self, world: World, env: int = 0, damaged: frozenset[int] | set[int] = frozenset()) -> tuple[Target, ...]:
        """The targets of scene `env`.

        `damaged` holds the indices along B of things that were damaged when last seen (`SemanticMap.seen_damaged`).
        """
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
