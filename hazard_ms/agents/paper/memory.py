"""The memory of the paper's agents from one decision to the next, and what they make of it: the worth of a target."""

from __future__ import annotations

import math
from collections.abc import Callable

from hazard_ms.agents.base import known, open_targets
from hazard_ms.agents.paper.view import HERE, LOOK, Option, State, View, walks_between
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, EXPLORE, Action, Decision

DAMAGED_SHARE = 0.5  # of its value that a damaged target counts [docs/benchmark.md 4]
WET = 0.01  # level of the water at which the original's agents take a target for damaged [m]
CHANGES = {"fire": 1.0, "flood": 0.1}  # changes between two sightings that count: [C] and [m]
CHANGING = 2.0  # factor on the value of a target whose level changes so much

Pair = tuple[float, float]  # levels of one hazard at a target before and at its last sighting
Worth = Callable[[Target, dict[str, Pair]], float]


def predicted_value(target: Target, levels: dict[str, Pair]) -> float:
    """The value of `target`: half of it if a level passes what damages it when its last change is repeated.

    `levels` before and at the last sighting are given by the hazard's name: fire [C], flood [m].
    """
    lost = any(last + (last - before) > _limit(target, name) for name, (before, last) in levels.items())
    return target.value * (DAMAGED_SHARE if lost else 1.0)


def wetted_value(target: Target, levels: dict[str, Pair]) -> float:
    """The value of `target`: half of it if the water, its last change repeated, is deeper than what damages it.

    `levels` before and at the last sighting are given by the hazard's name: flood [m]; a fire never changes it.
    """
    return predicted_value(target, {name: pair for name, pair in levels.items() if name == "flood"})


def changing_value(target: Target, levels: dict[str, Pair]) -> float:
    """The value of `target`: twice as much where a level changed clearly between its last two sightings.

    `levels` before and at the last sighting are given by the hazard's name: fire [C], flood [m].
    """
    changing = any(abs(last - before) > CHANGES.get(name, math.inf) for name, (before, last) in levels.items())
    return target.value * (CHANGING if changing else 1.0)


def _limit(target: Target, hazard: str) -> float:
    """The level of a hazard beyond which `target` is damaged; infinity if never."""
    if hazard == "fire" and target.flammable:
        return target.ignition_temperature
    return WET if hazard == "flood" and not target.waterproof else math.inf


class Memory:
    """Remembers for an agent of the paper two levels of every hazard for each target, and the cost it last chose."""

    def __init__(self, brief: Brief) -> None:
        """Begin an episode."""
        self._hazards = tuple(hazard.name for hazard in brief.hazards)
        self._seen: dict[int, int] = {}  # frame of the last sighting at a decision, by index of the thing
        self._levels: dict[int, dict[str, Pair]] = {}
        self._paid = 0.0

    def view(self, decision: Decision) -> View:
        """The world as it is remembered at `decision`."""
        left = known(decision, open_targets(decision), missing=True)
        targets = sorted((decision.target(name) for name in left), key=_index)
        carts = sorted(known(decision, decision.containers, missing=True))
        names = ("", *(target.name for target in targets), *carts)
        seen = [decision.map.objects[decision.index(name)] for name in names[1:]]
        for target, sighting in zip(targets, seen, strict=False):
            self._note(target.index, sighting.frame, sighting.levels)
        places = [(float(sighting.position[0]), float(sighting.position[1])) for sighting in seen]
        last, result = decision.last_action, decision.last_result
        start = State(holding=decision.held is not None, left=(1 << len(targets) + 1) - 2)
        if last is not None and result is not None:
            thing = names.index(last.target) if last.target in names else HERE
            start = start._replace(verb=last.verb, thing=thing, worked=result.ok, paid=self._paid)
        walks = walks_between([decision.agent_position, *places])
        return View(names, tuple(targets), not decision.containers, walks, start)

    def _note(self, index: int, frame: int, levels: tuple[float, ...]) -> None:
        if frame <= self._seen.get(index, -1):
            return
        self._seen[index] = frame
        before = self._levels.get(index, {})
        pairs = zip(self._hazards, levels, strict=False)  # there are no levels where nothing renders
        self._levels[index] = {name: (before.get(name, (now, now))[1], now) for name, now in pairs}

    def values(self, view: View, worth: Worth) -> tuple[float, ...]:
        """Divisors of the costs of going to the places of `view`: the `worth` of a target there, else 1."""
        of_targets = [worth(target, self._levels.get(target.index, {})) for target in view.targets]
        return 1.0, *of_targets, *(1.0 for _ in view.carts)

    def choices(self, view: View) -> tuple[Option, ...]:
        """The options at the decision of `view`; where there is none the agent looks around once more."""
        return view.options(view.start) or (LOOK,)

    def action(self, view: View, option: Option) -> Action:
        """The action that does `option`, which is remembered as chosen."""
        self._paid = option.cost
        if option.verb == EXPLORE or (option.verb == DROP and view.in_bag):
            return Action(option.verb)
        return Action(option.verb, view.names[option.thing])


def _index(target: Target) -> int:
    return target.index
