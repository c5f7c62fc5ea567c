"""The memory of an episode that a model is told of: failures, visits, sightings, and what was done."""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.agents.base import distance
from hazard_ms.agents.llm.homes.rooms import Rooms
from hazard_ms.agents.search.memory import Memory as Believed
from hazard_ms.skills.decision import WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED

LAST = 10  # actions that are told [ours, after the paper's]
ENDS = 3  # sightings at each end of a thing's history that are told [ours]


@dataclass(frozen=True)
class Sight:
    """One sighting of a target, as the model is told of it."""

    frame: int
    metres: float  # distance from where the robot stood then [m]
    levels: tuple[float, ...]  # of the hazards there, in their units

    def same(self, other: Sight) -> bool:
        """Whether the model would read the same of both, but for the frame."""
        own, others = ((round(s.metres, 1), *(round(v, 1) for v in s.levels)) for s in (self, other))
        return own == others


class Memory:
    """The memory of one episode; `note` enters each decision, `chose` the action that was taken."""

    def __init__(self, seed: int) -> None:
        """Begin an episode; `seed` fixes the futures of a fire that forecasts draw."""
        self.believed = Believed(seed)
        self.rooms = Rooms()
        self.done: list[tuple[str, str, int]] = []  # move in words, outcome in words, frames
        self._sights: dict[str, list[Sight]] = {}
        self._move: tuple[str, str | None] | None = None  # the words of the last action, and what it was for
        self.search: str | None = None  # the place to which a search is on its way

    def note(self, decision: Decision) -> None:
        """Enter how the last action ended, and where the targets were seen."""
        self.believed.note(decision)
        if decision.openings:
            self.rooms.see(decision.map, decision.openings)
        result = decision.last_result
        if self._move is not None and result is not None:
            self.done = [*self.done, (self._move[0], _outcome(result.ok, result.reason), result.frames)][-LAST:]
        for target in decision.targets:
            sighting = decision.map.objects.get(target.index)
            track = self._sights.setdefault(target.name, [])
            if sighting is None or (track and sighting.frame <= track[-1].frame):
                continue
            seen = Sight(sighting.frame, distance(decision, sighting), sighting.levels)
            if not track or not seen.same(track[-1]):
                track.append(seen)

    def chose(self, decision: Decision, action: Action, move: str, search: bool) -> None:
        """Enter the action taken at `decision`, `move` in words; `search`: whether it leads to a place to search."""
        self.believed.chose(decision, action)
        self._move = move, action.target
        name = action.target if search and action.verb == WALK_TO else None
        if name is not None and name != self.search:
            visits = self.believed.visits
            visits[name] = visits.get(name, 0) + 1
        self.search = name

    def arrived_to_search(self, decision: Decision) -> bool:
        """Whether the robot has just come to a place in order to look around there."""
        return self.search is not None and decision.walked_up_to == self.search

    def history(self, name: str) -> list[Sight]:
        """The first and the last sightings of a target, oldest first, without the newest, which is told anyway."""
        track = self._sights.get(name, [])[:-1]
        return track if len(track) <= 2 * ENDS else [*track[:ENDS], *track[-ENDS:]]


def _outcome(ok: bool, reason: str) -> str:
    """The outcome of an action in words."""
    if ok:
        return "done"
    return "paused" if reason in UNFINISHED else f"failed: {reason.replace('_', ' ')}"
