"""The world as the paper's agents see it, and the options between which they choose [docs/agents.md].

They know the targets and carts that they remember, their own place, whether they hold something, and how their last
action ended. Walks are straight lines. What comes after a choice is predicted with the same options: a walk always
arrives, a pick-up always succeeds, and looking around shows nothing new.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO

# The constants of cost have no unit: 1 is the cost of walking 2 m [the code of the original].
COST_PER_METRE = 0.5  # cost of a walk, 0.05 for each cell of 0.1 m
MOST_WALK = 10.0  # most that a walk costs: beyond 20 m all are alike
EXPLORE_COST = 2.5  # cost of looking around; pick_up and drop cost nothing
RETRY_COST = 5.0  # what a walk costs more after it failed and brought the agent no nearer
HERE = 0  # the place at which the agent stands at the decision, and the thing of actions that need none


class Option(NamedTuple):
    """One thing that the agent can do: a verb of `skills.decision`, the number of a place, and what it costs."""

    verb: str
    thing: int
    cost: float


LOOK = Option(EXPLORE, HERE, EXPLORE_COST)


class State(NamedTuple):
    """The situation at a decision, real or predicted. Places are numbered as in `View`."""

    at: int = HERE  # number of the agent's place
    holding: bool = False
    left: int = 0  # bit i is set while the target i is neither safe nor in the hand
    verb: str = ""  # of the last action; empty at the start
    thing: int = HERE  # number of the last action's thing
    worked: bool = True  # whether the last action worked
    paid: float = 0.0  # cost of the last action when it was chosen


@dataclass(frozen=True)
class View:
    """Places by number: first the agent's own, then those of the known targets, then those of the known carts."""

    names: tuple[str, ...]  # of the things there; "" for the agent's own place
    targets: tuple[Target, ...]  # the known targets; target i is at place i + 1
    in_bag: bool  # whether the safe place is the bag
    walks: tuple[tuple[Option, ...], ...]  # the walk from each place to each other
    start: State

    @property
    def carts(self) -> range:
        """Numbers of the places of the carts."""
        return range(1 + len(self.targets), len(self.names))

    def options(self, state: State) -> tuple[Option, ...]:
        """The options in `state`; there is none where only a second look around is left."""
        walks = self.walks[state.at]
        walked = state.verb == WALK_TO
        look = () if state.verb == EXPLORE else (LOOK,)
        if state.holding:
            if self.in_bag or (walked and state.worked and state.thing in self.carts):
                return (Option(DROP, HERE if self.in_bag else state.thing, 0.0),)
            carts = [cart for cart in self.carts if not walked or state.worked or cart == state.thing]
            return tuple(walks[cart] for cart in carts) or look
        if walked and state.left >> state.thing & 1:
            if state.worked:
                return (Option(PICK_UP, state.thing, 0.0),)
            again = walks[state.thing]
            dearer = RETRY_COST if again.cost >= state.paid else 0.0
            return again._replace(cost=again.cost + dearer), LOOK
        known = [walks[target] for target in range(1, 1 + len(self.targets)) if state.left >> target & 1]
        return (*known, *look)

    def after(self, state: State, option: Option) -> State:
        """The state that is predicted to follow when `option` is done in `state`."""
        verb, thing, _ = option
        if verb == WALK_TO:
            return State(thing, state.holding, state.left, verb, thing)
        if verb == PICK_UP:
            return State(state.at, True, state.left & ~(1 << thing), verb, thing)
        return State(state.at, state.holding and verb != DROP, state.left, verb)


def walk_cost(metres: float) -> float:
    """The cost of a walk over `metres` [m] of straight line."""
    return min(MOST_WALK, COST_PER_METRE * metres)


def walks_between(places: Sequence[tuple[float, float]]) -> tuple[tuple[Option, ...], ...]:
    """The walk from each of P `places` [m], [P, 2], to each other one."""
    xy = np.asarray(places, dtype=np.float64).reshape(-1, 2)
    metres = np.hypot(*(xy[:, None] - xy[None]).transpose(2, 0, 1))
    return tuple(tuple(Option(WALK_TO, to, walk_cost(far)) for to, far in enumerate(row)) for row in metres.tolist())
