"""Doors, windows and doorways as an agent has seen them: where they are, and how far they were open.

They are called by their kind and their number among the openings of the scene: "door_0". One is known once a look has
shown a part of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.view import View
from hazard_ms.simulation.mitigation.hinges import angle, inner, on_leaf, spots, under_leaf
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Room, SceneSpec

SPOTS = (-0.4, 0.0, 0.4)  # where along it an opening is looked for, as shares of its width from its middle [ours]
BEFORE = 0.3  # what is seen this much nearer than an opening hides it [m] [ours]

Leaf = tuple[tuple[float, float], tuple[float, float]]  # its hinge and its free end on the floor [m]


@dataclass(frozen=True)
class KnownOpening:
    """The memory of one door, window or doorway."""

    name: str  # "door_0"
    number: int  # along O of `hazard_ms.simulation.openings`
    kind: str  # door | window | doorway
    position: tuple[float, float, float]  # of its middle [m], world frame
    width: float  # [m]
    open: float  # share of its width that was open when last seen
    broken: bool  # whether leaf or pane was gone
    frame: int  # in which it was last seen
    outer: bool = False  # whether it leads outdoors
    boarded: int | None = None  # frame in which a flood board was first seen standing in it; None: none does
    leaf: Leaf | None = None  # where its leaf stood on the floor; None: it has none that turns


def opening_names(spec: SceneSpec) -> tuple[str, ...]:
    """The names of the openings of a scene, in the order of its room."""
    return tuple(f"{o.kind}_{number}" for number, o in enumerate(spec.room.openings))


class DoorMemory:
    """The openings that the agent of the first environment knows."""

    def __init__(self, world: World) -> None:
        """Begin an episode in `world`: nothing is known."""
        self._world, self._spec = world, world.specs[0]
        self.names = opening_names(self._spec)
        self._spots = [spots(self._spec.room, o, SPOTS) for o in self._spec.room.openings]
        self.known: dict[int, KnownOpening] = {}

    def look(self, view: View, frame: int, maps: Iterable[SemanticMap]) -> None:
        """Enter the openings that `view` shows in `frame`.

        Where the leaf of one has moved, all `maps` forget where it stood.
        """
        for number in range(len(self.names)):
            if any(_shown(view, spot) for spot in self._spots[number]):
                self.enter(number, frame, maps)

    def enter(self, number: int, frame: int, maps: Iterable[SemanticMap]) -> None:
        """Enter the opening `number` as it is in `frame`, and let `maps` forget where its leaf stood if it moved."""
        o, openings = self._spec.room.openings[number], self._world.openings
        x, y, z = self._spots[number][1].tolist()
        share, broken = float(openings.share[0, number]), bool(openings.state.broken[0, number])
        before = self.known.get(number)
        self.known[number] = KnownOpening(
            *(self.names[number], number, o.kind, (x, y, z), o.width, share, broken, frame),
            outer=bool(openings.plan.outside[0, number]),
            boarded=self._boarded(number, frame, before),
            leaf=leaf_of(self._spec.room, o, share) if o.kind == "door" and inner(o) and not broken else None,
        )
        if before is not None and (before.open, before.broken) != (share, broken):
            stood = under_leaf(self._spec.room, o, angle(before.open))
            for seen in maps:
                seen.clear(stood)

    def _boarded(self, number: int, frame: int, before: KnownOpening | None) -> int | None:
        tools = self._world.equipment
        if tools is None or not bool((tools.state.stands_in[0] == number).any()):
            return None
        return frame if before is None or before.boarded is None else before.boarded

    def find(self, name: str) -> KnownOpening | None:
        """The memory of the opening called `name`; None where it was never seen."""
        return next((opening for opening in self.known.values() if opening.name == name), None)

    def rows(self) -> tuple[KnownOpening, ...]:
        """All that is known, by number."""
        return tuple(self.known[number] for number in sorted(self.known))


def leaf_of(room: Room, o: Opening, share: float) -> Leaf:
    """The leaf of a door in an inner wall that leaves a `share` of its width open."""
    (a, b), (c, d) = (on_leaf(room, o, angle(share), far).tolist() for far in (0.0, o.width))
    return (a, b), (c, d)


def _shown(view: View, spot: NDArray[np.float64]) -> bool:
    pixel = view.pixel_of(spot)
    if pixel is None:
        return False
    row, column, far = pixel
    depth = float(view.depth[row, column])
    return depth == 0.0 or depth > far - BEFORE
