"""An agent of your own that acts against the hazard: it shuts the nearest doors first, and then rescues like another.

    hazard-ms play -e HazardHouseFlood-v1 --agent examples/shuts_doors.py:ShutsDoors:doors=2 -o flood.mp4
    python examples/shuts_doors.py

What a task lets its agents do about the hazard is in `Decision.available`, beside the verbs of every task; doors,
windows and doorways that were seen are in `Decision.openings`.
"""

from __future__ import annotations

import math

from hazard_ms import Action, Agent
from hazard_ms.agents.base import agent
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, Decision
from hazard_ms.skills.failures import UNFINISHED

SHUT = "shut"


class ShutsDoors(Agent):
    """Looks around, shuts some of the nearest open doors, and leaves the rest to another agent."""

    colours = False

    def __init__(self, doors: int = 2, base: str = "greedy") -> None:
        """`doors`: how many it shuts; `base`: the agent that rescues afterwards."""
        self.doors, self.base = doors, agent(base)

    def reset(self, brief: Brief) -> None:
        """Begin an episode; `brief` says whether doors can be shut in it."""
        self.base.reset(brief)
        self.left = self.doors if SHUT in brief.mitigations else 0
        self.looked = False
        self.mine: Action | None = None  # its own last action
        self.tried: set[str] = set()

    def act(self, decision: Decision) -> Action:
        """Choose the next action."""
        mine, result, self.mine = self.mine, decision.last_result, None
        if mine is not None and mine.target is not None and result is not None and result.reason not in UNFINISHED:
            self.tried.add(mine.target)
            self.left -= result.ok
        if self.left > 0 and decision.held is None:
            self.mine = self.next_door(decision) if self.looked else Action(EXPLORE)
            self.looked, self.note = True, "what is behind a shut door is safe for a while"
        if self.mine is not None:
            return self.mine
        action = self.base.act(decision)
        self.note = self.base.note
        return action

    def next_door(self, decision: Decision) -> Action | None:
        """Shut the nearest door that was not tried yet; None if there is none."""
        places = {o.name: o.position[:2] for o in decision.openings if o.kind == "door" and o.name not in self.tried}
        offered = [a for a in decision.available if a.verb == SHUT and a.target in places]
        return min(offered, key=lambda a: math.dist(places[str(a.target)], decision.agent_position), default=None)


if __name__ == "__main__":
    import sys

    from hazard_ms import main

    agent_here = f"{__file__}:{ShutsDoors.__name__}"
    sys.exit(main(["play", "-e", "HazardHouseFlood-v1", "--agent", agent_here, *sys.argv[1:]]))
