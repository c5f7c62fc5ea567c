"""Things that shelter from the wind, as far as a semantic map shows them, over the cells of the maps of lees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.hazards.wind.air import CELL, LOWEST
from hazard_ms.hazards.wind.shelter import BLOCK, FENCE, SOLIDITY
from hazard_ms.skills.decision import Decision

Array = NDArray[np.float32]
CUT = 2.4  # height from which what the map shows is cut off [m]: it drops what is higher than 2.5 m
HOUSE = 5.0  # height that is taken for what is cut off [m] [ours]
THIN = ("fence", "hedge")  # what has the wake of a fence; all else has that of a block


@dataclass(frozen=True, eq=False)
class Shelters:
    """Height [m], solidity and coefficient of the wake [-] of what stands over each cell, [Y, X] each."""

    corner: NDArray[np.float64]  # south-west corner of the cells [m], [2]
    height: Array
    solidity: Array
    coefficient: Array

    def differ(self, other: Shelters) -> int:
        """The number of cells in which something stands in one of the two alone."""
        if self.height.shape != other.height.shape:
            return self.height.size
        return int(((self.height > 0.0) != (other.height > 0.0)).sum())


def shelters(decision: Decision) -> Shelters:
    """The things that stand on the map of a decision and are no targets, [Y, X]; their heights are in [m]."""
    seen = decision.map
    step = round(float(CELL) / seen.cell)
    size = len(seen.height) // step * step
    names = [name.rpartition("_")[0] for name in decision.names]
    solid = np.array([SOLIDITY.get(name, 1.0) for name in names], np.float32)
    for target in decision.targets:
        solid[target.index] = 0.0
    wake = np.array([FENCE if name in THIN else BLOCK for name in names], np.float32) * solid
    tall = np.where(seen.height >= CUT, HOUSE, seen.height)[:size, :size].astype(np.float32)
    of = seen.object_id[:size, :size]
    tall = np.where((of >= 0) & (solid[of] > 0.0) & (tall >= float(LOWEST)), tall, 0.0)
    blocks = tall.reshape(size // step, step, size // step, step).transpose(0, 2, 1, 3).reshape(-1, step * step)
    best = blocks.argmax(1)
    rows = np.arange(len(best))
    things = of.reshape(size // step, step, size // step, step).transpose(0, 2, 1, 3).reshape(-1, step * step)
    height, thing = blocks[rows, best], things[rows, best]
    stands = height > 0.0
    shape = (size // step, size // step)
    made = (height, np.where(stands, solid[thing], 0.0), np.where(stands, wake[thing], 0.0))
    return Shelters(np.asarray(seen.origin, np.float64), *(part.reshape(shape).astype(np.float32) for part in made))
