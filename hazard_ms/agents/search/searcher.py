"""The rules that `planner` and `mcts` share: when to look, walk, pick up and put away. They differ in what is first."""

from __future__ import annotations

import abc
from typing import NamedTuple

import numpy as np

from hazard_ms.agents.attempts import Enclosure, Repeats
from hazard_ms.agents.base import CLOSER, DOUBTFUL, Agent, distance, known, open_targets
from hazard_ms.agents.gale.aims import aims_of
from hazard_ms.agents.search.memory import Memory, place_of
from hazard_ms.agents.search.mitigating import Mitigator
from hazard_ms.agents.search.outlook import Outlook, Weights, outlook, thing_of
from hazard_ms.agents.search.walks import way_end
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import NO_PATH, TOO_FAR
from hazard_ms.skills.motor.walking import MIDPOINT
from hazard_ms.spec.checks import whole

FARTHEST = 2.2  # distance from the base at which a pick-up surely may begin: 2.5 m from the shoulder [m]
REACH = 0.2  # way to a target from which it is picked up without walking up to it first [m]
DROP_WAY = 0.7  # way left to a cart from which a drop drives on by itself, while the arm unfolds [m] [ours]
MOST_WAITS = 6  # looks around of 60 frames in a row where no way leads anywhere [hazard_ms.skills.context: BUMP_MEMORY]
GIVE_UP = 4  # failures with one thing, after which it is given up [ours]
MOST_FAILURES = 100  # any larger number to give up at must be a mistake [ours]


class First(NamedTuple):
    """The beginning of a plan: a goal of the outlook, the cart that it is for, -1 for none, and the reason."""

    goal: int
    cart: int
    why: str


