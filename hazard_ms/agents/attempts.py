"""The record that the oracle keeps of what failed in an episode, and of its searches."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hazard_ms.agents.search.memory import ELSEWHERE, SAME_AGAIN, after
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.failures import NO_PATH

ENCLOSED = 2  # things to which there is no path, from which it is the robot that cannot get away [ours]


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
        self._no_path: set[str] = set()  # things to which there was no path, one after another

    def noticed(self, decision: Decision) -> bool:
        """Whether there is no way to one thing after another: not they are to blame, but where the robot stands."""
        last, result = decision.last_action, decision.last_result
        if last is None or result is None or last.target is None or result.reason != NO_PATH or result.frames:
            self._no_path.clear()
            return False
        self._no_path.add(last.target)
        if len(self._no_path) < ENCLOSED:
            return False
        self._no_path.clear()
        return True
