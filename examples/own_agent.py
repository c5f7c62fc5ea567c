"""An agent of your own: it saves what is most valuable first, and keeps away from what is too dangerous.

    hazard-ms play --agent examples/own_agent.py:Careful:caution=1.5 --output careful.mp4
    python examples/own_agent.py

An agent is told of the task before an episode (`reset`), and of what the robot has seen before every action (`act`).
"""

from __future__ import annotations

from hazard_ms import Action, Agent
from hazard_ms.agents.base import distance, known, open_targets
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Decision

MOST_LOOKS = 2  # times that it looks around in vain before it stops
MOST_FAILURES = 8  # with one target before it is given up: a walk that gets halfway is a failure, too


class Careful(Agent):
    """Fetches the most valuable known target, then the nearest, unless a hazard nearly reaches it."""

    colours = False

    def __init__(self, caution: float = 1.2) -> None:
        """`caution`: factor on the level of a hazard over a target before it is judged."""
        self.caution = caution

    def reset(self, brief: Brief) -> None:
        """Begin an episode: remember its hazards, and forget the last one's failures."""
        self.hazards = brief.hazards
        self.failures: dict[str, int] = {}
        self.looks = 0

    def act(self, decision: Decision) -> Action:
        """Choose the next action."""
        last, result = decision.last_action, decision.last_result
        if last is not None and last.target is not None and result is not None and not result.ok:
            self.failures[last.target] = self.failures.get(last.target, 0) + 1
        if decision.held is not None:
            return self.put_away(decision)
        wanted = [name for name in known(decision, open_targets(decision)) if self.is_worth_it(decision, name)]
        if not wanted:
            self.note, self.looks = "nothing that is worth it is in sight", self.looks + 1
            return Action(EXPLORE) if self.looks <= MOST_LOOKS else Action(STOP)
        self.looks = 0
        best = max(wanted, key=lambda name: decision.target(name).value)  # the nearest of those, as `known` sorts them
        self.note = f"the most valuable of {len(wanted)}"
        arrived = last == Action(WALK_TO, best) and result is not None and result.ok
        return Action(PICK_UP if arrived else WALK_TO, best)

    def put_away(self, decision: Decision) -> Action:
        """Drop what is in the hand into the bag, or into the nearest shopping cart."""
        carts = known(decision, decision.containers)
        if not decision.containers:
            return Action(DROP)
        if not carts:
            return Action(EXPLORE)
        cart = next(iter(carts))
        arrived = decision.last_action == Action(WALK_TO, cart) and distance(decision, carts[cart]) < 1.5
        return Action(DROP if arrived else WALK_TO, cart)

    def is_worth_it(self, decision: Decision, name: str) -> bool:
        """Whether a target is undamaged, not given up, and not threatened by any hazard."""
        sighting, target = decision.map.objects[decision.index(name)], decision.target(name)
        levels = zip(self.hazards, sighting.levels, strict=False)
        height = float(sighting.position[2])
        threatened = any(hazard.threatens(target, level * self.caution, height) for hazard, level in levels)
        return self.failures.get(name, 0) < MOST_FAILURES and not target.damaged and not threatened


if __name__ == "__main__":
    import sys

    from hazard_ms import main

    sys.exit(main(["play", "--agent", f"{__file__}:{Careful.__name__}", *sys.argv[1:]]))
