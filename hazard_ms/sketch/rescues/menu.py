"""The options of N rescues at once: the same numbers, slots and masks as `hazard_ms.skills.options.options`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.skills.options.landmarks import MOST_VISITS
from hazard_ms.skills.options.options import (
    CART,
    END,
    FIRE,
    FIRE_GIVE_UP,
    FIRST,
    GIVE_UP,
    LANDMARK,
    LANDMARK_SLOTS,
    LOOK,
    TOOL,
    option_count,
)

# Border around a landmark: what furniture hides for good, and what each of the spots around it adds until it was seen.
# In 500 recorded rescues it falls from 7 m on average at the start to 3 m at the end [measured].
HIDDEN_EDGE, SPOT_EDGE = 2.5, 3.4  # [m]


def edges(stack: Stack, state: Rescues) -> Floats:
    """Length of the border to unexplored floor around each landmark [m], [N, L]."""
    unseen = stack.all_spots[state.scene] & ~state.spots
    return HIDDEN_EDGE + SPOT_EDGE * np.bitwise_count(unseen)


def distances(stack: Stack, state: Rescues, site: Ints) -> Floats:
    """Distance from each robot to `site` [N, ...], [N, ...] [m]."""
    extra = (slice(None), *(None,) * (site.ndim - 1))
    off = stack.position[state.scene[extra], site] - state.place[extra]
    return np.sqrt((off**2).sum(-1))


def landmark_slots(stack: Stack, state: Rescues) -> Ints:
    """The best landmarks of each rescue, best first, as `landmarks` ranks them: [N, LANDMARK_SLOTS]; -1 where none."""
    made = np.full((len(state.frame), LANDMARK_SLOTS), -1)
    edge = edges(stack, state)
    first = state.known.shape[1] - edge.shape[1]
    tempting = state.known[:, first:] & (state.visits < MOST_VISITS)
    away = distances(stack, state, stack.landmark_site[state.scene])
    score = np.where(tempting, edge / (1.0 + away) / (1 + state.visits) ** 2, 0.0)
    order = np.argsort(-score, axis=1, kind="stable")[:, :LANDMARK_SLOTS]
    best = np.take_along_axis(score, order, axis=1)
    made[:, : order.shape[1]] = np.where(best > 0.0, order, -1)
    return made


def mask(stack: Stack, state: Rescues, slots: Ints, stop: bool) -> Bools:
    """Mask of the options that can be chosen, [N, A]; `slots`: see `landmark_slots`; `stop`: whether that can be."""
    targets, carts = stack.value.shape[1], stack.cart_site.shape[1]
    made = np.zeros((len(state.frame), option_count(stack.measures)), bool)
    free, running = (state.held < 0)[:, None], ~state.over
    trying = state.known[:, : targets + carts] & (state.failures < GIVE_UP)
    made[:, :targets] = free & trying[:, :targets] & (state.rescued_at < 0) & stack.there[state.scene]
    made[:, FIRST[CART] : FIRST[CART] + carts] = ~free & trying[:, targets:]
    made[:, FIRST[LANDMARK] : FIRST[LANDMARK] + LANDMARK_SLOTS] = slots >= 0
    made[:, FIRST[END]] = stop
    made[:, FIRST[LOOK]] = ~state.looked | ~made[:, : FIRST[LOOK]].any(axis=1)
    return made & running[:, None]


def offer_measures(made: Bools, stack: Stack, state: Rescues, tool: Ints) -> None:
    """Set in the masks `made` [N, A] which measures can be taken with the extinguisher `tool` [N], -1 for none."""
    ready, fires = (tool >= 0) & (state.held < 0) & ~state.over, stack.fire_site.shape[1]
    burns = state.fire_known & (state.out_at < 0) & (state.fire_failures < FIRE_GIVE_UP) & stack.fire_there[state.scene]
    made[:, FIRST[FIRE] : FIRST[FIRE] + fires] = ready[:, None] & burns
    made[:, FIRST[TOOL]] = ready & (state.armed != tool)


def refuse_start(scenes: Ints, seeds: Ints, rows: Ints, count: int) -> None:
    """Check `scenes`, numbers below `count`, and `seeds` of episodes that begin at `rows`: [R] each.

    Raises ValueError for other shapes, and for scenes out of range.
    """
    if not scenes.shape == seeds.shape == rows.shape:
        raise ValueError(f"scene and seeds must have shape {rows.shape}, got {scenes.shape} and {seeds.shape}")
    if len(scenes) and not 0 <= scenes.min() <= scenes.max() < count:
        raise ValueError(f"scene must be from 0 to {count - 1}, got {scenes.max()}")


def checked(option: ArrayLike, count: int, options: int) -> Ints:
    """Columns of masks [N, A], one for each of N = `count` rescues, with A = `options`.

    Raises ValueError for anything else.
    """
    chosen = np.asarray(option)
    if chosen.shape != (count,) or chosen.dtype.kind not in "iu":
        raise ValueError(f"option must be {count} whole numbers, got {chosen!r:.100}")
    if chosen.min() < 0 or chosen.max() >= options:
        raise ValueError(f"option must be from 0 to {options - 1}, got {chosen.min()} to {chosen.max()}")
    return chosen
