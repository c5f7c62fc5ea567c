"""A search of what was never seen: a look around, then one landmark after another."""

from __future__ import annotations

from hazard_ms.agents.attempts import Attempts
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.options.landmarks import landmarks
from hazard_ms.skills.options.macros import Macro, play
from hazard_ms.skills.options.options import LANDMARK, LOOK, Option


class LandmarkSearch:
    """The search of one episode; `note` says what it does."""

    def __init__(self) -> None:
        self._search: Macro | None = None
        self.note = ""

    def leave(self) -> None:
        """Break off what it was doing."""
        self._search = None

    def act(self, decision: Decision, attempts: Attempts) -> Action | None:
        """The next action, entered into `attempts`; None where nothing is left to search."""
        if self._search is not None:
            try:
                return self._search.send(decision)
            except StopIteration:
                self._search = None
        marks = landmarks(decision, attempts.visits, 1)
        if not attempts.looked:
            option, attempts.looked = Option(LOOK), True
        elif marks:
            option, visits = Option(LANDMARK, marks[0].name), attempts.visits
            visits[marks[0].name] = visits.get(marks[0].name, 0) + 1
        else:
            return None
        self._search = play(option, decision)
        self.note = f"search: {option}"
        return next(self._search)
