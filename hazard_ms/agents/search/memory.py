"""The memory of an episode beyond the map: failures, visits, and where things were seen before."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.base import ends_belief
from hazard_ms.agents.search.fire_watch import FireWatch
from hazard_ms.agents.search.house_fire import HouseFire
from hazard_ms.sensing.detection.track import DRIFT
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import NOT_A_TARGET, TOO_FAR, UNFINISHED
from hazard_ms.spec.registry.mitigations import MITIGATIONS

PROGRESS = 0.2  # a walk that got it this far is not a failure, even if it did not arrive [m]
LEGS = 12  # walks without arrival to one thing that together count as a failure: 19 m, longer than any way [ours]
ELSEWHERE = 1.0  # distance from where a pick-up failed at which another try is worthwhile [m] [ours]
DRIFTED = 0.4  # distance that the thing must have moved for another try from the same place [m] [ours]
# chance of a pick-up after so many that failed, the last number for any more, as a share of that of a first one:
# of 2,871 first ones 91 % worked, of 136 second ones 37 %, of 46 third ones 4 % (250 episodes each of fire and flood,
# ten agents, Fetch); in wind, where things move on, 54 % of 26 second ones [measured]
AGAIN = (1.0, 0.5, 0.1)
SAME_AGAIN = 0.05  # chance of a pick-up where one has just failed, as a share of that elsewhere [ours]

Place = tuple[float, float]  # [m], world frame
Seen = tuple[int, Place]  # a frame, and where a thing was seen in it


class Memory:
    """The memory of one episode; `note` enters each decision, `chose` the action that was taken."""

    def __init__(self, seed: int, belief: bool = True) -> None:
        """Begin an episode; `seed` fixes all randomness in it; `belief`: see `Weights`."""
        self._belief = belief
        self.fire, self.house = FireWatch(seed), HouseFire(seed)
        self.failures: dict[str, int] = {}  # of walks to a thing and picking it up; of mitigations: "shut door_0"
        self.missed: dict[str, list[tuple[Place, Place]]] = {}  # failed pick-ups: where it stood then, and the thing
        self.visits: dict[str, int] = {}  # to things in search
        self.looks: list[Place] = []  # where it looked around
        self.barred: dict[str, Place] = {}  # where the ways end to what no way led to
        self.tracks: dict[str, list[Seen]] = {}  # frame and place of the sightings of each target
        self._legs: dict[str, int] = {}
        self._before: tuple[Action, Place] | None = None  # the last action, and where it began
        self._lay: Place | None = None  # where the thing was seen that this action was for

    def note(self, decision: Decision) -> None:
        """Enter what the last action came to, and where the targets were seen."""
        for target in decision.targets:
            sighting = decision.map.objects.get(target.index)
            track = self.tracks.setdefault(target.name, [])
            if track and sighting is not None and target.belief < 1.0 and _is_another(track[-1], sighting):
                track.clear()  # another thing has the name by now
                self.failures.pop(target.name, None)
                self.missed.pop(target.name, None)
            if sighting is not None and (not track or sighting.frame > track[-1][0]):
                track.append((sighting.frame, (float(sighting.position[0]), float(sighting.position[1]))))
        if self._before is not None and self._before[0].verb == EXPLORE:
            self.looks.append(self._before[1])
        if self._before is not None and decision.last_result is not None and not decision.last_result.ok:
            self._judge(*self._before, decision)

    def chose(self, decision: Decision, action: Action) -> None:
        """Enter the action taken at `decision`."""
        self._before = (action, decision.agent_position)
        self._lay = place_of(decision, action.target)

    def _judge(self, action: Action, start: Place, decision: Decision) -> None:
        """Count the last action's failure, unless it was a walk that came further."""
        name, result = action.target, decision.last_result
        if name is None or result is None:
            return
        if self._belief and result.reason == NOT_A_TARGET and ends_belief(decision, name):
            return
        came = float(np.hypot(*np.subtract(decision.agent_position, start))) > PROGRESS
        if action.verb in MITIGATIONS:
            unfinished = result.reason in UNFINISHED
            self.failures[str(action)] = self.failures.get(str(action), 0) + (not (unfinished and came))
            return
        if action.verb in (WALK_TO, WALK_ONE_STEP) and came:
            self._legs[name] = self._legs.get(name, 0) + 1
            if self._legs[name] % LEGS:
                return
        self.failures[name] = self.failures.get(name, 0) + 1
        if action.verb == PICK_UP and result.reason != TOO_FAR:
            stood = decision.agent_position
            self.missed.setdefault(name, []).append((stood, self._lay or stood))

    def try_ways_again(self) -> list[Place]:
        """Forget to what no way led, since what floats about may have freed it, and return where the ways end [m]."""
        places = [*self.barred.values()]
        for name in self.barred:
            self.failures.pop(name, None)
        self.barred.clear()
        return places

    def chance(self, decision: Decision, name: str) -> float:
        """The chance that a pick-up begun at `decision` works, as a share of the chance of a first attempt."""
        missed, now = self.missed.get(name, ()), place_of(decision, name)
        again = any(
            np.hypot(*np.subtract(decision.agent_position, stood)) < ELSEWHERE
            and (now is None or np.hypot(*np.subtract(now, lay)) < DRIFTED)
            for stood, lay in missed[-1:]
        )
        return (SAME_AGAIN if again else 1.0) * after(len(missed))


def after(failures: int) -> float:
    """The chance of a pick-up after so many `failures`, begun elsewhere, as a share of that of a first one."""
    return AGAIN[min(failures, len(AGAIN) - 1)]


def place_of(decision: Decision, thing: str | None) -> Place | None:
    """The place [m] of a thing on the map, where it was seen last; None where it is not known, or no thing."""
    seen = decision.map.objects.get(decision.index(thing)) if thing in decision.names else None
    return None if seen is None else (float(seen.position[0]), float(seen.position[1]))


def apart(one: Sequence[float], other: Sequence[float]) -> float:
    """The distance of two places [m]."""
    return float(np.hypot(one[0] - other[0], one[1] - other[1]))


def _is_another(before: Seen, now: Sighting) -> bool:
    """Whether what was seen `before` cannot be the thing that is seen `now`, however fast the wind drives it."""
    frame, (x, y) = before
    way = float(np.hypot(now.position[0] - x, now.position[1] - y))
    return way > ELSEWHERE + DRIFT * max(now.frame - frame, 0)
