"""The map of `hazard_ms.skills.options.paper_map`, drawn of what robots in the sketch know.

The sketch has no depth images, so that of the planes

    explored   holds blocks of 3 x 3 cells around those of 16 places near each landmark that were seen, up to 5 m away
    height     is 0 everywhere: it is MISSING
    level k    is known where targets were seen, and 0 elsewhere

The other planes are as in the simulator, but for what was seen in one of them only. Policies that learn here must not
read MISSING planes, and read levels at targets only.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.paper.moves import SixSketch
from hazard_ms.sketch.rescues.scene import SPOTS, Floats, spot_offsets
from hazard_ms.skills.options.paper_map import (
    CELL,
    CELLS,
    EXPLORED,
    HEIGHT,
    MapLayout,
    Planes,
    Seen,
    cells,
    centre_at,
    marks,
)

MISSING = (HEIGHT,)  # planes that need depth images
AROUND_A_SPOT = 1  # cells on each side of a place that was seen that count as seen: its share of the floor


class MapMaker:
    """Draws maps of rescues as `MapLayout` draws those of decisions."""

    def __init__(self, ranges: Sequence[tuple[float, float]]) -> None:
        """Make it for a task; `ranges`: ends of each hazard's usual level, in its unit."""
        self.layout = MapLayout(ranges)

    def draw(self, sketch: SixSketch) -> Planes:
        """The maps of all rescues, float32 [N, 4 + H, 64, 64]."""
        stack, state = sketch.stack, sketch.state
        made, scene = self.layout.blank(len(state.frame)), state.scene
        centre = centre_at(stack.position[scene, 0])
        self._explore(made, sketch, centre)
        targets, carts = state.value.shape[1], stack.cart_site.shape[1]
        site = np.concatenate([state.seen_site, stack.cart_site[scene]], axis=1)
        level = np.full((*site.shape, len(self.layout.ranges)), np.nan)
        level[:, :targets] = state.seen_level[:, :, 0]
        seen = Seen(
            centre,
            state.place,
            state.heading,
            state.held,
            sketch.known()[:, : targets + carts],
            stack.position[scene[:, None], site],
            marks(targets, carts),
            level,
        )
        self.layout.draw(made, seen)
        return made

    def _explore(self, made: Planes, sketch: SixSketch, centre: Floats) -> None:
        """Mark the floor that was seen around landmarks."""
        stack, state = sketch.stack, sketch.state
        bits: NDArray[np.bool_] = (state.spots[..., None] >> np.arange(SPOTS, dtype=np.uint16)) & 1 > 0
        row, mark, spot = np.nonzero(bits)
        scene = state.scene[row]
        place = stack.position[scene, stack.landmark_site[scene, mark]] + spot_offsets()[spot]
        inside = (np.abs(place - centre[row]) < CELLS * CELL / 2.0).all(axis=1)
        row = row[inside]
        y, x = cells(place[inside], centre[row])
        for down in range(-AROUND_A_SPOT, AROUND_A_SPOT + 1):
            for right in range(-AROUND_A_SPOT, AROUND_A_SPOT + 1):
                made[row, EXPLORED, np.clip(y + down, 0, CELLS - 1), np.clip(x + right, 0, CELLS - 1)] = 1.0
