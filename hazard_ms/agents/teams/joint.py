"""The joint planner of teams: every robot plans the whole rest of its rescue, and no two plan to fetch the same thing.

At each decision of a robot the plans of all are made anew, one after another, each without what those before it fetch:
once with this robot first, once last. The order that saves more in sum is taken. That is one step of best responses;
two robots get the best of both orders, more robots of two of the orders that there are. Arms that reach do not look out
for other robots, so none goes for what is near to where another one works; at a cart it waits for its turn. What they
fetch, and where they work and search, robots know of one another; each plans for what it has seen, or was told of: a
robot that sees targets that nobody has told of yet tells the others, with the verb `tell`.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from hazard_ms.agents.planner import BEAM, Planner
from hazard_ms.agents.search.outlook import Outlook
from hazard_ms.agents.search.searcher import First
from hazard_ms.agents.team import APPROACH, TeamAgent
from hazard_ms.planning.orienteering import solve
from hazard_ms.planning.problem import Plan, Problem
from hazard_ms.registry.mitigations import PUBLISHED, TELL
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.telling import LONGEST

MOST_LABELS = 2_000  # of the search for the plan of one robot, while it is open who fetches what [ours]
APART = 2.0  # distance from where another robot works within which none begins to [m] [ours: twice a reach of 1 m]
STANDING = 1.2  # distance from one that stands, its arm tucked, within which none begins to [m] [ours: a reach, a base]
SOON = 4.0  # way within which a robot that walks to its work keeps others from there [m] [ours: above two walks]
PUSH = "push"  # the verb of pushing the cart at hand to a thing
TURNS = 3  # looks around in a row with which it waits for its turn at most [ours]

Place = tuple[float, float]  # x, y [m], world frame


class Joint(TeamAgent):
    """Planners that divide the targets, and the places to search, by what saves most in sum."""

    def __init__(self, tells: bool = True) -> None:
        """`tells`: whether robots tell one another of the targets that they see."""
        self._tells = tells

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        self._partners = {name: _Partner(name, self) for name in briefs}
        for name, brief in briefs.items():
            self._partners[name].reset(brief)
        self._ahead: dict[str, Outlook] = {}  # what each robot planned on when it was last asked
        self._aims: dict[str, str] = {}  # what each robot is on its way to, or holds
        self._measures: dict[str, str] = {}  # what each robot does something about, other than to rescue it
        self._rescued: set[str] = set()
        self._told: set[str] = set()  # targets of which any robot has told the others
        self._work: dict[str, list[Place]] = {}  # where each robot works [m]
        self._stands: dict[str, Place] = {}  # where each robot stands that does nothing about things [m]

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        for name, decision in decisions.items():
            if decision.last_result is None or decision.last_result.reason not in UNFINISHED:
                self._aims.pop(name, None)
            self._measures.pop(name, None)
            self._work.pop(name, None)
            self._stands[name] = decision.agent_position
            self._rescued = {target.name for target in decision.targets if target.rescued}
            if decision.held is not None:
                self._aims[name] = decision.held
        made, notes = {}, dict[str, str | None]()
        for name, decision in decisions.items():
            news = self._news(decision) if self._tells and len(self._partners) > 1 else ""
            if news:
                made[name], notes[name] = Action(TELL, news), "the others may not have seen it"
                continue
            action = self._partners[name].act(decision)
            notes[name] = self._partners[name].note
            if action.verb == STOP and self.fetched(name):
                action, notes[name] = Action(EXPLORE), "it may be needed when another fails"
            self._aims.pop(name, None)
            if decision.held is not None:
                self._aims[name] = decision.held
            if action.verb == STOP:
                self._ahead.pop(name, None)
            elif action.verb in APPROACH and action.target is not None:
                self._aims[name] = action.target
            if action.target is not None and _measure(action, decision):
                self._measures[name] = action.target
            self._work[name] = places_of(decision, action)
            leaves = action.verb in (WALK_TO, WALK_ONE_STEP)
            if leaves:  # where it will be only later is free for others
                here = decision.agent_position
                self._work[name] = [place for place in self._work[name] if math.dist(place, here) <= SOON]
            if self._work[name] or leaves or action.verb == STOP:  # what one that has stopped is near to is not lost
                self._stands.pop(name)
            made[name] = action
        self.notes = notes
        return made

    def _news(self, decision: Decision) -> str:
        """A message that names the targets on the map of which nobody has told yet; empty where there is none to send.

        Who stands before what it walked up to takes it first, and who failed thinks about that first.
        """
        last = decision.last_result
        seen = [t.name for t in decision.targets if t.index in decision.map.objects and not t.rescued]
        new = [name for name in seen if name not in self._told]
        if not new or decision.walked_up_to is not None or last is None or not last.ok:
            return ""
        text = ""
        for name in new:
            if len(text) + len(name) + 2 <= LONGEST:
                text += f", {name}" if text else name
                self._told.add(name)
        return text

    def handled(self, name: str) -> set[str]:
        """The tools, doors, fires and carts that the other robots than `name` fetch, turn, put out or push."""
        return {thing for other, thing in self._measures.items() if other != name}

    def fetched(self, name: str) -> set[str]:
        """The things that other robots than `name` are on their way to, or hold."""
        return {aim for other, aim in self._aims.items() if other != name}

    def crowded(self, name: str, places: Iterable[Place]) -> bool:
        """Whether any of the `places` [m] is near to where another robot than `name` works, or nearer to one."""
        busy = [(place, APART) for other, row in self._work.items() if other != name for place in row]
        busy += [(place, STANDING) for other, place in self._stands.items() if other != name]
        return any(math.dist(place, one) < gap for place in places for one, gap in busy)

    def shared(self, name: str, ahead: Outlook, left_out: Collection[str] = ()) -> Outlook:
        """The part of what lies `ahead` of the robot `name` that is left to it, without what is `left_out`."""
        self._ahead[name] = ahead
        taken = set(self._aims.values()) | self._rescued
        others = [other for other in self._ahead if other != name]
        first = self._planned([name, *others], taken)
        last = self._planned([*others, name], taken)
        order = first if _sum(first) >= _sum(last) else last
        before: set[str] = self.fetched(name) | self._rescued
        for other, (plan, goals) in order.items():
            if other == name:
                break
            before |= {goals.name(rescue.target) for rescue in plan.rescues}
        return without(ahead, before | set(left_out))

    def _planned(self, names: list[str], taken: Collection[str]) -> dict[str, tuple[Plan, Outlook]]:
        """The plans of the robots `names`, one after another, without what is `taken`."""
        made: dict[str, tuple[Plan, Outlook]] = {}
        gone = set(taken)
        for name in names:
            own = self._aims.get(name)
            ahead = without(self._ahead[name], gone - {own})
            plan = solve(ahead.problem, MOST_LABELS, BEAM)
            made[name] = plan, ahead
            gone |= {ahead.name(rescue.target) for rescue in plan.rescues}
        return made


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
        known = {name: place_of(decision, name) for name in decision.names}
        self._crowded = {name for name, at in known.items() if at and self._team.crowded(self._name, [at])}
        action = super()._choose(decision)
        busy = action.verb not in PUBLISHED and self._team.crowded(self._name, places_of(decision, action))
        if busy or (action.target is not None and action.target in self._team.handled(self._name)):
            kept, self._mitigator, self._gale = (self._mitigator, self._gale), None, None
            action = super()._choose(decision)
            self._mitigator, self._gale = kept
        self._waited = self._waited + 1 if action.target in self._crowded and self._waited < TURNS else 0
        return self._say("another robot is at work there", Action(EXPLORE)) if self._waited else action

    def _without_plan(self, decision: Decision, ahead: Outlook) -> Action:
        others = self._team.fetched(self._name) | self._crowded
        left = tuple(name for name in ahead.targets if name not in others)
        places = tuple(mark for mark in ahead.lookouts if mark.name not in others)
        return super()._without_plan(decision, replace(ahead, targets=left, lookouts=places))


def without(ahead: Outlook, names: Collection[str]) -> Outlook:
    """The same in which the goals called `names` count nothing; but for what is in the hand."""
    problem = ahead.problem
    counts = [goal == problem.holding or ahead.name(goal) not in names for goal in range(len(problem.values))]
    return ahead if all(counts) else replace(ahead, problem=_of(problem, counts))


def _of(problem: Problem, counts: list[bool]) -> Problem:
    return replace(problem, values=np.where(counts, problem.values, 0.0).tolist())


def place_of(decision: Decision, thing: str | None) -> Place | None:
    """The place [m] of a thing on the map; None where it is not known, or no thing."""
    seen = decision.map.objects.get(decision.index(thing)) if thing in decision.names else None
    return None if seen is None else (float(seen.position[0]), float(seen.position[1]))


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


def _sum(plans: Mapping[str, tuple[Plan, Outlook]]) -> float:
    return sum(plan.value for plan, _ in plans.values())
