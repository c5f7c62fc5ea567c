"""The movement of things that wind or water carries while the hand is on its way to them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.failures import BLOCKED

DRIFT_FRAMES = 5  # frames over which a thing's movement is measured [ours]
STILL = 0.008  # movement within these frames below which a thing lies still [m] [ours]


class Drift:
    """The movement of a thing, measured from its last places."""

    def __init__(self, stage: Stage, index: int) -> None:
        """Begin with the thing `index` where it is."""
        self._stage, self._index = stage, index
        self._places = [(stage.position(index), 0)]  # and the frames from one to the next

    def while_there(self, doing: Skill, far: float) -> Skill:
        """Go on with `doing`, which is about where the thing lies now, until it has moved by more than `far` [m]."""
        place, used = self._stage.position(self._index), 0
        try:
            action = next(doing)
            while float(np.linalg.norm(self._places[-1][0] - place)) <= far:
                yield action
                used += 1
                self.note()
                action = next(doing)
        except StopIteration as ended:
            done: Result = ended.value
            return done
        doing.close()
        return Result(False, BLOCKED, used)

    def note(self, frames: int = 1) -> None:
        """Note the present place, `frames` after the last one."""
        self._places = [*self._places[-DRIFT_FRAMES:], (self._stage.position(self._index), frames)]

    def ahead(self, frames: float) -> NDArray[np.float64]:
        """The way over the floor [m], [3], world frame, that the thing makes in `frames`; 0 for what lies still."""
        moved = self._places[-1][0] - self._places[0][0]
        moved[2] = 0.0
        passed = sum(since for _, since in self._places[1:])
        if np.abs(moved).max() * DRIFT_FRAMES <= STILL * max(passed, DRIFT_FRAMES):
            return np.zeros(3)
        return np.asarray(moved * (frames / passed))
