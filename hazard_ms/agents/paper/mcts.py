"""The paper's tree search: 2,000 simulated rescues of what it knows at each decision, then the best first option.

`MctsDiff` is the second one in the paper's code: it prefers targets at which the hazard's level has just changed.
"""

from __future__ import annotations

from hazard_ms.agents.base import Agent
from hazard_ms.agents.paper.memory import Pair, changing_value, predicted_value
from hazard_ms.agents.paper.search import TreeSearch
from hazard_ms.sensing.target_table import Target
from hazard_ms.sketch.planning.tree import MOST_SIMULATIONS, SIMULATIONS
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.spec.checks import whole


class Mcts(Agent):
    """Tree search with costs over predicted values, as the paper says, or costs alone, as its first code had it."""

    colours = False

    def __init__(self, value: bool = True, simulations: int = SIMULATIONS) -> None:
        """`value`: divide costs by predicted values; `simulations`: of each decision.

        Raises ValueError unless `simulations` is a positive whole number.
        """
        self._worth = predicted_value if value else _one
        self._simulations = whole(simulations, 1, MOST_SIMULATIONS, "simulations")

    def reset(self, brief: Brief) -> None:
        """Begin an episode. All randomness of the search is fixed by `brief.random_seed`."""
        self._search = TreeSearch(brief, self._worth, self._simulations)

    def act(self, decision: Decision) -> Action:
        """The option that the simulations rate best."""
        action, self.note = self._search.act(decision)
        return action


class MctsDiff(Mcts):
    """Tree search with costs over values, doubled where the level changed between the last two sightings."""

    def __init__(self, simulations: int = SIMULATIONS) -> None:
        """`simulations`: of each decision. Raises ValueError unless it is a positive whole number."""
        super().__init__(simulations=simulations)
        self._worth = changing_value


def _one(target: Target, levels: dict[str, Pair]) -> float:
    return 1.0
