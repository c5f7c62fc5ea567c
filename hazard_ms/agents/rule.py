"""A rule of thumb: fetch a random known target, put it into the bag or a random known cart, look around for more.

It is the Rule that the paper describes [docs/benchmark.md 5]. It stays with what it has drawn until that is done or has
failed `give_up` times. When it knows no target it walks to a random thing that it has seen and looks around there.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.attempts import Repeats
from hazard_ms.agents.base import Agent, known, open_targets
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import MAX_FRAMES

GIVE_UP = 2  # failures with one thing, after which it is given up [ours]
UNFINISHED = 0.25  # what a walk that ran out of frames counts as a failure: eight are longer than any way [ours]


class Rule(Agent):
    """Draws targets, carts and places to look from, stays with what it has drawn, and gives up what fails."""

    colours = False

    def __init__(self, give_up: int = GIVE_UP) -> None:
        """`give_up`: failures after which a thing is given up. Raises ValueError unless it is positive."""
        if give_up < 1:
            raise ValueError(f"give_up must be at least 1, got {give_up}")
        self._give_up = give_up

    def reset(self, brief: Brief) -> None:
        """Begin a sequence of random numbers, fixed by `brief.random_seed`."""
        # "RULE": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x52554C45])
        self._failures: dict[str, float] = {}
        self._goal: str | None = None  # the thing that it goes to
        self._verb, self._repeats = brief.verb, Repeats(bool(brief.mitigations))

    def act(self, decision: Decision) -> Action:
        """The next step: put away what it holds, else fetch what it has drawn, else search."""
        action = self.asked(decision, self._verb) or self._choose(decision)
        other = self._repeats.instead(decision, action)
        return action if other is None else self._say(self._repeats.note, other)

    def _choose(self, decision: Decision) -> Action:
        last, result = decision.last_action, decision.last_result
        if last is None or result is None:
            return self._say("look around first", Action(EXPLORE))
        if last.target is not None and not result.ok:
            failed = UNFINISHED if result.reason == MAX_FRAMES else 1.0
            self._failures[last.target] = self._failures.get(last.target, 0.0) + failed
        if decision.targets and all(target.rescued for target in decision.targets):
            return self._say("every target is rescued", Action(STOP))
        if decision.held is not None and not decision.containers:
            return self._say("into the bag", Action(DROP))
        here = last.target if last.verb == WALK_TO and result.ok else None
        holding = decision.held is not None
        wanted = self._open(decision, decision.containers if holding else open_targets(decision))
        goal = self._stay_or_draw(wanted)
        if goal is not None and goal == here:
            return self._say("it is here", Action(DROP if holding else PICK_UP, goal))
        if goal is not None:
            return self._say(f"one of {len(wanted)}", Action(WALK_TO, goal))
        return self._search(decision, here)

    def _search(self, decision: Decision, here: str | None) -> Action:
        """Go to a random thing and look around there; where it can go nowhere, look around where it is."""
        goal = self._stay_or_draw(self._open(decision, tuple(n for n in decision.names if n != decision.held)))
        if goal is None or goal == here:
            self._goal = None
            return self._say("look around from here", Action(EXPLORE))
        return self._say(f"to {goal}, to search there", Action(WALK_TO, goal))

    def _open(self, decision: Decision, names: tuple[str, ...]) -> list[str]:
        """The things among `names` that it knows and has not given up."""
        return [name for name in sorted(known(decision, names)) if self._failures.get(name, 0.0) < self._give_up]

    def _stay_or_draw(self, names: list[str]) -> str | None:
        """The goal it has if that is among `names`, else a new one; None if there are none, and the goal is kept."""
        if names and self._goal not in names:
            self._goal = names[int(self._chance.integers(len(names)))]
        return self._goal if names else None

    def _say(self, note: str, action: Action) -> Action:
        self.note = note
        return action
