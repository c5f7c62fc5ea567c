"""Our greedy agent, after the paper's: always the known target of the lowest cost; looks around when it knows none.

    cost = (distance + HANDLING * belief) * (1 + failures)^2 / (predicted value * belief)

The predicted value is halved where the target is damaged, or where a hazard threatens it by the time of arrival, with
the hazard's level continued along the straight line through the last two sightings. A target that failed repeatedly
gets a growing cost and is given up at last, so no path is tried for ever. Values count by the belief that the thing is
what it seems to be, 1 with the truth; what is not is refused at once, and costs no handling. A pick-up that met no
target does not count as a failure: it ends the belief. On the way to what may be something else it decides anew at each
step.
It searches where no target is known, or only such as are far and hardly believed; these come when nothing is left to
search. With a detector, which overlooks things, it then begins to search anew.
Searching: walk to the landmark with the most unexplored floor around it, then look around there. Where walls divide
the place, distances are those of the ways round them, things to which none leads are left out, and landmarks are places
from which floor that was not seen yet comes into sight.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.agents.attempts import Repeats
from hazard_ms.agents.base import CLOSER, DOUBTFUL, Agent, distance, ends_belief, known, open_targets
from hazard_ms.agents.search.lookouts import lookouts
from hazard_ms.agents.search.stands import stands
from hazard_ms.sensing.detection.eyes import FAR
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import NOT_A_TARGET
from hazard_ms.skills.options.landmarks import AROUND, frontier

WALKING = 1.0 / 62.0  # [m/frame] (docs/benchmark.md 1)
HANDLING = 1.0  # what picking up costs, as a distance: about 60 frames [m]
NEAR = 0.7  # from here it reaches for a target without walking: arrival is at 0.5 m, and a position has some error [m]
PROGRESS = 0.2  # a walk that got it this far is not a failure, even if it did not arrive [m]
LEGS = 8  # walks without arrival to one target that together count as a failure: 13 m, longer than any way in a room
GIVE_UP = 4  # failures with one target
LOYALTY = 0.8  # factor on the cost of the target it is on its way to: another must be clearly better
VISITS = 2  # of one landmark in search
UNLIKELY, FAR_OFF = 0.15, 1.5  # belief below which, and way from which on, searching comes first [-], [m]


class Greedy(Agent):
    """Rule of the paper with the target, and in wind the container, of the lowest cost."""

    colours = False

    def __init__(self, give_up: int = GIVE_UP, belief: bool = True) -> None:
        """`give_up`: failures after which a target is given up; `belief`: whether values count by what it believes.

        Raises ValueError unless `give_up` is positive.
        """
        if give_up < 1:
            raise ValueError(f"give_up must be at least 1, got {give_up}")
        self._give_up, self._belief = give_up, belief
        self.left_to_others: frozenset[str] = frozenset()  # targets that other robots of its team fetch

    def reset(self, brief: Brief) -> None:
        """Forget the last episode. Nothing is random."""
        self._hazards, self._damaged_share = brief.hazards, brief.damaged_share
        self._failures: dict[str, int] = {}
        self._visits: dict[int, int] = {}
        self._radius = brief.radius if brief.several_rooms else None  # of the robot where walls count [m]
        self._sight, self._detects = brief.sight, brief.looks
        self._looks: list[tuple[float, float]] = []  # where it has looked around [m]
        self._looked_from: tuple[float, float] | None = None  # where it last looked around [m]
        self._look_again = False
        self._landmark: str | None = None  # to which a search is on its way
        self._legs: dict[str, int] = {}
        self._before: tuple[Action, tuple[float, float]] | None = None  # the last action, and where it began [m]
        self._verb, self._repeats = brief.verb, Repeats(bool(brief.mitigations))

    def act(self, decision: Decision) -> Action:
        """The next action: put away what it holds, else fetch the cheapest target, else search."""
        self._judge(decision)
        action = self.asked(decision, self._verb) or self._choose(decision)
        if (other := self._repeats.instead(decision, action)) is not None:
            action, self.note = other, self._repeats.note
        self._before = (action, decision.agent_position)
        if action.verb == EXPLORE:
            self._looked_from, self._look_again = decision.agent_position, False
            self._looks.append(decision.agent_position)
        return action

    def has_given_up(self, name: str) -> bool:
        """Whether it no longer tries to fetch the target `name`."""
        return self._failures.get(name, 0) >= self._give_up

    def _judge(self, decision: Decision) -> None:
        """Count the last action's failure, unless it was a walk that came further."""
        if self._before is None or decision.last_result is None or decision.last_result.ok:
            return
        action, start = self._before
        if action.target is None:
            return
        refused = decision.last_result.reason == NOT_A_TARGET
        if self._belief and refused and ends_belief(decision, action.target):
            return
        way = float(np.hypot(*(np.asarray(decision.agent_position) - start)))
        if action.verb in (WALK_TO, WALK_ONE_STEP) and way > PROGRESS:
            self._legs[action.target] = self._legs.get(action.target, 0) + 1
            if self._legs[action.target] % LEGS:
                return
        self._failures[action.target] = self._failures.get(action.target, 0) + 1
        self._landmark = None
        self._look_again = self._failures[action.target] == 2  # perhaps it is no longer where it was seen

    def _choose(self, decision: Decision) -> Action:
        if decision.held is not None:
            return self._put_away(decision)
        if decision.targets and all(t.rescued for t in decision.targets):
            self.note = "every target is rescued"
            return Action(STOP)
        if self._looked_from is None or self._look_again:
            self.note = "look around"
            return Action(EXPLORE)
        targets = known(decision, tuple(n for n in open_targets(decision) if n not in self.left_to_others))
        ways = self._ways(decision, [name for name in targets if self._failures.get(name, 0) < self._give_up])
        costs = {name: self._cost(decision, name, targets[name], way) for name, way in ways.items()}
        arrived = decision.walked_up_to
        likely = {name: cost for name, cost in costs.items() if self._is_likely(decision, name, ways[name])}
        if not likely and (search := self._search(decision)) is not None:
            return search
        if not costs:
            return self._search_anew(decision)
        costs = likely or costs
        best = arrived if arrived in costs else min(costs, key=lambda name: costs[name])
        self._landmark = None
        self.note = f"cost {costs[best]:.2f}, the lowest of {len(costs)}"
        near = distance(decision, decision.map.objects[decision.index(best)]) < NEAR and best not in self._failures
        if best == arrived or near:
            return Action(PICK_UP, best)
        return Action(WALK_ONE_STEP if self._is_doubtful(decision, best, ways[best]) else WALK_TO, best)

    def _put_away(self, decision: Decision) -> Action:
        if not decision.containers:
            self.note = "into the bag"
            return Action(DROP)
        carts = known(decision, decision.containers)
        open_carts = [name for name in carts if self._failures.get(name, 0) < self._give_up]
        if not open_carts:
            return self._search(decision) or self._search_anew(decision)
        last = decision.last_action
        loyal = last.target if self._detects and last is not None else None  # where carts seem to be moves a little
        failed = {name: 1 + self._failures.get(name, 0) for name in open_carts}
        nearest = min(
            open_carts, key=lambda n: distance(decision, carts[n]) * failed[n] * (LOYALTY if n == loyal else 1.0)
        )
        self.note = "to the nearest cart"
        return Action(DROP if decision.walked_up_to == nearest else WALK_TO, nearest)

    def _ways(self, decision: Decision, names: list[str]) -> dict[str, float]:
        """The distances of known things [m]; where walls count, the lengths of the ways there, if there are any."""
        if self._radius is None:
            return {name: distance(decision, decision.map.objects[decision.index(name)]) for name in names}
        return {name: stand.length for name, stand in stands(decision, names, self._radius).items()}

    def _cost(self, decision: Decision, name: str, sighting: Sighting, way: float) -> float:
        way += HANDLING * (decision.target(name).belief if self._belief else 1.0)
        target = decision.target(name)
        levels, height = _predicted(sighting, decision.frame + way / WALKING), float(sighting.position[2])
        threats = zip(self._hazards, levels, strict=False)  # a level is missing where there was no hazard image
        lost = target.damaged or any(hazard.threatens(target, level, height) for hazard, level in threats)
        value = target.value * (self._damaged_share if lost else 1.0) * (target.belief if self._belief else 1.0)
        loyalty = LOYALTY if decision.last_action in (Action(WALK_TO, name), Action(WALK_ONE_STEP, name)) else 1.0
        return loyalty * way * (1 + self._failures.get(name, 0)) ** 2 / value

    def _is_likely(self, decision: Decision, name: str, way: float) -> bool:
        """Whether a target at the end of a `way` [m] is worth the walk before any search."""
        sure = not self._belief or decision.target(name).belief >= UNLIKELY
        return sure or way < FAR_OFF or name == decision.walked_up_to

    def _is_doubtful(self, decision: Decision, name: str, way: float) -> bool:
        """Whether it decides anew on the `way` [m] to a target, which may turn out to be something else."""
        result, step = decision.last_result, Action(WALK_ONE_STEP, name)
        stays = decision.last_action == step and result is not None and result.frames == 0
        doubt = 1.0 - decision.target(name).belief if self._belief else 0.0
        return doubt > DOUBTFUL and way > CLOSER and not stays

    def _search_anew(self, decision: Decision) -> Action:
        """Look around, and begin to search anew where something was overlooked; else stop: nothing is left to try."""
        unknown = [name for name in open_targets(decision) if decision.index(name) not in decision.map.objects]
        if self._detects and (unknown or decision.held is not None):
            self.note = "search anew: something was overlooked"
            self._visits.clear()
            self._looks.clear()
            return Action(EXPLORE)
        self.note = "nothing left to search"
        return Action(STOP)

    def _search(self, decision: Decision) -> Action | None:
        """Walk to the most promising landmark and look around there; None where none is left."""
        if self._landmark is not None:
            if decision.walked_up_to == self._landmark:
                self.note, self._landmark = "look around from here", None
                return Action(EXPLORE)
            self.note = f"on the way to {self._landmark}, to search there"
            return Action(WALK_TO, self._landmark)
        scores = self._landmarks(decision)
        if not scores:
            return None
        best = max(scores, key=lambda index: scores[index])
        self._visits[best] = self._visits.get(best, 0) + 1
        self._landmark = decision.names[best]
        self.note = f"search around {self._landmark}"
        return Action(WALK_TO, self._landmark)

    def _landmarks(self, decision: Decision) -> dict[int, float]:
        """The worth of walking to things in search, by index.

        It is the unexplored floor around them, over the distance and the visits paid. Where walls count, it is the
        share of what was not seen that comes into sight, in the order of `lookouts`.
        """
        if self._radius is not None or self._sight < FAR:
            visited = {decision.names[index]: count for index, count in self._visits.items()}
            avoided = [name for name, count in self._failures.items() if count >= self._give_up]
            found = lookouts(decision, visited, self._looks, avoided, self._radius, self._sight)
            return {decision.index(mark.name): -float(place) for place, mark in enumerate(found)}
        border = frontier(decision.map)
        scores = {}
        for index, sighting in decision.map.objects.items():
            visits = self._visits.get(index, 0)
            if visits >= VISITS or (visits and not len(border)) or decision.names[index] == decision.held:
                continue
            unexplored = int((np.hypot(*(border - sighting.position[:2]).T) < AROUND).sum())
            scores[index] = (1 + unexplored) / (1.0 + distance(decision, sighting)) / (1 + visits) ** 2
        return scores


def _predicted(sighting: Sighting, frame: float) -> list[float]:
    """Levels of the hazards at a thing at `frame`, on the line through its last two sightings at different frames."""
    late_frame, late = sighting.history[-1] if sighting.history else (sighting.frame, sighting.levels)
    earlier = [(f, levels) for f, levels in sighting.history if f < late_frame]
    if not earlier:
        return list(late)
    early_frame, early = earlier[-1]
    return [b + (b - a) / (late_frame - early_frame) * (frame - late_frame) for a, b in zip(early, late, strict=True)]
