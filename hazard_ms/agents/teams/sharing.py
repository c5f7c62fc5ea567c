"""Teams whose robots each plan the whole rest of their rescue, and divide what they fetch, use, turn and push.

At each decision of a robot the plans of all are made anew, one after another, each without what those before it fetch:
once with this robot first, once last. The order that saves more in sum is taken. That is one step of best responses;
two robots get the best of both orders, more robots of two of the orders that there are. Arms that reach do not look out
for other robots, so none goes for what is near to where another one works. What they fetch, and where they work,
robots know of one another. What they plan on is their own: `joint.py`, `oracle.py`.
"""

from __future__ import annotations

import abc
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from hazard_ms.agents.base import Agent
from hazard_ms.agents.planner import BEAM
from hazard_ms.agents.search.memory import Place, place_of
from hazard_ms.agents.team import APPROACH, TeamAgent
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Plan, Problem
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.spec.registry.mitigations import PUBLISHED, TELL

MOST_LABELS = 2_000  # of the search for the plan of one robot, while it is open who fetches what [ours]
APART = 2.0  # distance from where another robot works within which none begins to [m] [ours: twice a reach of 1 m]
STANDING = 1.2  # distance from one that stands, its arm tucked, within which none begins to [m] [ours: a reach, a base]
SOON = 4.0  # way within which a robot that walks to its work keeps others from there [m] [ours: above two walks]
WALKS = (WALK_TO, WALK_ONE_STEP)  # verbs
PUSH = "push"  # the verb of pushing the cart at hand to a thing
TURNS = 3  # looks around in a row with which a robot waits for its turn at most [ours]


class Goals(Protocol):
    """The rest of the rescue as one robot plans it."""

    @property
    def problem(self) -> Problem:
        """The problem, whose targets are the goals."""

    def name(self, goal: int) -> str:
        """The thing to which a goal leads."""


