"""Fights a fire first, and rescues like another agent afterwards.

Once it knows of an extinguisher that holds something and of something hot, it fetches the former and puts out the
latter, the nearest first, as long as the fire is small, the extinguisher lasts and it gets anywhere. Then it drops the
extinguisher and leaves everything to the other agent, as it does where nothing can be fought.
"""

from __future__ import annotations

from hazard_ms.agents.attempts import Repeats
from hazard_ms.agents.base import Agent, agent, distance, known
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Decision, Tool
from hazard_ms.skills.failures import NOT_BURNING, UNFINISHED

EXTINGUISH = "extinguish"
FIRE = "fire"
LARGE = 12  # hot things from which on a fire is too large for what one can carry [ours]
HOT = 100.0  # level at which a thing is hot: boiling water, as the skill has it [C]
TRIES = 3  # failures of walks, pick-ups and jets after which it gives up the fight [ours]


class Fighter(Agent):
    """Puts out what it can and then rescues like `base`."""

    colours = False

    def __init__(self, base: str = "greedy", large: int = LARGE) -> None:
        """`base`: the agent that rescues; `large`: hot things from which on a fire is not fought.

        Raises ValueError for an unknown agent, and unless `large` is positive.
        """
        if large < 1:
            raise ValueError(f"large must be at least 1, got {large}")
        self._base, self._large = agent(base), large

    def reset(self, brief: Brief) -> None:
        """Begin an episode; `brief` tells whether a fire can be fought in it."""
        self._base.reset(brief)
        names = [hazard.name for hazard in brief.hazards]
        self._fire = names.index(FIRE) if FIRE in names else -1
        self._fights = self._fire >= 0 and EXTINGUISH in brief.mitigations
        self._failures = 0
        self._looked = False
        self._repeats = Repeats(bool(brief.mitigations))
        self._mine: Action | None = None  # its own last action, which the other agent has not chosen
        self._out: set[str] = set()  # what it has put out, or found not to burn

    def act(self, decision: Decision) -> Action:
        """The next action of the fight, else the other agent's."""
        if self._fights:
            self._count(decision)
            action = self._fought(decision) if self._fights else None
            if action is not None:
                self._mine = self._unless_repeated(decision, action)
                return self._mine
        self._mine = None
        if decision.held is not None and any(t.held for t in decision.tools):
            self.note = "it is of no use any more"
            return self._unless_repeated(decision, Action(DROP))
        action = self._base.act(decision)
        self.note = self._base.note
        return action

    def _unless_repeated(self, decision: Decision, action: Action) -> Action:
        """Its own `action`, or what is done instead where that has failed too often from here."""
        other = self._repeats.instead(decision, action)
        self.note = self.note if other is None else self._repeats.note
        return action if other is None else other

    def _count(self, decision: Decision) -> None:
        """Count failures of the fight, end it after TRIES, and remember what was put out."""
        if self._mine is None or decision.last_result is None:
            return
        result = decision.last_result
        done = result.ok or result.reason == NOT_BURNING
        self._failures += not done and result.reason not in UNFINISHED
        if self._mine.verb == EXTINGUISH and self._mine.target is not None and done:
            self._out.add(self._mine.target)
        if self._failures >= TRIES:
            self._fights = False

    def _fought(self, decision: Decision) -> Action | None:
        """The next action of the fight; None while there is nothing to do."""
        if not self._looked:
            self._looked, self.note = True, "look around"
            return Action(EXPLORE)
        held = next((tool for tool in decision.tools if tool.held), None)
        if decision.held is not None and held is None:
            return None  # the other agent puts it away
        hot = self._hot(decision)
        if held is not None:
            if (
                held.left <= 0.0
                or not hot
                or hot[0] not in {a.target for a in decision.available if a.verb == EXTINGUISH}
            ):
                self._fights = held.left > 0.0 and self._fights
                return Action(DROP) if not hot or held.left <= 0.0 else Action(WALK_TO, hot[0])
            self.note = f"puts out {hot[0]} with what is left, {100 * held.left:.0f} %"
            return Action(EXTINGUISH, hot[0])
        if not 0 < len(hot) < self._large:
            return None
        return self._to_tool(decision, [t for t in decision.tools if t.kind and t.left > 0.0])

    def _to_tool(self, decision: Decision, tools: list[Tool]) -> Action | None:
        """The way to the nearest extinguisher that it knows of, and into its hand; None if it knows none."""
        there = known(decision, tuple(tool.name for tool in tools))
        if not there:
            return None
        name = next(iter(there))
        self.note = "fetches an extinguisher"
        return Action(PICK_UP if decision.walked_up_to == name else WALK_TO, name)

    def _hot(self, decision: Decision) -> list[str]:
        """Names of the known things that were hot when last seen and that it has not put out, nearest first."""
        found = [
            (distance(decision, seen), decision.names[index])
            for index, seen in decision.map.objects.items()
            if len(seen.levels) > self._fire and seen.levels[self._fire] >= HOT
        ]
        return [name for _, name in sorted(found) if name not in self._out]
