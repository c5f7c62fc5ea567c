"""Things that really lie where an agent believes one to be: a hand meets these."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.world import World


def loose_things(world: World) -> list[int]:
    """Indices along B of what a hand can meet in the first scene: things that can be moved and are not put away."""
    free = world.movable & world.exists & ~world.away & ~world.floats
    there: list[int] = np.flatnonzero(free[0].cpu().numpy()).tolist()
    return there


def nearest_to(world: World, there: Sequence[int], place: NDArray[np.floating], within: float, axes: int) -> int:
    """The thing among those at `there` along B that is nearest to a `place` [m], [3]; -1: none is `within` [m].

    Of places only the first `axes` coordinates count.
    """
    if not len(there):
        return -1
    far = np.linalg.norm(world.position[0, there].cpu().numpy()[:, :axes] - place[:axes], axis=-1)
    nearest = int(np.argmin(far))
    return there[nearest] if far[nearest] < within else -1