class Sharing(TeamAgent):
    """Agents that each plan for one robot, and leave to the others what these fetch and are at."""

    standing, soon = STANDING, SOON

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        self._partners = {name: self._partner(name) for name in briefs}
        for name, brief in briefs.items():
            self._partners[name].reset(brief)
        self._ahead: dict[str, Goals] = {}  # what each robot planned on when it was last asked
        self._aims: dict[str, str] = {}  # what each robot is on its way to, or holds
        self._measures: dict[str, str] = {}  # what each robot does something about, other than to rescue it
        self._rescued: set[str] = set()
        self._work: dict[str, list[Place]] = {}  # where each robot works [m]
        self._stands: dict[str, Place] = {}  # where each robot stands that does nothing about things [m]

    @abc.abstractmethod
    def _partner(self, name: str) -> Agent:
        """A new agent for the robot `name`, which asks this team what is left to it."""

    def _news(self, decision: Decision) -> str:
        """A message to the others, in place of the next action; empty where there is none to send."""
        return ""

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        for name, decision in decisions.items():
            self._ended(name, decision)
        made, notes = {}, dict[str, str | None]()
        for name, decision in decisions.items():
            if news := self._news(decision):
                made[name], notes[name] = Action(TELL, news), "the others may not have seen it"
                continue
            action = self._partners[name].act(decision)
            notes[name] = self._partners[name].note
            if action.verb == STOP and self.fetched(name):
                action, notes[name] = Action(EXPLORE), "it may be needed when another fails"
            if decision.held is None:
                self._aims.pop(name, None)
            if action.verb == STOP:
                self._ahead.pop(name, None)
            elif action.verb in APPROACH and action.target is not None:
                self._aims[name] = action.target
            if action.target is not None and _measure(action, decision):
                self._measures[name] = action.target
            places, leaves = places_of(decision, action), action.verb in WALKS
            here = decision.agent_position
            self._work[name] = [at for at in places if not leaves or math.dist(at, here) <= self.soon]
            if places or leaves or action.verb == STOP:  # what a robot that has stopped is near to is not lost
                self._stands.pop(name, None)
            else:
                self._stands[name] = decision.agent_position
            made[name] = action
        self.notes = notes
        return made

    def _ended(self, name: str, decision: Decision) -> None:
        """Note that what the robot `name` did is over, unless its walk goes on: until it has chosen again it stands."""
        result = decision.last_result
        if result is None or result.reason not in UNFINISHED:
            self._aims.pop(name, None)
        self._measures.pop(name, None)
        self._work.pop(name, None)
        self._stands[name] = decision.agent_position
        self._rescued = {target.name for target in decision.targets if target.rescued}
        if decision.held is not None:
            self._aims[name] = decision.held

    def handled(self, name: str) -> set[str]:
        """The tools, doors, fires and carts that the other robots than `name` fetch, turn, put out or push."""
        return {thing for other, thing in self._measures.items() if other != name}

    def fetched(self, name: str) -> set[str]:
        """The things that other robots than `name` are on their way to, or hold."""
        return {aim for other, aim in self._aims.items() if other != name}

    def crowded(self, name: str, places: Iterable[Place]) -> bool:
        """Whether any of the `places` [m] is near to where another robot than `name` works, or nearer to one."""
        busy = [(place, APART) for other, row in self._work.items() if other != name for place in row]
        busy += [(place, self.standing) for other, place in self._stands.items() if other != name]
        return any(math.dist(place, one) < gap for place in places for one, gap in busy)

    def crowded_things(self, name: str, decision: Decision) -> set[str]:
        """The things on the map of the robot `name` that are near to where another one works."""
        known = {thing: place_of(decision, thing) for thing in decision.names}
        return {thing for thing, at in known.items() if at and self.crowded(name, [at])}

    def denied(self, name: str, decision: Decision, action: Action) -> bool:
        """Whether the robot `name` is to leave an `action` alone: another one does it, or is at work there."""
        measure = action.verb not in PUBLISHED and self.crowded(name, places_of(decision, action))
        return measure or (action.target is not None and action.target in self.handled(name))

    def taken(self, name: str, ahead: Goals) -> set[str]:
        """The things that others fetch, or are to by the best plans of all; `ahead`: what the robot `name` plans on."""
        self._ahead[name] = ahead
        taken = set(self._aims.values()) | self._rescued  # each its own: plans that change would swap them all the time
        others = [other for other in self._ahead if other != name]
        first = self._planned([name, *others], taken)
        last = self._planned([*others, name], taken)
        order = first if _sum(first) >= _sum(last) else last
        before: set[str] = self.fetched(name) | self._rescued
        for other, plan in order.items():
            if other == name:
                break
            before |= self._names(other, plan)
        return before

    def _planned(self, names: Sequence[str], taken: Collection[str]) -> dict[str, Plan]:
        """The plans of the robots `names`, one after another, without what is `taken`."""
        made: dict[str, Plan] = {}
        gone = set(taken)
        for name in names:
            own = self._aims.get(name)
            made[name] = solve(without(self._ahead[name], gone - {own}), MOST_LABELS, BEAM)
            gone |= self._names(name, made[name])
        return made

    def _names(self, robot: str, plan: Plan) -> set[str]:
        return {self._ahead[robot].name(rescue.target) for rescue in plan.rescues}


def without(ahead: Goals, names: Collection[str]) -> Problem:
    """The problem in which the goals called `names` count nothing; but for what is in the hand."""
    problem = ahead.problem
    counts = [goal == problem.holding or ahead.name(goal) not in names for goal in range(len(problem.values))]
    return problem if all(counts) else replace(problem, values=np.where(counts, problem.values, 0.0).tolist())


def places_of(decision: Decision, action: Action) -> list[Place]:
    """The places [m] at which an action is done, as far as they are known; of a push that of the cart, too."""
    carts = [place for cart in decision.containers if (place := place_of(decision, cart)) is not None]
    goal = place_of(decision, action.target)
    if action.verb != PUSH or not carts:
        return [] if goal is None else [goal]
    nearest = min(carts, key=lambda cart: math.dist(cart, decision.agent_position))
    return [nearest, *([] if goal is None else [goal])]


def _measure(action: Action, decision: Decision) -> bool:
    """Whether an action is a measure, or goes for the tool of one."""
    return action.verb not in PUBLISHED or action.target in {tool.name for tool in decision.tools}


def _sum(plans: Mapping[str, Plan]) -> float:
    return sum(plan.value for plan in plans.values())
