"""Places at which the robots of a team start in the sketch, as near as its stands come to those of the simulator."""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.rescues.scene import Floats, Stack

GAP = 0.3  # least gap between two robots at the start [m], as hazard_ms.env.placing.APART


def starts(stack: Stack, robots: int, radius: float) -> Floats:
    """Places [m] of `robots` of a `radius` [m] in each of W scenes, [W, robots, 2]: the first where the scene says.

    Each further one gets the stand nearest to it from which there is a way to it, GAP from the others. Raises
    ValueError for a scene in which there is none.
    """
    made = np.zeros((len(stack.names), robots, 2))
    for scene, name in enumerate(stack.names):
        first = made[scene, 0] = stack.position[scene, 0]
        stand = stack.stand[scene][np.isfinite(stack.travel[scene, :, 0])]
        stand = stand[np.argsort(np.hypot(*(stand - first).T), kind="stable")]
        for number in range(1, robots):
            away = np.hypot(*np.moveaxis(stand[:, None] - made[scene, :number], -1, 0)).min(axis=1)
            free = np.flatnonzero(away >= 2.0 * radius + GAP)
            if not len(free):
                raise ValueError(f"robots must be at most {number} in {name}, got {robots}")
            made[scene, number] = stand[free[0]]
    return made
