"""Chooses what an agent does about the hazards of a home before it rescues, by what is averted, and says why.

An extinguisher is fetched where a fire that is known threatens more than the way there costs; a door is shut where what
is behind it would be wet before it is saved (`sketch/planning/beginning.py`). What was begun is gone on with as long as
it averts anything, whatever else would avert more. What is shut is opened only where nothing else is left to do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.search.candidates import EXTINGUISH, TRIES, Candidate, candidates
from hazard_ms.agents.search.forecast import WATER
from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.outlook import Outlook, thing_of
from hazard_ms.agents.search.walks import barring, frames_between
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sketch.planning.averting import kept
from hazard_ms.sketch.planning.beginning import Course, best_course
from hazard_ms.sketch.planning.measures import Measure, Measures, with_unseen
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision, Tool
from hazard_ms.skills.failures import NO_PATH, NOT_BURNING, UNFINISHED
from hazard_ms.skills.motor.walking import ARRIVED

OPEN, SHUT = "open", "shut"
LOOKS = (WALK_TO, EXPLORE)  # verbs of measures that look for fires
MOST_LABELS, BEAM = 400, 20  # of the search for the rescues after measures [ours]: a tenth of a second
PUT_DOWN = 80.0  # frames of putting down a tool [measured: 66 to 112]
# share of the value of targets by which rescues alone must be better for a charged tool to be put down: it is often
# wanted again a little later, which takes 250 frames [ours]
HOLDS_ON = 0.01
# share of what would be lost that measures must avert to be begun in water: rescues wait meanwhile [measured: boards
# that were to avert 2 % in house_flood_test_1/03 took 1,000 frames, and less was averted]
LEAST_IN_WATER = 0.1
ENOUGH = 0.3  # distance from where a fire is fought at which a walk there ends [hazard_ms.skills.mitigations.views]
SAME_PLACE = 1.5  # distance within which a fire, or a door, is the one that was there [m] [ours]


class Mitigator:
    """Chooses measures in one episode, and says why."""

    def __init__(self, brief: Brief, memory: Memory) -> None:
        """Begin an episode; `memory` is that of the agent."""
        self._brief, self._memory = brief, memory
        self._water = any(hazard.name == WATER for hazard in brief.hazards)
        self._put_down: dict[str, int] = {}  # how often each tool was put down
        self._opened: set[str] = set()
        self._swung: set[str] = set()  # doors that were shut since their leaves stood in the way
        self._barred = False  # whether it puts down a tool to open a door
        self._aim: tuple[float, float] | None = None  # of the jet [m]
        self._begun: Candidate | None = None  # what it fetches a tool for, or goes to, and has not yet done
        self.why = ""

    def note(self, decision: Decision) -> None:
        """Enter what the last action came to."""
        last, result = decision.last_action, decision.last_result
        if last is None or result is None or last.target is None:
            return
        failed = not result.ok and result.reason not in UNFINISHED
        if last.verb == SHUT and failed and self._memory.failures.get(str(last), 0) < TRIES:
            self._swung.discard(last.target)  # what stood in its swing may be elsewhere next time
        if last.verb != EXTINGUISH:
            return
        if not result.ok and result.reason != NOT_BURNING:
            return
        seen = decision.map.objects.get(decision.index(last.target))
        if result.ok and self._aim is not None:
            self._memory.house.put_out(self._aim, decision.frame, True)
        if seen is not None:  # where nothing burned around a thing the fire may still be, but not there
            x, y, _ = seen.position.tolist()
            self._memory.house.put_out((x, y), decision.frame, False)
        self._begun = None

    def action(self, decision: Decision, ahead: Outlook) -> Action | None:
        """The measure to begin with, or the end of one; None where a rescue or a search comes first."""
        held = next((tool for tool in decision.tools if tool.held), None)
        found = candidates(self._brief, decision, self._memory, ahead, self._put_down)
        first = self._first(decision, ahead, found, held)
        if first is None and held is not None:
            self._put_down[held.name] = self._put_down.get(held.name, 0) + 1
            self.why = f"{held.name} is of no use any more"
            return Action(DROP)
        if first is None:
            return None
        self._aim = first.place if first.action.verb == EXTINGUISH else None
        name = first.action.target
        if first.action.verb == WALK_TO and name is not None and decision.walked_up_to == name:
            self._begun = None
            self._memory.visits[name] = self._memory.visits.get(name, 0) + 1
            return Action(EXPLORE)
        if first.action.verb == PICK_UP and decision.walked_up_to != name:
            return Action(WALK_TO, name)
        return first.action

    def _first(
        self, decision: Decision, ahead: Outlook, found: Sequence[Candidate], held: Tool | None
    ) -> Candidate | None:
        course = None
        for tried in (self._begun_among(found), found):
            if any(one.charge == 0.0 for one in tried):
                course = self._course(decision, ahead, tried, held)
            if course is not None:
                found = tried
                break
        if course is None:
            self._begun = None
            return None
        steps = [found[step.measure] for step in course.steps]
        end = next(step for step in steps if step.charge == 0.0)
        if end.action.verb in LOOKS:  # looks are listed by what they show for their distance: the best one first
            looks = [one for one in found if one.action.verb in LOOKS and one.tool == end.tool]
            if looks[0].action.verb != EXPLORE:  # what takes no walk is never on another way
                looks = [one for one in looks if self._begun and one.action == self._begun.action] or looks
            steps = [looks[0] if step is end else step for step in steps]
            end = looks[0]
        self._begun = end
        told = ", ".join(f"{step.name} by {at.done:.0f}" for step, at in zip(steps, course.steps, strict=True))
        self.why = f"{told}: averts {course.value:.1f} with rescues after it, {course.plain:.1f} by rescues alone"
        return steps[0]

    def _begun_among(self, found: Sequence[Candidate]) -> list[Candidate]:
        """What it has begun, as it is among those `found` now, and the tools; none where it has begun nothing."""
        begun = self._begun
        seen = any(one.action.verb == EXTINGUISH for one in found)
        if begun is None or (begun.action.verb in LOOKS and seen):  # what burns comes before what may burn
            return []
        alike = [
            one for one in found if (one.action.verb, one.tool) == (begun.action.verb, begun.tool) and one.charge == 0.0
        ]
        same = [one for one in alike if np.hypot(*np.subtract(one.place, begun.place)) <= SAME_PLACE][:1]
        if begun.action.verb in LOOKS:  # what is no longer worth a look there may be elsewhere
            same = [one for one in found if one.action.verb in LOOKS and one.tool == begun.tool]
        return [*(one for one in found if one.charge > 0.0), *same]

    def _course(
        self, decision: Decision, ahead: Outlook, found: Sequence[Candidate], held: Tool | None
    ) -> Course | None:
        """The best course of those `found`, if it begins with one of them."""
        rows = {
            (one.guards, at): one.unseen / len(one.unseen_at) for one in found for at in one.unseen_at if one.unseen > 0
        }
        problem = with_unseen(ahead.plain, ahead.frames, [(value, at) for (_, at), value in rows.items()])
        guarded = [name for name, _ in rows]
        measures = _measures(decision, ahead, found, guarded, held, self._brief.radius)
        margin = 0.0 if held is None else HOLDS_ON * sum(t.value for t in decision.targets if not t.rescued)
        if held is None and self._begun is None and self._water:
            margin = -LEAST_IN_WATER * (sum(problem.values) - kept(problem))
        course = best_course(problem, measures, most_labels=MOST_LABELS, beam=BEAM, margin=margin)
        return course if course.steps and course.before is None else None

    def way_out(self, decision: Decision) -> Action | None:
        """A door to turn where the last walk found no way, or to go on turning; None where there is none."""
        last, result = decision.last_action, decision.last_result
        if last is None or result is None:
            return None
        turned = last.verb == OPEN or (last.verb == SHUT and last.target in self._swung)
        if turned and result.reason in UNFINISHED and self._memory.failures.get(str(last), 0) < TRIES:
            return last if last in decision.available else None
        barred = last.verb in (WALK_TO, WALK_ONE_STEP) and result.reason == NO_PATH
        if barred and any(tool.held for tool in decision.tools) and (self._leaf(decision) or self._bar(decision)):
            self._barred, self.why = True, "there was no way, and only an empty hand turns a door"
            return Action(DROP)
        barred, self._barred = barred or self._barred, False
        return self._turned(decision, "there was no way") if barred else None

    def opening(self, decision: Decision) -> Action | None:
        """A door to turn where nothing else is left to do, each once; None where there is none."""
        return self._turned(decision, "there may be more behind it", not self._water)  # which would come in

    def _turned(self, decision: Decision, why: str, opens: bool = True) -> Action | None:
        """The door to shut since its leaf bars the way, or else, if it `opens` doors, to open, each once; or None."""
        bar, door = self._bar(decision), self._leaf(decision) if opens else None
        if bar is not None and Action(SHUT, bar) in decision.available:
            self._swung.add(bar)
            self.why = f"{why}: its leaf stands there"
            return Action(SHUT, bar)
        if door is None or Action(OPEN, door) not in decision.available:
            return None
        self._opened.add(door)
        self.why = why
        return Action(OPEN, door)

    def _bar(self, decision: Decision) -> str | None:
        """The door whose open leaf bars the way, but for those that were shut for it; None where there is none."""
        doors = [o for o in decision.openings if o.name not in self._swung]
        door = barring(decision.map, decision.agent_position, doors, self._brief.radius)
        return None if door is None or SHUT not in self._brief.mitigations else door.name

    def _leaf(self, decision: Decision) -> str | None:
        """The nearest inner door that can be opened farther, those that are ajar first; None where there is none."""
        if OPEN not in self._brief.mitigations:
            return None
        here = np.array(decision.agent_position)
        doors = [o for o in decision.openings if o.kind == "door" and o.open < 0.9 and not (o.broken or o.outer)]
        doors = [o for o in doors if o.name not in self._opened]

        def order(door: KnownOpening) -> tuple[bool, float]:
            return door.open == 0.0, float(np.hypot(*(np.array(door.position[:2]) - here)))

        return min(doors, key=order).name if doors else None


def _measures(
    decision: Decision,
    ahead: Outlook,
    found: Sequence[Candidate],
    unseen: Sequence[str],
    held: Tool | None,
    radius: float,
) -> Measures:
    """The candidates as measures of the problem `with_unseen`."""
    goals = len(ahead.targets) + len(ahead.lookouts)
    seen = [thing_of(decision, ahead.name(goal)) for goal in range(goals)]
    here = np.asarray(decision.agent_position, np.float64)
    marks = [*(None for _ in ahead.targets), *(np.array(mark.place) for mark in ahead.lookouts)]
    places = [m if m is not None else here if t is None else t.position[:2] for m, t in zip(marks, seen, strict=True)]
    near = [ARRIVED + (0.0 if thing is None else thing.radius) for thing in seen]
    frames = frames_between(
        decision.map,
        decision.agent_position,
        np.array([*places, *(one.stand or one.place for one in found)], np.float64).reshape(-1, 2),
        np.array([*near, *(ENOUGH if one.stand else one.near for one in found)], np.float64),
        radius,
        walls=True,
    )
    first, start = goals, goals + len(found)
    fetched = {one.name: k for k, one in enumerate(found) if one.charge > 0.0}
    made = []
    for one in found:
        spares = [
            *one.spares,
            *[0.0] * len(ahead.lookouts),
            *(np.inf if one.guards == name else 0.0 for name in unseen),
        ]
        needs = fetched[one.tool] if one.tool else None
        stays = None if one.stays is None else [*one.stays, *[0.0] * (len(spares) - len(one.stays))]
        made.append(Measure(one.name, one.frames, spares, needs, one.uses, one.charge, stays, one.closes))
    unreachable = np.full((len(unseen), len(found)), np.inf)
    return Measures(
        made,
        to=np.vstack([frames[:goals, first:start], unreachable, frames[start:, first:start]]),
        between=frames[first:start, first:start],
        onward=np.hstack([frames[first:start, :goals], unreachable.T]),
        in_hand=None if held is None else fetched.get(held.name),
        put_down=PUT_DOWN,
    )
