"""Records of what failed in an episode: those of the oracle, with its searches, and what all agents share.

Agents count failures of walks and pick-ups by their targets. What else fails from where the robot stands, a drop, a
door that does not shut, a cart that does not roll, is counted here for all of them (`Repeats`): after a few failures
they go on from elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hazard_ms.agents.search.memory import ELSEWHERE, PROGRESS, SAME_AGAIN, Place, after, apart
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import NO_PATH, UNFINISHED

ENCLOSED = 2  # things to which there is no path, from which it is the robot that cannot get away [ours]
AT_ONCE = 1  # frames of what fails before anything moves: none, or in a team one
# verbs whose failures agents count by themselves, or that have none
COUNTED = (WALK_TO, WALK_ONE_STEP, PICK_UP, EXPLORE)
FEW = 2  # failures of one action from one place, after which something else is done [ours]
MANY = 4  # the same in tasks without mitigations, whose agents then have given up what they count [ours]
HERE = 0.5  # distance up to which it is the same place [m] [ours]
ELSEWHERE_FROM = 1.2  # distance of things towards which it goes from there [m] [ours]


@dataclass
class Attempts:
    """The failures and searches of an episode so far."""

    failures: dict[str, int] = field(default_factory=dict)  # by name of the thing
    missed: dict[str, tuple[float, float]] = field(default_factory=dict)  # where it stood at the last failure [m]
    # places of the robot and the thing when reaching for it failed at once [m]
    in_vain: dict[str, tuple[float, ...]] = field(default_factory=dict)
    rounds: int = 0  # times that what was given up was tried again
    visits: dict[str, int] = field(default_factory=dict)  # of landmarks in search
    looked: bool = False  # around, in search

    def chance(self, name: str, here: tuple[float, float], under_way: bool) -> float:
        """The chance to get hold of a thing from `here` [m], as a share of that of a first attempt.

        `under_way`: whether that is what it is doing anyway.
        """
        missed = self.missed.get(name)
        again = missed is not None and float(np.hypot(*np.subtract(missed, here))) < ELSEWHERE
        return after(self.failures.get(name, 0)) * (SAME_AGAIN if again and not under_way else 1.0)


class Enclosure:
    """Tells from failed walks that no way leads out of where the robot stands."""

    def __init__(self) -> None:
        self._no_path: dict[str, int] = {}  # how often there was no path to things, one after another

    def noticed(self, decision: Decision) -> dict[str, int]:
        """The failed walks to each thing where there is no way to one after another; none where there may be ways.

        Not these things are to blame, but where the robot stands.
        """
        last, result, found = decision.last_action, decision.last_result, self._no_path
        stays = result is not None and result.reason == NO_PATH and result.frames <= AT_ONCE
        if last is None or last.target is None or not stays:
            self._no_path = {}
            return {}
        found[last.target] = found.get(last.target, 0) + 1
        if len(found) < ENCLOSED:
            return {}
        self._no_path = {}
        return found


class Repeats:
    """Chooses another action in place of one that has failed again and again from where the robot stands.

    It steps towards the nearest thing that is not at hand, another one each time, or, with what is for a cart, goes to
    the nearest other cart; where it knows nothing of that kind, it looks around. `note` says why.
    """

    def __init__(self, mitigates: bool) -> None:
        """Begin an episode of a task that has mitigations or, else, the six verbs of the benchmark alone."""
        self._most = FEW if mitigates else MANY
        self._failed: dict[Action, tuple[int, Place]] = {}  # how often, and where the robot stood after the last time
        self._began: Place | None = None  # where the last action began
        self._tried: set[str] = set()  # what it has gone towards since something worked
        self.note = ""

    def instead(self, decision: Decision, action: Action) -> Action | None:
        """The action instead of `action`, which an agent has chosen at each `decision`; None where that may work."""
        self._enter(decision)
        self._began = decision.agent_position
        times, place = self._failed.get(action, (0, decision.agent_position))
        if times < self._most or apart(place, decision.agent_position) > HERE:
            return None
        self.note = f"{action} failed {times} times from here: go on from elsewhere"
        name = self._elsewhere(decision, action)
        if name is None:
            self._tried.clear()
            return Action(EXPLORE)
        self._tried.add(name)
        return Action(WALK_TO if name in decision.containers else WALK_ONE_STEP, name)

    def _enter(self, decision: Decision) -> None:
        """Enter what the last action came to."""
        last, result, began = decision.last_action, decision.last_result, self._began
        if last is None or result is None or began is None or last.verb in COUNTED:
            return
        here = decision.agent_position
        if result.ok:
            self._failed.pop(last, None)
            self._tried.clear()
        elif result.reason not in UNFINISHED or apart(began, here) <= PROGRESS:
            times, place = self._failed.get(last, (0, began))
            self._failed[last] = (times + 1 if apart(place, began) <= HERE else 1, here)

    def _elsewhere(self, decision: Decision, action: Action) -> str | None:
        """The name of the thing to go towards: another cart for what belongs there, else the nearest; None: none."""
        away = {
            decision.names[index]: apart((float(seen.position[0]), float(seen.position[1])), decision.agent_position)
            for index, seen in decision.map.objects.items()
        }
        others = [n for n in away if n not in (action.target, decision.held) and n not in self._tried]
        carts = [n for n in others if action.verb == DROP and action.target is not None and n in decision.containers]
        far = [n for n in others if away[n] >= ELSEWHERE_FROM and n not in decision.containers]
        return min(carts or far, key=lambda n: away[n], default=None)
