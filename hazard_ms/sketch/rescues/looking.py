"""Looks of N rescues: what the robot gets to know from where it is, and where it faces."""

from __future__ import annotations

import numpy as np

from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.sketch.fires.fates import damaged_at, levels_at
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.sketch.timeline import STRIDE

HALF_VIEW = np.cos(np.pi / 3.0)  # cosine of half the angle of view of the head camera, 120 degrees
# Cosine of how far from the middle of its best picture a thing is in a look around, which takes one every 30 degrees:
# 45 to 60 degrees. A flat picture shows things at an angle larger, by 1 / cosine^3.
BEST_OF_TURN = np.cos(np.deg2rad(52.5))
NO_DISTANCE = 1e-9  # below which a thing is where the robot is, and not in the picture [m]


def sample(stack: Stack, frame: Ints) -> Ints:
    """The number of the sample of places at each `frame`, [...]."""
    return np.minimum(frame // STRIDE, stack.target_site.shape[1] - 1)


def stands(stack: Stack, scene: Ints, points: Floats) -> Ints:
    """The stands that are nearest to `points` [m], [R, ..., 2], in the scenes `scene` [R]: [R, ...]."""
    extra = (slice(None), *(None,) * (points.ndim - 2))
    shape = stack.grid_shape[scene]
    at = (points - stack.grid_origin[scene][extra]) / stack.grid_cell[scene][extra][..., None]
    x = np.minimum(np.maximum(at[..., 0].astype(np.int64), 0), shape[:, 1][extra] - 1)
    y = np.minimum(np.maximum(at[..., 1].astype(np.int64), 0), shape[:, 0][extra] - 1)
    return np.asarray(stack.stand_of[scene[extra], y * shape[:, 1][extra] + x], dtype=np.int64)


def target_site(stack: Stack, state: Rescues, rows: Ints, target: Ints, frame: Ints) -> Ints:
    """The sites of one `target` [R] of each of `rows` [R] at `frame` [R], [R]."""
    laid = state.laid[rows, target]
    return np.where(laid >= 0, laid, stack.target_site[state.scene[rows], sample(stack, frame), target])


def look(
    stack: Stack, state: Rescues, rows: Ints, points: Floats, facing: Floats | None, frame: Ints, missed: Bools | None
) -> None:
    """Look around from Q `points` [m], [R, Q, 2], at `frame` [R, Q], and remember what is seen.

    `facing` [rad], [R, Q]: headings; None: all around. `missed` [R, J]: things that are overlooked; None: none.
    """
    scene = state.scene[rows]
    of = scene[:, None, None]
    targets, carts = stack.value.shape[1], stack.cart_site.shape[1]
    laid = state.laid[rows][:, None]
    moving = stack.target_site[scene[:, None], sample(stack, frame)]
    still = np.concatenate([stack.cart_site[scene], stack.landmark_site[scene]], axis=1)[:, None]
    shape = (*moving.shape[:2], still.shape[-1])
    site = np.concatenate([np.where(laid >= 0, laid, moving), np.broadcast_to(still, shape)], axis=2)
    stand = stands(stack, scene, points)
    there = (state.rescued_at[rows] < 0) & stack.there[scene]
    there[np.arange(len(rows)), state.held[rows]] &= state.held[rows] < 0
    exists = np.concatenate([there, stack.cart_there[scene], stack.mark_there[scene]], axis=1)
    if missed is not None:
        exists &= ~missed
    pixels = np.where(exists[:, None], stack.pixels[of, stand[:, :, None], site], np.float16(0.0))
    floor = stack.spots[scene[:, None], stand]
    if facing is None:
        seen = pixels >= SEEN_PIXELS * BEST_OF_TURN**3
    else:
        off = stack.position[of, site] - points[:, :, None]
        along = off[..., 0] * np.cos(facing)[..., None] + off[..., 1] * np.sin(facing)[..., None]
        cosine = along / np.maximum(np.sqrt((off**2).sum(-1)), NO_DISTANCE)
        ahead = cosine >= HALF_VIEW
        seen = ahead & (pixels >= SEEN_PIXELS * cosine**3)
        floor = np.where(ahead[:, :, targets + carts :], floor, np.uint16(0))
    state.spots[rows] |= np.bitwise_or.reduce(floor, axis=1)
    state.known[rows] |= seen.any(axis=1)
    _remember(stack, state, rows, seen[:, :, :targets], site, frame)


def _remember(stack: Stack, state: Rescues, rows: Ints, seen: Bools, site: Ints, frame: Ints) -> None:
    """Keep the newest of the sightings of targets, `seen` [R, Q, T] at `site` [R, Q, J] and `frame` [R, Q]."""
    row, target = np.nonzero(seen.any(axis=1))
    if not len(row):
        return
    newest = seen.shape[1] - 1 - np.argmax(seen[row, ::-1, target], axis=1)
    when, who = frame[row, newest], rows[row]
    later = when > state.seen_frame[who, target, 0]
    old, kept = who[later], target[later]
    state.seen_frame[old, kept, 1] = state.seen_frame[old, kept, 0]
    state.seen_level[old, kept, 1] = state.seen_level[old, kept, 0]
    state.seen_site[who, target] = site[row, newest, target]
    state.seen_frame[who, target, 0] = when
    state.seen_level[who, target, 0] = levels_at(stack, state, who, target, when)
    damaged = damaged_at(stack, state, who)[np.arange(len(who)), target]
    state.seen_damaged[who, target] = (damaged >= 0) & (damaged <= when)
