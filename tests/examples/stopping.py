"""An agent that looks around once and then stops: the shortest episode that can be filmed."""

from __future__ import annotations

from hazard_ms.agents.base import Agent
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision

FRAMES = 30  # that looking around takes at least


class Stopping(Agent):
    """Looks around, then stops."""

    def reset(self, brief: Brief) -> None:
        self.brief = brief

    def act(self, decision: Decision) -> Action:
        return Action(EXPLORE) if decision.frame == 0 else Action(STOP)
