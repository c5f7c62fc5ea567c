"""All robots of an environment as hazards see them, be it one or a team."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from torch import Tensor

from hazard_ms.spec import Build


@dataclass(frozen=True)
class Crew:
    """The A robots of each of E environments, in order."""

    builds: tuple[Build | None, ...]  # None in a world without a robot, in which a place stands for one
    places: Tensor  # middles of their bases on the floor [m], [E, A, 3]
    number: int = 0  # of the robot whose world it is: place, heading, hand and build there are those of this one

    def __len__(self) -> int:
        """Number of robots, A: 1 in a world without one, too."""
        return len(self.builds)

    def own(self, quantity: Tensor) -> Tensor:
        """The part, [E], of a `quantity` of all robots, [E, A], that is of the robot of this world, in its unit [-]."""
        return quantity[:, self.number]

    def each(self, *quantities: Tensor) -> Iterator[tuple[Any, ...]]:
        """The build, the place [m], [E, 3], and the part, [E], of each of the `quantities`, [E, A], of every robot."""
        for number, build in enumerate(self.builds):
            if build is not None:
                yield build, self.places[:, number], *(each[:, number] for each in quantities)
