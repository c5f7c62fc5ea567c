"""Features of fires and extinguishers in N rescues, as `hazard_ms.skills.options.feature_columns` has them."""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.rescues.places import place_of, seen_from
from hazard_ms.sketch.rescues.scene import Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.skills.options.fires import FIRE_SLOTS, THREAT


def fires(stack: Stack, state: Rescues) -> Floats:
    """Rows of fires, [N, slots, D]."""
    scene, count = state.scene, stack.fire_site.shape[1]
    known = state.fire_known & (state.out_at < 0) & stack.fire_there[scene]
    ahead, left = seen_from(state, stack.fire_place[scene])
    walk = place_of(stack, state, stack.fire_site[scene], known)[2]
    age = state.frame[:, None] - state.fire_frame
    columns = [known, ahead, left, walk, state.fire_flames, age, _near(stack, state), state.fire_failures]
    made = np.zeros((len(scene), FIRE_SLOTS, len(columns)))
    made[:, :count] = np.where(known[..., None], np.stack(columns, axis=-1), 0.0)
    return made


def _near(stack: Stack, state: Rescues) -> Floats:
    """The value of known whole targets within THREAT of each fire that are not rescued, [N, F]."""
    targets = state.value.shape[1]
    place = stack.position[state.scene[:, None], state.seen_site]
    away = np.hypot(*np.moveaxis(place[:, None] - stack.fire_place[state.scene][:, :, None], -1, 0))
    there = state.known[:, :targets] & (state.rescued_at < 0) & (np.arange(targets) != state.held[:, None])
    worth = state.value * (there & ~state.seen_damaged)
    return np.asarray((worth[:, None] * (away <= THREAT)).sum(axis=-1))


def tools(stack: Stack, state: Rescues, tool: Ints) -> Floats:
    """The row about the extinguisher `tool` [N] that can be used, -1 for none: [N, 1, D]."""
    rows, known = np.arange(len(tool)), tool >= 0
    held = known & (state.armed == tool)
    own = np.maximum(tool, 0)
    site = state.tool_site[rows, own][:, None] if state.tool_site.shape[1] else np.zeros((len(rows), 1), np.int64)
    left = state.tool_left[rows, own] if state.tool_left.shape[1] else np.zeros(len(rows))
    place = place_of(stack, state, site, (known & ~held)[:, None])
    out = (state.out_at >= 0).sum(axis=1)
    columns = [known, held, *(part[:, 0] for part in place), np.where(known, left, 0.0), out]
    return np.stack(columns, axis=-1)[:, None].astype(np.float64)
