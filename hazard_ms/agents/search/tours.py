"""The next part of a search that goes from landmark to landmark, after a first look around."""

from __future__ import annotations

from hazard_ms.agents.attempts import Attempts
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.options.landmarks import landmarks
from hazard_ms.skills.options.macros import Macro, play
from hazard_ms.skills.options.options import LANDMARK, LOOK, Option


def tour(decision: Decision, attempts: Attempts) -> tuple[Macro, Option] | None:
    """A look around, or a walk to the best landmark, which is entered into `attempts`; None: all was searched."""
    marks = landmarks(decision, attempts.visits, 1)
    if not attempts.looked:
        option, attempts.looked = Option(LOOK), True
    elif marks:
        option, visits = Option(LANDMARK, marks[0].name), attempts.visits
        visits[marks[0].name] = visits.get(marks[0].name, 0) + 1
    else:
        return None
    return play(option, decision), option
