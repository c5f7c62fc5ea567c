"""The second tree search in the paper's code: it prefers targets at which the hazard's level has just changed."""

from __future__ import annotations

from hazard_ms.agents.base import Agent
from hazard_ms.agents.paper.mcts import MOST_SIMULATIONS
from hazard_ms.agents.paper.memory import changing_value
from hazard_ms.agents.paper.search import TreeSearch
from hazard_ms.sketch.planning.tree import SIMULATIONS
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.spec.checks import whole


class MctsDiff(Agent):
    """Tree search with costs over values, doubled where the level changed between the last two sightings."""

    colours = False

    def __init__(self, simulations: int = SIMULATIONS) -> None:
        """`simulations`: of each decision. Raises ValueError unless it is a positive whole number."""
        self._simulations = whole(simulations, 1, MOST_SIMULATIONS, "simulations")

    def reset(self, brief: Brief) -> None:
        """Begin an episode. All randomness of the search is fixed by `brief.random_seed`."""
        self._search = TreeSearch(brief, changing_value, self._simulations)

    def act(self, decision: Decision) -> Action:
        """The option that the simulations rate best."""
        action, self.note = self._search.act(decision)
        return action
