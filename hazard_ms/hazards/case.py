"""A case: one number that a hazard's law must give, where it comes from, and how to find what the code gives.

Expected numbers are those of exact solutions, of tables of the original, or of publications; no case computes its own.
`hazard-ms validate` runs the cases of all registered hazards.
"""

from __future__ import annotations

import functools
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
        """The largest distance from the expected number that passes."""
        return self.tolerance if self.absolute else self.tolerance * abs(self.expected)


def table(
    name: str, what: str, rows: Mapping[Any, float], tolerance: float, run: Callable[[Any], float], **more: Any
) -> Iterator[Case]:
    """One case for each of `rows`: argument of `run` -> expected. `what` may name the argument as {}."""
    for key, expected in rows.items():
        yield Case(name, what.format(key), expected, tolerance, functools.partial(run, key), **more)
