"""A door or window as a robot meets it: where its handle is, how hard it goes, and what it would meet.

    F = F_0 + max(0, P) w / (2 (w - d))    at the handle, d from the free edge [NFPA 92, 4.4.2.2]

P is the force of water and air on the leaf against its turn.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.walls import WALLS, on_wall
from hazard_ms.simulation import hinges
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening

LOWEST = 0.1  # height of the handle of a window above its lower edge, at least [m] [ours]
REST_FORCE = 22.2  # at the handle of an inner door without any pressure [N] [ADA 404.2.9: at most 5 lbf]


def handle_force(pressing: float, width: float) -> float:
    """Force [N] at the handle of a leaf of `width` [m] on which `pressing` [N] acts against its turn."""
    return REST_FORCE + max(0.0, pressing) * width / (2.0 * (width - hinges.HANDLE_EDGE))


class Leaf:
    """One door or window of the first environment, and how a robot meets it."""

    def __init__(self, world: World, number: int) -> None:
        """Take the opening `number` along O of `world`."""
        self.number, self._openings = number, world.openings
        self.room = world.specs[0].room
        self.o: Opening = self.room.openings[number]
        self.inner = self.o.wall not in WALLS  # its leaf turns on its hinges; others turn outwards

    @property
    def broken(self) -> bool:
        """Whether its leaf or pane is gone."""
        return bool(self._openings.state.broken[0, self.number])

    @property
    def angle(self) -> float:
        """How far it is open now [rad]."""
        return hinges.angle(float(self._openings.share[0, self.number]))

    def turn_to(self, angle: float) -> None:
        """Open it to this `angle` [rad]."""
        rows = self._openings.state.open.new_zeros(1).long()
        self._openings.set_open(rows, self.number, hinges.share(angle))

    def handle(self) -> NDArray[np.float64]:
        """The middle of its handle now [m], [3], world frame."""
        if self.inner:
            return hinges.handle(self.room, self.o, self.angle)
        along = self.o.centre + self.o.width / 2 - hinges.HANDLE_EDGE
        high = max(hinges.HANDLE_HEIGHT, self.o.sill + LOWEST)
        return np.array(on_wall(self.room, self.o.wall, along, high, 0.0))

    def force(self, opening: bool) -> float:
        """Force that it takes at the handle to open it, or to shut it [N]."""
        pressing = float(self._openings.force[0, self.number]) * (1.0 if self.inner else -1.0)
        return handle_force(pressing if opening else -pressing, self.o.width)

    def meets(self, first: float, last: float, points: NDArray[np.float64], radius: NDArray[np.float64]) -> bool:
        """Whether it would meet one of the discs around `points` [m], [N, 2], when it turns between these angles."""
        return self.inner and bool(hinges.in_swing(self.room, self.o, first, last, points, radius).any())

    def side(self, x: float, y: float) -> float:
        """On which side of its wall a place [m] is: above 0 that into which it turns."""
        start, _, out = hinges.hinge(self.room, self.o)
        return float((np.array([x, y]) - start) @ out)
