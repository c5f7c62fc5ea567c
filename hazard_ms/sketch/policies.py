"""Agents that can be played in the sketch: their rules over options, as close as possible to those over actions.

They serve to compare the sketch with the real environment (`hazard_ms.sketch.fidelity`), where `hazard_ms.agents` has
them under the same names. They see what an agent sees: what was sighted, never what is.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hazard_ms.sketch.rescues.menu import distances
from hazard_ms.sketch.rescues.playing import Options
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import CART, END, FIRE, FIRST, LANDMARK, LOOK
from hazard_ms.spec.catalogue import DAMAGED_SHARE

# of the greedy agent (hazard_ms.agents.greedy), of which this is the sketch
WALKING = 1.0 / 62.0  # [m/frame]
HANDLING = 1.0  # what picking up costs, as a distance [m]
# of the rule agent (hazard_ms.agents.rule)
RULE_GIVES_UP = 2  # failures with one thing
LARGE = 12  # flames from which a fire is left alone (hazard_ms.agents.fighter)

Policy = Callable[[Sketch, np.random.Generator], Ints]


def greedy(sketch: Options, chance: np.random.Generator) -> Ints:
    """The known target of the lowest cost in each rescue, else the best landmark, else stop; [N].

    It looks around first. Nothing is drawn.
    """
    del chance
    return greedy_without(sketch, np.zeros(sketch.state.value.shape, bool))


def greedy_without(sketch: Options, left_out: Bools) -> Ints:
    """The options of `greedy` where the targets `left_out` [N, T] are left to others, [N]."""
    state = sketch.state
    targets = state.value.shape[1]
    away = distances(sketch.stack, state, state.seen_site) + HANDLING
    worth = state.value * np.where(state.seen_damaged | threatened(sketch, away), DAMAGED_SHARE, 1.0)
    cost = away * (1 + state.failures[:, :targets]) ** 2 / np.maximum(worth, 1e-9)
    return _chosen(sketch, np.where(left_out, np.inf, cost), _cart_costs(sketch), (state.frame == 0))


def nearest(sketch: Sketch, chance: np.random.Generator) -> Ints:
    """The nearest known target in each rescue, whatever its worth, else as `greedy`: [N]."""
    del chance
    state = sketch.state
    return _chosen(sketch, distances(sketch.stack, state, state.seen_site), _cart_costs(sketch), state.frame == 0)


def rule(sketch: Sketch, chance: np.random.Generator) -> Ints:
    """A random known target in each rescue, a random cart for it, else a random landmark, else a look around: [N]."""
    state = sketch.state
    targets = state.value.shape[1]
    failed = np.where(state.failures >= RULE_GIVES_UP, np.inf, 0.0)
    drawn = chance.random((len(state.frame), failed.shape[1] + sketch.slots.shape[1]))
    cost = drawn[:, : failed.shape[1]] + failed
    first = FIRST[LANDMARK] + np.argmax(np.where(sketch.slots >= 0, drawn[:, failed.shape[1] :], -1.0), axis=1)
    found = _chosen(sketch, cost[:, :targets], cost[:, targets:], state.frame == 0)
    searching = (found >= FIRST[LANDMARK]) & (found < FIRST[LOOK])
    found = np.where(searching, first, found)
    done = (state.rescued_at >= 0) | (state.value == 0.0)
    return np.where((found == FIRST[END]) & ~done.all(axis=1), FIRST[LOOK], found)


def fighter(sketch: Sketch, chance: np.random.Generator) -> Ints:
    """The known fire with the fewest flames in each rescue, if it can be put out; else as `greedy`: [N]."""
    made = greedy(sketch, chance)
    if not sketch.stack.measures:
        return made
    state, fires = sketch.state, sketch.stack.fire_site.shape[1]
    small = sketch.mask[:, FIRST[FIRE] : FIRST[FIRE] + fires] & (state.fire_flames < LARGE)
    first = np.where(small, state.fire_flames, LARGE).argmin(axis=1)
    fights = small.any(axis=1) & (state.frame > 0)
    return np.where(fights, FIRST[FIRE] + first, made)


POLICIES: dict[str, Policy] = {"greedy": greedy, "nearest": nearest, "rule": rule}


def threatened(sketch: Options, away: Floats) -> Bools:
    """Whether each target would be damaged after a walk of `away` [N, T] [m], by the line through its last sightings.

    [N, T].
    """
    state = sketch.state
    now, before = state.seen_frame[..., 0], state.seen_frame[..., 1]
    level, earlier = state.seen_level[:, :, 0], state.seen_level[:, :, 1]
    span = np.where(before >= 0, now - before, 1)
    rise = np.where((before >= 0)[..., None], level - earlier, 0.0) / np.maximum(span, 1)[..., None]
    later = state.frame[:, None] + away / WALKING - now
    return np.asarray((level + rise * later[..., None] >= sketch.stack.limit[state.scene]).any(axis=-1))


def _cart_costs(sketch: Options) -> Floats:
    """Distance to each cart, longer for each failure there, [N, C] [m]."""
    state = sketch.state
    failures = state.failures[:, state.value.shape[1] :]
    return distances(sketch.stack, state, sketch.stack.cart_site[state.scene]) * (1 + failures)


def _chosen(sketch: Options, targets: Floats, carts: Floats, look: Bools) -> Ints:
    """The option of the lowest cost among `targets` [N, T] and `carts` [N, C], else the first landmark, else stop: [N].

    `look` [N]: where to look around before anything else.
    """
    mask, made = sketch.mask, np.full(len(targets), FIRST[END])
    made[mask[:, FIRST[LANDMARK]]] = FIRST[LANDMARK]
    for first, costs in ((FIRST[CART], carts), (0, targets)):
        open_costs = np.where(mask[:, first : first + costs.shape[1]], costs, np.inf)
        if costs.shape[1]:
            best = np.argmin(open_costs, axis=1)
            found = np.isfinite(open_costs[np.arange(len(best)), best])
            made[found] = first + best[found]
    made[look & mask[:, FIRST[LOOK]]] = FIRST[LOOK]
    return made


def play(sketch: Sketch, policy: Policy, seed: int = 0) -> None:
    """Play all rescues of `sketch` to their ends; `seed` is that of the policy's own chance."""
    chance = np.random.default_rng(seed)
    while not sketch.state.over.all():
        sketch.step(policy(sketch, chance))
