"""The six actions of the original's learner: what each means, and when it is possible, for one rescue or for many.

    number   action
    0        to_target   one step of a walk, about a metre, to the nearest known target
    1        to_cart     one step to the nearest known cart
    2        pick_up     pick up the nearest known target
    3        drop        let go of what is in the hand: into the bag, or over the nearest cart
    4        explore     look around on the spot
    5        wander      walk to a random thing in sight, which is kept until it is reached

"Known" is what was seen and is remembered; a target that is rescued or in the hand is left out. A walk to a random
thing ends after 100 frames as every walk does, and goes on when the action is chosen again. Picking up and dropping
over a cart are possible from REACH on; the skills come nearer themselves. There is no action that ends the episode.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED

NAMES = ("to_target", "to_cart", "pick_up", "drop", "explore", "wander")
TO_TARGET, TO_CART, TAKE, LET_GO, LOOK, WANDER = range(len(NAMES))
COUNT = len(NAMES)
# Distance from the agent at which a target can be picked up, and a cart be dropped into [m] [ours]. Whatever its
# height, a thing is then within the 2.5 m of the shoulder at which these skills begin (docs/benchmark.md 3).
REACH = 2.0

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]


def nearest(metres: Floats, which: Bools) -> tuple[Ints, Floats]:
    """The nearest of K things in each of N rescues among those in `which` [N, K]: its number, and its distance [m].

    `metres`: distances of all of them [m], [N, K]. Number -1 and an infinite distance where there is none; [N] each.
    """
    if not metres.shape[1]:
        return np.full(len(metres), -1), np.full(len(metres), np.inf)
    away = np.where(which, metres, np.inf)
    found = np.argmin(away, axis=1)
    least = away[np.arange(len(away)), found]
    return np.where(np.isfinite(least), found, -1), least


def possible(to_target: Floats, to_cart: Floats, carts: Bools, holding: Bools, goal: Bools) -> Bools:
    """The mask of the six actions that can be done in each of N rescues, [N, 6].

    `to_target`, `to_cart`: distances to the nearest known ones [m], infinite if there is none; `carts`: whether carts
    are the safe place; `holding`: whether something is in the hand; `goal`: whether there is something to wander to;
    [N] each.
    """
    made = np.zeros((len(holding), COUNT), bool)
    made[:, TO_TARGET] = np.isfinite(to_target)
    made[:, TO_CART] = np.isfinite(to_cart)
    made[:, TAKE] = ~holding & (to_target <= REACH)
    made[:, LET_GO] = holding & (~carts | (to_cart <= REACH))
    made[:, LOOK] = True
    made[:, WANDER] = goal
    return made


class SixActions:
    """The six actions of one episode, as actions of the benchmark. `mask` [6] tells which can be done."""

    def __init__(self, seed: int) -> None:
        """Begin an episode; `seed` determines which things are wandered to."""
        # "SIX": not the stream of another learner with the same seed
        self._chance = np.random.default_rng([seed, 0x534958])
        self._goal: str | None = None
        self.mask = np.zeros(COUNT, bool)

    def see(self, decision: Decision) -> None:
        """Take the decision that comes next."""
        last, result = decision.last_action, decision.last_result
        if last == Action(WALK_TO, self._goal or "") and result is not None:
            if result.ok or result.reason not in UNFINISHED:
                self._goal = None
        objects = decision.map.objects
        if self._goal is not None and decision.index(self._goal) not in objects:
            self._goal = None
        self._targets = tuple(t.name for t in decision.targets if not t.rescued and t.name != decision.held)
        self._carts = decision.containers
        (self._target, to_target), (self._cart, to_cart) = (
            _nearest_of(decision, names) for names in (self._targets, self._carts)
        )
        self._sight = [name for i in decision.map.in_view if (name := decision.names[i]) != decision.held]
        goal = self._goal is not None or bool(self._sight)
        facts = (to_target, to_cart, bool(self._carts), decision.held is not None, goal)
        self.mask = possible(*(np.array([fact]) for fact in facts))[0]

    def action(self, number: int) -> Action | None:
        """The action of the benchmark with this number; None if it cannot be done."""
        if not self.mask[number]:
            return None
        if number == WANDER and self._goal is None:
            self._goal = self._sight[int(self._chance.integers(len(self._sight)))]
        return (
            Action(WALK_ONE_STEP, self._target or ""),
            Action(WALK_ONE_STEP, self._cart or ""),
            Action(PICK_UP, self._target or ""),
            Action(DROP, self._cart),
            Action(EXPLORE),
            Action(WALK_TO, self._goal or ""),
        )[number]


def _nearest_of(decision: Decision, names: tuple[str, ...]) -> tuple[str | None, float]:
    """The nearest of the things called `names` that are known, and its distance [m]; None and infinity if none is."""
    objects = decision.map.objects
    known = [name for name in names if decision.index(name) in objects]
    if not known:
        return None, np.inf
    places = np.array([objects[decision.index(name)].position[:2] for name in known], np.float64)
    away = np.hypot(*(places - np.asarray(decision.agent_position)).T)
    (found,), (least,) = nearest(away[None], np.ones((1, len(known)), bool))
    return known[int(found)], float(least)
