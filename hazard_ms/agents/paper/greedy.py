"""The paper's greedy agent as its code has it: the option of the highest cost over value, and nothing else.

The paper says that Greedy takes the lowest cost. Its code takes the highest (`GreedyAgent.select_child` of
policy/fire_flood_heuristic.py, commit 9c003f8, in the original's repository): it goes to what is far away and of little
value, and looks around wherever a walk would cost less than that. It neither stays with a target nor gives one up, and
its only search is to look around where it stands.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.base import Agent
from hazard_ms.agents.paper.memory import Memory, predicted_value, wetted_value
from hazard_ms.agents.paper.view import HERE, Option, View
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import WALK_TO, Action, Decision


class Greedy(Agent):
    """Takes the option of the highest cost over value, as the paper's code does, or of the lowest."""

    colours = False

    def __init__(self, lowest: bool = False) -> None:
        """`lowest`: take the lowest cost, as the paper's text says, and halve the value of what a fire will burn, too.

        The code compares the logarithm of a temperature with 100, as if it were the temperature, so that it never
        expects a fire to burn anything; in a flood it halves the value of what gets wet.
        """
        self._pick, self._worth = (min, predicted_value) if lowest else (max, wetted_value)
        self._word = "lowest" if lowest else "highest"

    def reset(self, brief: Brief) -> None:
        """Begin an episode. Which of several equal options it takes is fixed by `brief.random_seed`."""
        self._memory = Memory(brief)
        # "PGRE": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x50475245])

    def act(self, decision: Decision) -> Action:
        """The option of the highest (or lowest) cost over value; equal ones are drawn from."""
        view = self._memory.view(decision)
        values = self._memory.values(view, self._worth)
        options = self._memory.choices(view)
        costs = [_cost(view, option) / values[option.thing] for option in options]
        best = self._pick(costs)
        equal = [option for option, cost in zip(options, costs, strict=True) if cost == best]
        self.note = f"cost {best:.2f}, the {self._word} of {len(options)}"
        return self._memory.action(view, equal[int(self._chance.integers(len(equal)))])


def _cost(view: View, option: Option) -> float:
    """The cost of an option; a walk that failed costs no more when it is tried again, unlike in the tree search."""
    return view.walks[HERE][option.thing].cost if option.verb == WALK_TO else option.cost