class Searcher(Agent):
    """An agent that forms beliefs, plans the rest of the rescue at each decision, and does what comes first."""

    colours = False

    def __init__(self, weights: Weights, reach: float, give_up: int, mitigate: bool = True) -> None:
        """Choose how it weighs things.

        `reach`: length of the way to a target from which it is picked up without a walk first [m]; `give_up`: failures
        after which a thing is given up; `mitigate`: whether it acts on hazards themselves where it can. Raises
        ValueError unless the first is from 0 to FARTHEST and the second a positive whole number.
        """
        if not 0.0 <= reach <= FARTHEST:
            raise ValueError(f"reach must be from 0 to {FARTHEST} m, got {reach!r}")
        self._reach, self._mitigate = reach, mitigate
        self._weights, self._give_up = weights, whole(give_up, 1, MOST_FAILURES, "give_up")

    def reset(self, brief: Brief) -> None:
        """Begin an episode with an empty memory."""
        self._brief, self._memory = brief, Memory(brief.random_seed, self._weights.belief > 0.0)
        acts = self._mitigate and brief.several_rooms and brief.averted and brief.mitigations
        self._mitigator = Mitigator(brief, self._memory) if acts else None
        self._gale = aims_of(brief, self._mitigate)
        self._repeats, self._enclosure, self._waits = Repeats(bool(brief.mitigations)), Enclosure(), 0
        self._goal: tuple[str, frozenset[str]] | None = None  # where it goes to search, and the targets known then

    def act(self, decision: Decision) -> Action:
        """The next action: put away what it holds, else what the rest of the rescue begins with."""
        self._memory.note(decision)
        self._note_barred(decision)
        if self._mitigator is not None:
            self._mitigator.note(decision)
        if self._gale is not None:
            self._gale.see(decision)
        action = self.asked(decision, self._brief.verb) or self._waiting(decision) or self._choose(decision)
        if (other := self._repeats.instead(decision, action)) is not None:
            action = self._say(self._repeats.note, other)
        self._memory.chose(decision, action)
        return action

    @abc.abstractmethod
    def first(self, ahead: Outlook) -> First | None:
        """The goal to begin with; None where none can be reached in time."""

    def _choose(self, decision: Decision) -> Action:
        last, result = decision.last_action, decision.last_result
        if last is None or result is None:
            return self._say("look around first", Action(EXPLORE))
        if decision.targets and all(target.rescued for target in decision.targets):
            return self._say("every target is rescued", Action(STOP))
        tool = any(tool.held for tool in decision.tools)
        if decision.held is not None and not decision.containers and not tool:
            return self._say("into the bag", Action(DROP))
        arrived = decision.walked_up_to
        if decision.held is None and arrived in open_targets(decision):
            if arrived not in known(decision, (arrived,)):
                return self._say("it is perhaps elsewhere by now", Action(EXPLORE))
            return self._say("it is here", Action(PICK_UP, arrived))
        if decision.held is not None and arrived in decision.containers:
            return self._say("over the cart", Action(DROP, arrived))
        if not result.ok and result.reason == TOO_FAR and self._memory.failures.get(last.target or "") == 1:
            return self._say("it is perhaps elsewhere by now", Action(EXPLORE))
        if self._mitigator is not None and (door := self._mitigator.way_out(decision)) is not None:
            self._goal = None
            return self._say(self._mitigator.why, door)
        searching = self._still_searching(decision, arrived)
        if searching is not None:
            return searching
        ahead = outlook(self._brief, decision, self._memory, self._weights, self._give_up)
        measure = None if self._mitigator is None else self._mitigator.action(decision, ahead)
        if self._mitigator is not None and measure is not None:
            return self._say(self._mitigator.why, measure)
        if self._gale is not None:
            ahead = self._gale.aimed(decision, ahead)
            if (lee := self._gale.put_away(decision, ahead.to_cart(self._memory.failures))) is not None:
                return self._say(self._gale.note, lee)
            if (push := self._gale.push(decision, ahead)) is not None:
                return self._say(self._gale.note, push)
        begin = None if decision.held is not None and not ahead.carts else self.first(ahead)
        if begin is None:
            return self._without_plan(decision, ahead)
        if decision.held is not None:
            return self._say(begin.why, self._towards(decision, ahead.carts[begin.cart], ahead.way_to_cart(begin.cart)))
        name = ahead.name(begin.goal)
        if ahead.is_search(begin.goal):
            return self._search(decision, name, begin.why)
        near = distance(decision, decision.map.objects[decision.index(name)]) < FARTHEST
        near &= ahead.way(begin.goal) <= self._reach and not self._memory.failures.get(name)
        there = last == Action(WALK_ONE_STEP, name) and result.frames == 0  # and it is farther by now
        if not near and not there and self._doubtful(decision, name) and ahead.way(begin.goal) > CLOSER:
            return self._say(f"closer first: {begin.why}", Action(WALK_ONE_STEP, name))
        return self._say(begin.why, Action(PICK_UP if near else WALK_TO, name))

    def _note_barred(self, decision: Decision) -> None:
        """Enter where the last way ends if something bars it."""
        last, result, seen = decision.last_action, decision.last_result, decision.map
        if not self._brief.several_rooms or last is None or last.target is None or last.verb != WALK_TO:
            return
        at = {o.name: (o.position[0], o.position[1]) for o in decision.openings}
        goal = place_of(decision, last.target) or at.get(last.target)
        if result is not None and result.reason == NO_PATH and goal is not None:
            end = way_end(seen, decision.agent_position, goal, decision.openings, self._brief.radius)
            self._memory.barred[last.target] = end

    def _waiting(self, decision: Decision) -> Action | None:
        """A look around where no way leads anywhere: after a time, what it ran into bars no more ways."""
        blamed, last, result = self._enclosure.noticed(decision), decision.last_action, decision.last_result
        if last is not None and last.verb in (WALK_TO, WALK_ONE_STEP) and result and result.reason != NO_PATH:
            self._waits = 0
        if not blamed or self._waits == MOST_WAITS:
            return None
        for name, times in blamed.items():
            if name in self._memory.failures:
                self._memory.failures[name] -= min(times, self._memory.failures[name])
        self._waits += 1
        return self._say("no way leads anywhere now", Action(EXPLORE))

    def _doubtful(self, decision: Decision, name: str) -> bool:
        """Whether a target may well be something else, so that a closer look may change the plan."""
        return self._weights.belief * (1.0 - decision.target(name).belief) > DOUBTFUL

    def _towards(self, decision: Decision, cart: str, way: float) -> Action:
        """The next action with what is for a `cart` at the end of a `way` [m]: a drop drives on by itself."""
        away = distance(decision, decision.map.objects[decision.index(cart)])
        if self._memory.failures.get(cart):
            return Action(WALK_TO, cart)
        if away <= FARTHEST and way <= DROP_WAY:
            return Action(DROP, cart)
        step = Action(WALK_ONE_STEP, cart)
        return step if way <= DROP_WAY + MIDPOINT and decision.last_action != step else Action(WALK_TO, cart)

    def _search(self, decision: Decision, name: str, why: str) -> Action:
        """Begin to walk to a place from which to look around."""
        self._memory.visits[name] = self._memory.visits.get(name, 0) + 1
        self._goal = name, frozenset(known(decision, open_targets(decision)))
        return self._say(why, Action(WALK_TO, name))

    def _still_searching(self, decision: Decision, arrived: str | None) -> Action | None:
        """Go on with a search until it has looked around, unless a new target came into view or the way is blocked."""
        if self._goal is None:
            return None
        name, targets = self._goal
        if arrived == name:
            self._goal = None
            return self._say("look around from here", Action(EXPLORE))
        if self._memory.failures.get(name) or frozenset(known(decision, open_targets(decision))) - targets:
            self._goal = None
            return None
        return self._say(f"on the way to {name}, to search there", Action(WALK_TO, name))

    def _without_plan(self, decision: Decision, ahead: Outlook) -> Action:
        """Try what is nearest, although it is unlikely to be safe in time; stop where nothing is left to try.

        A detector overlooks things: where some must be left, the search begins anew.
        """
        holding = decision.held is not None
        names = [n for n in (ahead.carts if holding else ahead.targets) if n != decision.held]
        searching = not names
        opening = None if names or self._mitigator is None else self._mitigator.opening(decision)
        if self._mitigator is not None and opening is not None:
            return self._say(self._mitigator.why, opening)
        if searching:
            names = [mark.name for mark in ahead.lookouts]
        if not names and self._brief.looks and (ahead.unseen > 0.0 or holding):
            self._memory.visits.clear()
            self._memory.looks.clear()
            return self._say("search anew: something was overlooked", Action(EXPLORE))
        if not names:
            return self._say("nothing is left to try", Action(STOP))
        places = {mark.name: np.array(mark.place) for mark in ahead.lookouts}
        places |= {name: thing.position[:2] for name in names if (thing := thing_of(decision, name)) is not None}
        marks, why = [decision.agent_position], "too late by any plan, but the nearest"
        if searching and self._brief.several_rooms and self._memory.barred:
            why = f"look again at what barred the way to {', '.join(self._memory.barred)}"
            marks = self._memory.try_ways_again()
        name = min(names, key=lambda n: min(float(np.hypot(*(places[n] - mark))) for mark in marks))
        if searching:
            return self._search(decision, name, why)
        return self._say(why, Action(WALK_TO, name))

    def _say(self, note: str, action: Action) -> Action:
        self.note = note
        return action
