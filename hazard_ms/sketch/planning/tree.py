"""Monte Carlo tree search over options, with the rules and constants of the original's `mcts` agent.

    choose in the tree   argmax of Q(a) + c(n) sqrt(n) / (1 + n_a) - cost(a); what was never tried comes first
    exploration rate     c(n) = ln((1 + n + BASE) / BASE) + CONSTANT
    back up a path       v <- DISCOUNT v - cost, from the leaf to the root
    decide               argmax of Q(a) - cost(a)

n counts the visits of a node, n_a those of the node behind option a, and Q(a) is the mean of what was backed up to it.
A node that is reached for the first time gets a child for each of its options, and a roll-out of uniformly random
options from it estimates its value.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

# The original's constants: dimensionless but for counts
BASE = 1e6
CONSTANT = 0.1
UNTRIED = 1e6  # in place of Q and the exploration term
DISCOUNT = 0.95  # of value, per option
DEPTH = 20  # options in a roll-out
SIMULATIONS = 2000  # per decision
MOST_SIMULATIONS = 10**6  # of a decision: any larger number must be a mistake [ours]

State = TypeVar("State")
Option = TypeVar("Option")


class Model(Protocol[State, Option]):
    """The world as the search asks for it. States are never changed, so tuples serve best."""

    def options(self, state: State) -> Sequence[Option]:
        """All options in a state; none where it is over."""

    def step(self, state: State, option: Option) -> tuple[State, float, bool]:
        """The state after an option, what the option costs, and whether all is over then. It is deterministic."""

    def rest(self, state: State) -> float:
        """The cost that is charged where a roll-out ends, for what is still to be done."""


@dataclass(frozen=True)
class Choice(Generic[Option]):
    """The option that the search decided for, and what it found out about each."""

    option: Option
    options: tuple[Option, ...]
    visits: tuple[int, ...]
    scores: tuple[float, ...]  # mean value less the cost; -inf where it was never tried


class Node(Generic[State, Option]):
    """A state in the tree, and the cost of the option behind it. `children` is None until it is first reached."""

    __slots__ = ("children", "cost", "done", "state", "total", "visits")

    def __init__(self, state: State, cost: float, done: bool) -> None:
        self.state, self.cost, self.done = state, cost, done
        self.visits, self.total = 0, 0.0
        self.children: list[Node[State, Option]] | None = None


def search(
    model: Model[State, Option], state: State, simulations: int = SIMULATIONS, seed: int = 0, depth: int = DEPTH
) -> Choice[Option]:
    """The best option found in this many simulations, each with a roll-out of at most `depth` options.

    All randomness derives from `seed`. Raises ValueError unless `simulations` is positive, `depth` is not negative and
    the state has an option.
    """
    if simulations < 1 or depth < 0:
        raise ValueError(f"simulations must be at least 1 and depth at least 0, got {simulations} and {depth}")
    options = tuple(model.options(state))
    if not options:
        raise ValueError(f"state must have at least one option, got {state!r:.100}")
    chance, root = random.Random(seed), Node[State, Option](state, 0.0, False)
    root.children = _expanded(model, state)
    for _ in range(simulations):
        path = [root]
        while path[-1].children:
            path.append(chosen(path[-1]))
        leaf = path[-1]
        if leaf.children is None:
            leaf.children = [] if leaf.done else _expanded(model, leaf.state)
        values = backed_up(_rolled_out(model, leaf, depth, chance), [node.cost for node in path[1:]])
        for node, value in zip(reversed(path), values, strict=True):
            node.visits += 1
            node.total += value
    scores = tuple(node.total / node.visits - node.cost if node.visits else -math.inf for node in root.children)
    best = scores.index(max(scores))
    return Choice(options[best], options, tuple(node.visits for node in root.children), scores)


def exploration_rate(visits: int) -> float:
    """The weight of exploration at a node after this many visits, c(n)."""
    return math.log((1 + visits + BASE) / BASE) + CONSTANT


def exploration(visits: int, own_visits: int) -> float:
    """The bonus on the value of an option that was tried `own_visits` times at a node with `visits`."""
    return exploration_rate(visits) * math.sqrt(visits) / (1 + own_visits)


def chosen(node: Node[State, Option]) -> Node[State, Option]:
    """The child that the next simulation goes to; the first of equal ones."""
    assert node.children
    scale = exploration(node.visits, 0)
    best, best_score = node.children[0], -math.inf
    for child in node.children:
        tried = child.visits
        score = (child.total / tried + scale / (1 + tried) if tried else UNTRIED) - child.cost
        if score > best_score:
            best, best_score = child, score
    return best


def backed_up(value: float, costs: Sequence[float]) -> list[float]:
    """The values of the nodes of a path, from the leaf, which is worth `value`, to the root.

    `costs` are those of the options along the path, from the root on.
    """
    values = [value]
    for cost in reversed(costs):
        values.append(DISCOUNT * values[-1] - cost)
    return values


def _expanded(model: Model[State, Option], state: State) -> list[Node[State, Option]]:
    return [Node(*model.step(state, option)) for option in model.options(state)]


def _rolled_out(model: Model[State, Option], leaf: Node[State, Option], depth: int, chance: random.Random) -> float:
    """The value of a leaf by uniformly random options until all is over or `depth` is reached."""
    state, done = leaf.state, leaf.done
    costs: list[float] = []
    while not done and len(costs) < depth:
        options = model.options(state)
        if not options:
            break
        state, cost, done = model.step(state, options[int(chance.random() * len(options))])
        costs.append(cost)
    return backed_up(-model.rest(state), costs)[-1]
