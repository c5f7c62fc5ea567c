"""The paper's random agent: each time one of its moves, drawn uniformly from those that what it has seen allows."""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.base import Agent, known, open_targets
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision


class Random(Agent):
    """Draws from six moves.

    They are: one step to the nearest target or container, pick up the nearest target, drop, explore, and walk to
    something in sight; and, where a mitigation achieves the goal, that.
    """

    colours = False

    def reset(self, brief: Brief) -> None:
        """Begin a sequence of random numbers, fixed by `brief.random_seed`."""
        # "RAND": not the stream of another agent with the same seed
        self._verb = brief.mitigation
        self._chance = np.random.default_rng([brief.random_seed, 0x52414E44])

    def act(self, decision: Decision) -> Action:
        """The next action, one of the possible moves."""
        moves = self._moves(decision)
        return moves[int(self._chance.integers(len(moves)))]

    def _moves(self, decision: Decision) -> list[Action]:
        carts = list(known(decision, decision.containers, missing=True))
        moves = [Action(DROP, carts[0] if carts else None), Action(EXPLORE)]
        moves += [action for action in decision.available if action.verb == self._verb]
        targets = known(decision, open_targets(decision), missing=True)
        if targets:
            nearest = next(iter(targets))
            moves += [Action(WALK_ONE_STEP, nearest), Action(PICK_UP, nearest)]
        if carts:
            moves.append(Action(WALK_ONE_STEP, carts[0]))
        in_sight = [i for i in decision.map.in_view if decision.names[i] != decision.held]
        if in_sight:
            moves.append(Action(WALK_TO, decision.names[in_sight[int(self._chance.integers(len(in_sight)))]]))
        return moves
