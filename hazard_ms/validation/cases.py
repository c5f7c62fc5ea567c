"""A case: one number that the physics must give, where it comes from, and how to find what the code gives.

Expected numbers are those of exact solutions, of tables of the original, or of publications; no case computes its own.
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Case:
    """One number to be met."""

    id: str  # "L-13"
    what: str  # "heave period of a box, s = 0.5"
    expected: float
    tolerance: float  # relative, or of the number itself where `absolute`; 0: equal
    run: Callable[[], float]
    unit: str = ""
    absolute: bool = False
    slow: bool = False  # takes more than a second or two

    @property
    def band(self) -> float:
        """How far from the expected number is allowed."""
        return self.tolerance if self.absolute else self.tolerance * abs(self.expected)


@dataclass(frozen=True)
class Result:
    """What a case gave."""

    case: Case
    got: float
    seconds: float

    @property
    def passed(self) -> bool:
        """Whether the number is within its tolerance; infinite ones must be equal."""
        if math.isinf(self.case.expected):
            return self.got == self.case.expected
        return abs(self.got - self.case.expected) <= self.case.band


def check(case: Case) -> Result:
    """Run one case."""
    start = time.perf_counter()
    got = float(case.run())
    return Result(case, got, time.perf_counter() - start)


def table(name: str, what: str, rows: Mapping[Any, float], tolerance: float, run: Callable[[Any], float], **more: Any) -> Iterator[Case]:
    """One case for each of `rows`: argument of `run` -> expected. `what` may name the argument as {}."""
    for key, expected in rows.items():
        yield Case(name, what.format(key), expected, tolerance, functools.partial(run, key), **more)
