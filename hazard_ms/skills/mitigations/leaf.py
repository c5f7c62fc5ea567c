"""A door or window as a robot meets it: how far it is open, how hard it goes, and what it would meet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening

Array = NDArray[np.float64]


class Leaf:
    """One door or window of the first environment."""

    def __init__(self, world: World, number: int) -> None:
        """Take the opening `number` along O of `world`."""
        self.number, self._openings = number, world.openings
        self.room = world.specs[0].room
        self.o: Opening = self.room.openings[number]
        self.inner = hinges.inner(self.o)  # its leaf turns on its hinges; others turn outwards

    @property
    def broken(self) -> bool:
        """Whether its leaf or pane is gone."""
        return bool(self._openings.state.broken[0, self.number])

    @property
    def angle(self) -> float:
        """The angle by which it is open now [rad]."""
        return hinges.angle(float(self._openings.share[0, self.number]))

    def turn_to(self, angle: float) -> None:
        """Open it to this `angle` [rad]."""
        rows = self._openings.state.open.new_zeros(1).long()
        self._openings.set_open(rows, self.number, hinges.share(angle))

    def handle(self) -> Array:
        """The middle of its handle now [m], [3], world frame."""
        return hinges.handle(self.room, self.o, self.angle)

    def force(self, opening: bool) -> float:
        """Force that it takes at the handle to open it, or to shut it [N]."""
        pressing = float(self._openings.force[0, self.number]) * (1.0 if self.inner else -1.0)
        return hinges.handle_force(pressing if opening else -pressing, self.o.width)

    def meets(self, first: float, last: float, points: Array, radius: Array) -> bool:
        """Whether it would meet one of the discs of `in_the_way`."""
        return bool(self.in_the_way(first, last, points, radius).any())

    def in_the_way(self, first: float, last: float, points: Array, radius: Array) -> NDArray[np.bool_]:
        """Whether it would meet each of N discs when it turns between these angles [rad], [N].

        Discs are around `points` [m], [N, 2], world frame, with `radius` [m], [N].
        """
        if not self.inner:
            return np.zeros(len(points), bool)
        return hinges.in_swing(self.room, self.o, first, last, points, radius)

    @property
    def out(self) -> Array:
        """The direction into which it turns from where it is shut, [2]."""
        return hinges.hinge(self.room, self.o)[2]

    def side(self, x: float, y: float) -> float:
        """The distance [m] of a place [m] from its wall: above 0 on the side into which it turns."""
        start, _, out = hinges.hinge(self.room, self.o)
        return float((np.array([x, y]) - start) @ out)
