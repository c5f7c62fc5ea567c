"""The joint planner of teams: every robot plans the whole rest of its rescue, and no two plan to fetch the same thing.

The plans are divided as in `sharing.py`; nor do two search at the same place, and at a cart a robot waits for its
turn. Each plans for what it has seen, or was told of: a robot that sees targets that nobody has told of yet tells the
others, with the verb `tell`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from hazard_ms.agents.base import known, open_targets
from hazard_ms.agents.planner import Planner
from hazard_ms.agents.search.outlook import Outlook
from hazard_ms.agents.search.searcher import First
from hazard_ms.agents.teams.sharing import TURNS, WALKS, Sharing, without
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, Action, Decision
from hazard_ms.skills.telling import LONGEST


class Joint(Sharing):
    """Planners that divide the targets, and the places to search, by what saves most in sum."""

    def __init__(self, tells: bool = True) -> None:
        """`tells`: whether robots tell one another of the targets that they see."""
        self._tells = tells

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        super().reset(briefs)
        self._told: set[str] = set()  # targets of which any robot has told the others

    def _partner(self, name: str) -> Planner:
        return _Partner(name, self)

    def _news(self, decision: Decision) -> str:
        """A message that names the targets on the map of which nobody has told yet; empty where there is none to send.

        Who stands before what it walked up to takes it first, and who failed thinks about that first.
        """
        if not self._tells or len(self._partners) < 2:
            return ""
        last = decision.last_result
        seen = known(decision, open_targets(decision))
        new = [t.name for t in decision.targets if t.name in seen and t.name not in self._told]
        if not new or decision.walked_up_to is not None or last is None or not last.ok:
            return ""
        text = ""
        for name in new:
            if len(text) + len(name) + 2 <= LONGEST:
                text += f", {name}" if text else name
                self._told.add(name)
        return text

    def shared(self, name: str, ahead: Outlook, left_out: Collection[str] = ()) -> Outlook:
        """The part of what lies `ahead` of the robot `name` that is left to it, without what is `left_out`."""
        return replace(ahead, problem=without(ahead, self.taken(name, ahead) | set(left_out)))


class _Partner(Planner):
    """A planner that leaves to others what they fetch."""

    def __init__(self, name: str, team: Joint) -> None:
        super().__init__()
        self._name, self._team = name, team

    def reset(self, brief: Brief) -> None:
        super().reset(brief)
        self._crowded: set[str] = set()
        self._waited = 0

    def first(self, ahead: Outlook) -> First | None:
        return super().first(self._team.shared(self._name, ahead, self._crowded))

    def _choose(self, decision: Decision) -> Action:
        """As all searchers; what another robot does something about it leaves alone, and what is near to its work."""
        self._crowded = self._team.crowded_things(self._name, decision)
        action = super()._choose(decision)
        if self._team.denied(self._name, decision, action):
            kept, self._mitigator, self._gale = (self._mitigator, self._gale), None, None
            action = super()._choose(decision)
            self._mitigator, self._gale = kept
        waits = action.target in self._crowded and self._waited < TURNS
        if waits:
            self._waited += 1
        elif action.verb not in WALKS:  # a walk is followed by what it waited for, or two wait for each other for ever
            self._waited = 0
        return self._say("another robot is at work there", Action(EXPLORE)) if waits else action

    def _without_plan(self, decision: Decision, ahead: Outlook) -> Action:
        others = self._team.fetched(self._name) | self._crowded
        left = tuple(name for name in ahead.targets if name not in others)
        places = tuple(mark for mark in ahead.lookouts if mark.name not in others)
        return super()._without_plan(decision, replace(ahead, targets=left, lookouts=places))
