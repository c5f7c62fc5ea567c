"""Tree search over whole rescues: what `planner` solves exactly, searched with `hazard_ms.sketch.planning.tree`.

The tree's options are the goals that can still be reached in time. A simulation ends when there is none, and counts the
share of the value that it saved. It believes what `planner` believes, so that the two differ in the search alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hazard_ms.agents.search.outlook import Outlook, Weights
from hazard_ms.agents.search.searcher import GIVE_UP, REACH, First, Searcher
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import Spot
from hazard_ms.sketch.planning.tree import MOST_SIMULATIONS, SIMULATIONS, search
from hazard_ms.skills.brief import Brief
from hazard_ms.spec.checks import whole


class Moment(NamedTuple):
    """A state of the search: the frame, where the agent stands, and what is done."""

    frame: float
    spot: Spot
    done: int  # bits of the goals
    holding: bool = False


class Step(NamedTuple):
    """An option of the search: a goal, the cart that it is for or -1, and what follows."""

    goal: int
    cart: int
    safe: float  # frame at which it is done
    spot: Spot  # where the agent stands then
    worth: float


class Rescue:
    """The problem of a rescue as a model for tree search; what is saved is a negative cost, as a share of all."""

    def __init__(self, problem: Problem) -> None:
        """Search in `problem`."""
        self._problem = problem
        self._whole = max(sum(problem.values), 1e-9)
        self._options: dict[Moment, tuple[Step, ...]] = {}

    @property
    def start(self) -> Moment:
        """The moment at which the search begins."""
        problem = self._problem
        return Moment(problem.frame, problem.travel.start, 0, problem.holding is not None)

    def options(self, state: Moment) -> Sequence[Step]:
        """All goals that can be done in time; where something is held, the ways to put it away."""
        found = self._options.get(state)
        if found is None:
            found = self._options[state] = tuple(self._steps(state))
        return found

    def _steps(self, state: Moment) -> list[Step]:
        problem = self._problem
        if state.holding and problem.holding is not None:
            return self._stowed(problem.holding, state.spot, state.frame)
        left = [goal for goal in range(problem.travel.targets) if not state.done >> goal & 1]
        meetings = problem.travel.meetings(state.spot, state.frame, left)
        return [
            step
            for goal, (met, spot) in zip(left, meetings, strict=True)
            if met + problem.pick[goal] <= problem.limit
            for step in self._stowed(goal, spot, met + problem.pick[goal])
        ]

    def _stowed(self, goal: int, spot: Spot, frame: float) -> list[Step]:
        problem = self._problem
        return [
            Step(goal, cart, safe, after, problem.worth(goal, safe))
            for safe, after, cart in problem.stows(goal, spot, frame)
            if safe <= problem.limit
        ]

    def step(self, state: Moment, option: Step) -> tuple[Moment, float, bool]:
        """The moment after `option`, its cost, and whether everything is done then."""
        after = Moment(option.safe, option.spot, state.done | 1 << option.goal)
        return after, -option.worth / self._whole, after.done == (1 << self._problem.travel.targets) - 1

    def rest(self, state: Moment) -> float:
        """The cost of what is left in the end: nothing, as only what is saved counts."""
        return 0.0


class Mcts(Searcher):
    """Searches the believed rest of the rescue at each decision, and pursues the goal that simulations rate best."""

    def __init__(
        self,
        simulations: int = SIMULATIONS,
        search: float = 1.0,
        give_up: int = GIVE_UP,
        belief: float = 1.0,
        mitigate: bool = True,
    ) -> None:
        """Choose how long it searches.

        `simulations`: of each decision; `search`: share of what may be found by searching that counts; `give_up`:
        failures after which a thing is given up; `belief`: share of the doubts about what things are that counts;
        `mitigate`: whether it shuts doors and puts out fires where that averts more than rescues do.
        Raises ValueError unless `search` and `belief` are shares and the others are positive whole numbers.
        """
        super().__init__(Weights(search=search, belief=belief), REACH, give_up, mitigate)
        self._simulations = whole(simulations, 1, MOST_SIMULATIONS, "simulations")

    def reset(self, brief: Brief) -> None:
        """Begin an episode. All randomness of the search is fixed by `brief.random_seed`."""
        super().reset(brief)
        # "TREE": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x54524545])

    def first(self, ahead: Outlook) -> First | None:
        """The option with the highest mean of the simulations that began with it."""
        model = Rescue(ahead.problem)
        if not model.options(model.start):
            return None
        choice = search(model, model.start, self._simulations, int(self._chance.integers(2**32)))
        best = choice.options.index(choice.option)
        why = f"{choice.scores[best]:.2f} of the value in {choice.visits[best]} simulations"
        name = ahead.name(choice.option.goal)
        return First(choice.option.goal, choice.option.cart, f"{name}: {why}, the best of {len(choice.options)}")
