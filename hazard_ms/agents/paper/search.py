"""Tree search of the paper's agents over the rescue that they imagine: `hazard_ms.sketch.planning.tree` on a `View`."""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.paper.memory import Memory, Worth
from hazard_ms.agents.paper.view import Option, State, View
from hazard_ms.sketch.planning.tree import search
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision

LEFT_FREE = 5.0  # twice the cost of going to a target that is left for nothing in the end [the code of the original]


class Rescue:
    """The rescue of the known targets, as a model for tree search.

    The cost of a walk is divided by the value of the target it leads to. In the end each target that is left costs
    max(2 d - LEFT_FREE, 0), d being the undivided cost of going there.
    """

    def __init__(self, view: View, values: tuple[float, ...]) -> None:
        """Begin with what `view` shows; `values` are those of its places, see `Memory.values`."""
        self._view, self._values = view, values
        self._left = [[max(2.0 * walk.cost - LEFT_FREE, 0.0) for walk in row] for row in view.walks]
        self._options: dict[State, tuple[Option, ...]] = {}

    def options(self, state: State) -> tuple[Option, ...]:
        """Everything that can be chosen in `state`."""
        known = self._options.get(state)
        if known is None:
            known = self._options[state] = self._view.options(state)
        return known

    def step(self, state: State, option: Option) -> tuple[State, float, bool]:
        """The state that follows `option`, what it costs, and whether every known target is safe then."""
        after = self._view.after(state, option)
        return after, option.cost / self._values[option.thing], not (after.left or after.holding)

    def rest(self, state: State) -> float:
        """The cost of what is left in the end."""
        return sum(cost for target, cost in enumerate(self._left[state.at]) if state.left >> target & 1)


class TreeSearch:
    """Chooses by tree search what a simulated rescue of all that is known begins with."""

    def __init__(self, brief: Brief, worth: Worth, simulations: int) -> None:
        """Begin an episode; `worth` is what the cost of going to a target is divided by."""
        self._memory, self._worth, self._simulations = Memory(brief), worth, simulations
        # "MCTS": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x4D435453])

    def act(self, decision: Decision) -> tuple[Action, str]:
        """The next action, and a note on it."""
        view = self._memory.view(decision)
        options = self._memory.choices(view)
        seed = int(self._chance.integers(2**32))
        if len(options) == 1:
            return self._memory.action(view, options[0]), "the only option"
        model = Rescue(view, self._memory.values(view, self._worth))
        choice = search(model, view.start, self._simulations, seed)
        note = f"cost {-max(choice.scores):.2f} in {max(choice.visits)} simulations, the best of {len(options)}"
        return self._memory.action(view, choice.option), note
