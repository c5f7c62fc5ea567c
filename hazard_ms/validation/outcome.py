"""Runs a case, and says whether the number that it gave is good."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from hazard_ms.hazards.case import Case


@dataclass(frozen=True)
class Outcome:
    """The number that a case gave."""

    case: Case
    got: float
    seconds: float

    @property
    def passed(self) -> bool:
        """Whether the number is within its tolerance; infinite ones must be equal."""
        if math.isinf(self.case.expected):
            return self.got == self.case.expected
        return abs(self.got - self.case.expected) <= self.case.band


def check(case: Case) -> Outcome:
    """Run one case."""
    start = time.perf_counter()
    got = float(case.run())
    return Outcome(case, got, time.perf_counter() - start)
