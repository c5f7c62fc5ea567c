"""Distances of N rescues: frames to a site, what is in sight, and where a thing that moves can be met."""

from __future__ import annotations

import numpy as np

from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.sketch.rescues.looking import sample, target_site
from hazard_ms.sketch.rescues.scene import LOOKS, Bools, Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.sketch.timeline import STRIDE
from hazard_ms.sketch.travel.geodesic import on_the_spot
from hazard_ms.sketch.travel.ways import TURN, WALK


def ahead(stack: Stack, state: Rescues, rows: Ints, goal: Ints) -> Floats:
    """Frames at usual pace from where the robots are to the sites `goal` [R, ...]: [R, ...]; infinite without a way.

    It is the time from the nearest stand, less what the robot is ahead of that.
    """
    extra = (slice(None), *(None,) * (goal.ndim - 1))
    off = (state.place[rows] - stack.stand[state.scene[rows], state.stand[rows]])[extra]
    scene, stand = state.scene[rows][extra], state.stand[rows][extra]
    first = stack.first[scene, stand, goal]
    gained = WALK * (off[..., 0] * np.cos(first) + off[..., 1] * np.sin(first))
    walked = np.maximum(stack.travel[scene, stand, goal] - gained, 0.0)
    turned = on_the_spot(first - state.heading[rows][extra])
    return np.where(state.site[rows][extra] == goal, 0.0, walked + TURN * turned)


def in_sight(stack: Stack, state: Rescues, rows: Ints, target: Ints) -> Bools:
    """Whether the robots could see the `target` [R] of each from where they are, [R]."""
    scene = state.scene[rows]
    site = target_site(stack, state, rows, target, state.frame[rows])
    return np.asarray(stack.pixels[scene, state.stand[rows], site] >= SEEN_PIXELS)


def apart(stack: Stack, state: Rescues, rows: Ints, one: Ints, other: Ints) -> Floats:
    """Distance between the sites `one` [R] and `other` [R], [R] [m]."""
    scene = state.scene[rows]
    return np.asarray(np.hypot(*(stack.position[scene, one] - stack.position[scene, other]).T), dtype=np.float64)


def meeting(stack: Stack, state: Rescues, rows: Ints, target: Ints) -> Ints:
    """The first site on the way of the `target` [R] of each at which the robot can be before it has gone on, [R].

    Where it cannot be met, it is the site where the target comes to rest.
    """
    now = target_site(stack, state, rows, target, state.frame[rows])
    samples = stack.target_site.shape[1]
    if samples == 1:
        return now
    course = stack.target_site[state.scene[rows], :, target]
    course = np.where(state.laid[rows, target][:, None] >= 0, now[:, None], course)
    way = ahead(stack, state, rows, course)
    leaves = (np.arange(samples) + 1.0) * STRIDE
    leaves[-1] = np.inf
    there = state.frame[rows][:, None] + way * state.pace[rows][:, None]
    met = (there < leaves) & (np.arange(samples) >= sample(stack, state.frame[rows])[:, None])
    first = np.where(met.any(axis=1), np.argmax(met, axis=1), samples - 1)
    return np.asarray(course[np.arange(len(rows)), first], dtype=np.int64)


def journey(stack: Stack, state: Rescues, rows: Ints, goal: Ints, share: Floats) -> tuple[Floats, Floats]:
    """Places [m], [R, Q, 2], and headings [rad], [R, Q], of the looks on the way to the sites `goal` [R].

    Only the first `share` [R] of the way is walked; the last look is at its end.
    """
    scene, stand, whole = state.scene[rows], state.stand[rows], np.arange(len(rows))[:, None]
    path = np.concatenate([state.place[rows][:, None], stack.way[scene, stand, goal]], axis=1)
    at = np.arange(1, LOOKS + 1) * share[:, None]  # of the LOOKS pieces of the way
    piece = np.minimum(at.astype(np.int64), LOOKS - 1)
    start, off = path[whole, piece], path[whole, piece + 1] - path[whole, piece]
    facing = np.arctan2(off[..., 1], off[..., 0])
    facing[:, -1] = np.where(share == 1.0, stack.last[scene, stand, goal], facing[:, -1])
    return start + (at - piece)[..., None] * off, facing
