"""The floor as it really is: what was carried there since, and the leaves of open doors, stand in the way of walks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.floor import OVERHEAD_HEIGHT
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.world import World
from hazard_ms.skills.motor.navigation import LOW, Ways

Array = NDArray[np.float64]
STEP, EDGE = 0.05, 0.05  # between points below a thing, and beyond its edge: half a cell of the map [m] [ours]
NEAR = 0.6  # distance from a place at which a walk has reached it [m] [ours]


def reached(seen: SemanticMap, world: World, here: tuple[float, float], places: Array, radius: float) -> list[bool]:
    """Whether a way leads now from `here` [m] to each of D `places` [m], [D, 2], for a robot of `radius` [m].

    What the map `seen` holds counts, too: a walk keeps away from where it has seen a thing that is no longer there.
    """
    height = seen.obstacles
    for points, top in _standing(world):
        column, row = np.floor((points - seen.origin) / seen.cell).astype(int).T
        inside = (np.minimum(row, column) >= 0) & (np.maximum(row, column) < len(height))
        row, column = row[inside], column[inside]
        height[row, column] = np.maximum(height[row, column], top)
    goals = [(float(x), float(y)) for x, y in places]
    ways = Ways(height, seen.explored, seen.cell, seen.origin, here, goals, radius)
    paths = [ways.path(goal, NEAR, NEAR) for goal in goals]  # `length` would take what ends 0.6 m short for reached
    return [path is not None and path.short <= NEAR for path in paths]


def _standing(world: World) -> list[tuple[Array, float]]:
    """Points on the floor [m], [P, 2], below each loose thing and each open inner leaf, and its top [m]."""
    made = []
    there = world.exists & world.movable & ~world.away & ~world.held
    places, extents = world.position[0].cpu().numpy(), world.extent[0].cpu().numpy()
    for b in there[0].nonzero()[:, 0].tolist():
        (x, y, z), half = places[b].tolist(), extents[b] / 2
        if z - half[2] < OVERHEAD_HEIGHT and z + half[2] > LOW:
            reach = float(min(half[:2])) + EDGE  # whichever way it has turned, it is there
            steps = np.linspace(-reach, reach, 2 + int(2 * reach / STEP))
            square = np.stack(np.meshgrid(x + steps, y + steps), -1).reshape(-1, 2)
            made.append((square, float(z + half[2])))
    room, share = world.specs[0].room, world.openings.share[0].tolist()
    for number, o in enumerate(room.openings):
        if o.kind == "door" and hinges.inner(o) and not bool(world.openings.state.broken[0, number]):
            angle = hinges.angle(share[number])
            far = np.arange(0.0, o.width + EDGE, STEP)
            made.append((np.stack([hinges.on_leaf(room, o, angle, at) for at in far]), o.height))
    return made
