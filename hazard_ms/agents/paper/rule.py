"""The paper's rule-based agent as its code has it: it goes on with what it does, or draws what to do next.

Its code (policy/rule_based.py, commit c53d1e4, in the original's repository) has no walk to a cart: where it should
bring something there, it looks around for the rest of the episode. So it rescues nothing in wind, as in the paper.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.base import Agent, known, open_targets
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Decision


class Rule(Agent):
    """Repeats its last action while it can, unless that was to look around; else draws evenly from what it can do."""

    colours = False

    def reset(self, brief: Brief) -> None:
        """Begin a sequence of random numbers, fixed by `brief.random_seed`."""
        # "PRUL": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x5052554C])
        self._near: str | None = None  # what it has walked to and not picked up since

    def act(self, decision: Decision) -> Action:
        """The last action again, or one of those that it can do."""
        last = decision.last_action
        self._remember(decision)
        moves = self._moves(decision)
        if last is not None and last.verb != EXPLORE and last in moves:
            self.note = "the same again"
            return last
        self.note = f"drawn from {len(moves)}"
        return moves[int(self._chance.integers(len(moves)))]

    def _remember(self, decision: Decision) -> None:
        """Enter what the last action changed about what stands before it."""
        last, result = decision.last_action, decision.last_result
        if last is None or result is None:
            return
        if last.verb == WALK_TO:
            self._near = last.target if result.ok else None
        elif last.verb == PICK_UP:
            self._near = None if result.ok else last.target

    def _moves(self, decision: Decision) -> list[Action]:
        """What it can do; looking around counts twice, unless it holds something or its last action was a walk."""
        look = Action(EXPLORE)
        if decision.last_action is None:
            return [look]
        if decision.held is not None:
            return [look] if decision.containers else [look, Action(DROP)]
        again = [] if decision.last_action.verb == WALK_TO else [look]
        if self._near is not None:
            return [look, Action(PICK_UP, self._near), *again]
        walks = [Action(WALK_TO, name) for name in sorted(known(decision, open_targets(decision), missing=True))]
        return [look, *walks, *again]
