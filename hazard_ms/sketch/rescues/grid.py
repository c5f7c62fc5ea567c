"""The grid over the floor of a scene, and its stands: places from which ways begin and looks are taken."""

from __future__ import annotations

from typing import Any

import numpy as np

from hazard_ms.sketch.rescues.scene import Floats
from hazard_ms.spec import Room

INDOOR_CELL, OUTDOOR_CELL = 0.5, 1.0  # edges of the cells, in each of which sight is the same [m] [ours]


def grid_of(room: Room, floor: Floats) -> dict[str, Any]:
    """The cells over `room`, and the stands: in each cell the place of the free `floor` nearest to its middle.

    `floor` [m], [M, 2].
    """
    edge = OUTDOOR_CELL if room.open_air else INDOOR_CELL
    border = room.beyond if room.open_air else 0.0
    shape = (int(np.ceil((room.size[1] + 2 * border) / edge)), int(np.ceil((room.size[0] + 2 * border) / edge)))
    at = (floor + border) / edge
    order = np.argsort(np.abs(at % 1.0 - 0.5).max(axis=1), kind="stable")
    x, y = np.clip(np.floor(at[order]).astype(int), 0, np.array(shape[::-1]) - 1).T
    _, first = np.unique(y * shape[1] + x, return_index=True)
    stand = floor[order][first]
    y, x = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    middle = (np.stack([x, y], axis=-1) + 0.5) * edge - border
    nearest = np.hypot(*np.moveaxis(middle[:, None] - stand, -1, 0)).argmin(axis=1)
    return {
        "stand": stand,
        "stand_of": nearest,
        "grid_origin": (-border, -border),
        "grid_cell": edge,
        "grid_shape": shape,
    }
