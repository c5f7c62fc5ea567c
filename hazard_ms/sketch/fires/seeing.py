"""Looks of N rescues for fires and extinguishers, as `hazard_ms.sketch.rescues.looking` has them for other things."""

from __future__ import annotations

import numpy as np

from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.sketch.rescues.looking import BEST_OF_TURN, HALF_VIEW, NO_DISTANCE, stands
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.sketch.timeline import STRIDE

FIRST_SEEN = 1  # flames from which a fire stands out on the map [measured in two homes]


def flames_at(stack: Stack, state: Rescues, rows: Ints, frame: Ints) -> Ints:
    """The number of flames of each fire of `rows` [R] at `frame` [R, ...]; 0 for what is out: [R, ..., K]."""
    extra = (slice(None), *(None,) * (frame.ndim - 1))
    scene = state.scene[rows][extra]
    made = stack.flames[scene, np.minimum(frame // STRIDE, stack.flames.shape[1] - 1)]
    return np.where(state.out_at[rows][extra] >= 0, 0, made)


def look_for_fires(
    stack: Stack, state: Rescues, rows: Ints, points: Floats, facing: Floats | None, frame: Ints
) -> None:
    """Look from Q `points` [m], [R, Q, 2], at `frame` [R, Q], and remember fires and tools; `facing` [rad], [R, Q]."""
    scene = state.scene[rows]
    of, stand = scene[:, None], stands(stack, scene, points)
    burning = flames_at(stack, state, rows, frame)
    fire = stack.fire_seen[of, stand] & (burning >= FIRST_SEEN) & stack.fire_there[scene][:, None]
    at = np.broadcast_to(state.tool_site[rows][:, None], (*stand.shape, state.tool_site.shape[1]))
    pixels = stack.pixels[of[:, :, None], stand[:, :, None], at]
    lying = stack.tool_there[scene][:, None] & (np.arange(at.shape[-1]) != state.armed[rows][:, None, None])
    if facing is None:
        tool = pixels >= SEEN_PIXELS * BEST_OF_TURN**3
    else:
        ahead = _cosine(stack.fire_place[scene][:, None], points, facing)
        fire &= ahead >= HALF_VIEW
        cosine = _cosine(stack.position[of[:, :, None], at], points, facing)
        tool = (cosine >= HALF_VIEW) & (pixels >= SEEN_PIXELS * cosine**3)
    state.tool_known[rows] |= (tool & lying).any(axis=1)
    _remember(state, rows, fire, burning, frame)


def _cosine(places: Floats, points: Floats, facing: Floats) -> Floats:
    """The cosine of the angle at which `places` [m], [R, Q, K, 2], are off `facing` at `points` [m]: [R, Q, K]."""
    off = np.asarray(places) - points[:, :, None]
    along = off[..., 0] * np.cos(facing)[..., None] + off[..., 1] * np.sin(facing)[..., None]
    return np.asarray(along / np.maximum(np.sqrt((off**2).sum(-1)), NO_DISTANCE))


def _remember(state: Rescues, rows: Ints, seen: Bools, burning: Ints, frame: Ints) -> None:
    """Keep the newest of the sightings of fires, `seen` [R, Q, K] while so much was `burning` [R, Q, K]."""
    row, fire = np.nonzero(seen.any(axis=1))
    newest = seen.shape[1] - 1 - np.argmax(seen[row, ::-1, fire], axis=1)
    state.fire_known[rows[row], fire] = True
    state.fire_frame[rows[row], fire] = frame[row, newest]
    state.fire_flames[rows[row], fire] = burning[row, newest, fire]
