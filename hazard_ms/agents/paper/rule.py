"""The paper's rule-based agent as its code has it: it goes on with what it does, or draws what to do next."""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.base import Agent
from hazard_ms.agents.paper.memory import Memory
from hazard_ms.agents.paper.view import Option
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, Action, Decision

LOOKS = 2  # number of times that looking around is in the draw


class Rule(Agent):
    """Repeats its last action while that is an option; else draws evenly from the moves that it has.

    They are: look around (counted twice), pick up, drop, and walk to a target or cart, which is drawn next.
    """

    colours = False

    def reset(self, brief: Brief) -> None:
        """Begin a sequence of random numbers, fixed by `brief.random_seed`."""
        self._memory = Memory(brief)
        # "PRUL": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x5052554C])

    def act(self, decision: Decision) -> Action:
        """The last action again, or one of the possible moves."""
        view = self._memory.view(decision)
        options = self._memory.choices(view)
        same = [o for o in options if o[:2] == (view.start.verb, view.start.thing)]
        self.note = "the same again" if same else f"drawn from {len(options)}"
        return self._memory.action(view, same[0] if same else self._drawn(options))

    def _drawn(self, options: tuple[Option, ...]) -> Option:
        moves: dict[str, list[Option]] = {}
        for option in options:
            moves.setdefault(option.verb, []).append(option)
        verbs = [verb for verb in moves for _ in range(LOOKS if verb == EXPLORE else 1)]
        chosen = moves[verbs[int(self._chance.integers(len(verbs)))]]
        return chosen[int(self._chance.integers(len(chosen)))]
