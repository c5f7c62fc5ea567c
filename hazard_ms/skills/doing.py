"""An action of one robot of a team, which goes on while others begin and end theirs."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from hazard_ms.skills.context import LowLevel, Skill
from hazard_ms.skills.decision import Action, Result
from hazard_ms.skills.failures import EPISODE_OVER


class Doing:
    """An action under way: its skill has decided on the move of the coming frame. None: it stands in that frame."""

    def __init__(self, action: Action, doing: Skill, frame: int) -> None:
        self.action, self._doing, self._since = action, doing, frame
        self._result: Result | None = None
        self.waited = 0  # frames in which it let others pass
        self.move = self._next()

    def _next(self) -> LowLevel | None:
        try:
            return next(self._doing)
        except StopIteration as ended:
            self._result = cast(Result, ended.value)
            return None

    def go_on(self, frame: int) -> Result | None:
        """Decide on the next move at `frame`; the outcome of an action that is over, or None."""
        if self._result is None:
            self.move = self._next()
        return None if self._result is None else replace(self._result, frames=frame - self._since)

    def break_off(self, frame: int, reason: str = EPISODE_OVER) -> Result:
        """End the action at `frame` for a `reason`: by default, that the episode is over."""
        self._doing.close()
        return Result(False, reason, frame - self._since)
