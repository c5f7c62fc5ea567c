"""The paper's greedy agent as its code has it: the option of the lowest cost over value, and nothing else.

It neither stays with a target nor gives one up, and its only search is to look around where it stands.
"""

from __future__ import annotations

from hazard_ms.agents.base import Agent
from hazard_ms.agents.paper.memory import Memory, predicted_value
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision


class Greedy(Agent):
    """Takes the option of the lowest cost over value, which is halved where the hazard's level, continued, harms it."""

    colours = False

    def reset(self, brief: Brief) -> None:
        """Begin an episode. Nothing is random."""
        self._memory = Memory(brief)

    def act(self, decision: Decision) -> Action:
        """The option of the lowest cost over value; of equal ones the first, looking around last."""
        view = self._memory.view(decision)
        values = self._memory.values(view, predicted_value)
        options = self._memory.choices(view)
        costs = [option.cost / values[option.thing] for option in options]
        lowest = min(range(len(options)), key=lambda i: costs[i])
        self.note = f"cost {costs[lowest]:.2f}, the lowest of {len(options)}"
        return self._memory.action(view, options[lowest])
