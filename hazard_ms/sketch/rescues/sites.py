"""Places of sites while a scene is made."""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.sketch.rescues.scene import Floats


@dataclass
class Sites:
    """Places of sites while they are collected: position [m] and the number of the thing along B, -1 for none."""

    position: list[Floats]
    thing: list[int]

    def add(self, position: Floats, thing: int) -> int:
        """Add a site at `position` [m], [3], of a thing; returns its number."""
        self.position.append(position)
        self.thing.append(thing)
        return len(self.thing) - 1
