"""Places of sites as N robots see them, in the columns of features."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.rescues.pursuit import ahead
from hazard_ms.sketch.rescues.scene import Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.sketch.travel.geodesic import on_the_spot
from hazard_ms.sketch.travel.ways import TURN


def place_of(stack: Stack, state: Rescues, site: Ints, known: NDArray[np.bool_]) -> list[Floats]:
    """Distances ahead and to the left [m], and walking time without turns [frames], [N, S] each, of `site` [N, S].

    They are 0 where it is not `known`, [N, S].
    """
    rows = np.arange(len(site))
    forward, left = seen_from(state, stack.position[state.scene[:, None], site])
    frames = ahead(stack, state, rows, site)
    first = stack.first[state.scene[:, None], state.stand[:, None], site]
    turn = np.where(state.site[:, None] == site, 0.0, TURN * on_the_spot(first - state.heading[:, None]))
    parts = [forward, left, np.maximum(frames - turn, 0.0)]
    return [np.where(known, part, 0.0) for part in parts]


def seen_from(state: Rescues, points: Floats) -> tuple[Floats, Floats]:
    """Distances of `points` [m], [N, K, 2], ahead of each robot and to its left [m], [N, K] each."""
    off = points - state.place[:, None]
    c, s = np.cos(state.heading)[:, None], np.sin(state.heading)[:, None]
    return c * off[..., 0] + s * off[..., 1], c * off[..., 1] - s * off[..., 0]
