"""Counts of the points along arms that lie in what the map shows, by a compiled kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
import warp as wp
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.simulation.kernels.launch import OPTIONS, Launches

wp.set_module_options(OPTIONS)

Floats = wp.array(dtype=wp.float64)

MOST = 256  # arms for which there is room at first

_launches = Launches()
# places, `ahead` and counts of arms with P joints: the same tensors at every launch, which takes a third of the time
_room: dict[int, tuple[Tensor, Tensor, Tensor]] = {}


@wp.struct
class Ground:
    """The surroundings of a base that arms must keep above, and a place at which the hand may come down."""

    x: wp.float64  # of the base's middle [m], world frame
    y: wp.float64
    ahead_x: wp.float64  # direction in which it faces [-]
    ahead_y: wp.float64
    radius: wp.float64  # of the base [m]
    own: wp.float64  # height that the arm keeps above over the base [m]
    west: wp.float64  # corner of the map [m]
    south: wp.float64
    cell: wp.float64  # edge of the map's cells [m]
    gap: wp.float64  # distance that the middle of the arm keeps above things [m]
    place_x: wp.float64  # of the place [m]
    place_y: wp.float64
    place_radius: wp.float64  # [m]
    bottom: wp.float64  # height on which the thing at the place stands [m]
    slope: wp.float64  # of the cone around it, within which the hand comes down [-]
    top: wp.float64  # height up to which it may be stood on [m]
    out_x: wp.float64  # direction from the place to where furniture around it is open [-]
    out_y: wp.float64
    depth: wp.float64  # distance from the place up to which it is so; 0 for a place in the open [m]
    half_width: wp.float64  # of the opening [m]
    roof: wp.float64  # height up to which it is so [m]


@wp.func
def distance(x: wp.float64, y: wp.float64) -> wp.float64:
    """Length of a vector over the floor."""
    return wp.sqrt(x * x + y * y)


@wp.func
def lies_in(ground: Ground, heights: wp.array2d(dtype=wp.float32), ahead: wp.float64, point: wp.vec3d) -> bool:
    """Whether a point [m] in the frame of a base that is `ahead` [m] of where it is lies in something."""
    base_x, base_y = ground.x + ahead * ground.ahead_x, ground.y + ahead * ground.ahead_y
    x = point[0] * ground.ahead_x - point[1] * ground.ahead_y + base_x
    y = point[0] * ground.ahead_y + point[1] * ground.ahead_x + base_y
    if distance(x - base_x, y - base_y) < ground.radius:
        return point[2] < ground.own
    column, row = int(wp.floor((x - ground.west) / ground.cell)), int(wp.floor((y - ground.south) / ground.cell))
    height = wp.float32(0.0)
    if column >= 0 and row >= 0 and column < heights.shape[1] and row < heights.shape[0]:
        height = heights[row, column]
    raised = wp.float64(height + wp.float32(ground.gap))
    east, north = x - ground.place_x, y - ground.place_y
    beside = distance(east, north) - ground.place_radius
    along, across = east * ground.out_x + north * ground.out_y, north * ground.out_x - east * ground.out_y
    if along < ground.depth and wp.max(-along, wp.abs(across)) < ground.half_width and point[2] < ground.roof:
        # between the boards of a shelf
        raised = wp.min(raised, ground.bottom + wp.min(ground.gap, ground.slope * wp.max(beside, wp.float64(0.0))))
    if height < wp.float32(ground.top) or beside < ground.gap:  # neither a wall nor the back of a chair
        raised = wp.min(raised, ground.bottom + ground.slope * wp.max(beside, wp.float64(0.0)))
    return point[2] < raised


@wp.kernel
def count(
    ground: Ground,
    shares: Floats,
    heights: wp.array2d(dtype=wp.float32),
    places: wp.array2d(dtype=wp.vec3d),
    ahead: Floats,
    touching: wp.array(dtype=wp.int32),
):
    """Count the points of each arm that lie in something, [N], as `Counter` says."""
    arm = wp.tid()
    found = int(0)
    last = places.shape[1] - 1
    for k in range(last):
        start = places[arm, k]
        along = places[arm, k + 1] - start
        for s in range(shares.shape[0]):
            found += int(lies_in(ground, heights, ahead[arm], start + shares[s] * along))
    found += int(lies_in(ground, heights, ahead[arm], places[arm, last]))
    touching[arm] = found


def ground(**values: float) -> Any:
    """The `Ground` with these `values` of all its fields."""
    made = Ground()
    for name in Ground.vars:
        setattr(made, name, values[name])
    return made


class Counter:
    """Counts of points of arms that lie in something on one map, around one base."""

    def __init__(self, ground: Any, shares: Sequence[float], heights: NDArray[np.float32]) -> None:
        """Look at points at `shares` of each link's length, and at the hand; `heights` of the map [m], [Y, X]."""
        self._map = (ground, torch.tensor(shares, dtype=torch.float64), torch.from_numpy(heights))

    def touched(self, places: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.int64]:
        """Count the points along each of N arms that lie in something, [N].

        Joints are at `places` [m], [N, P, 3], in the frame of the base, which is `ahead` [m], [N], of where it is.
        """
        number = len(places)
        room = _room.get(places.shape[1])
        if room is None or len(room[0]) < number:
            most = max(number, MOST)
            room = _room[places.shape[1]] = (
                torch.empty((most, *places.shape[1:]), dtype=torch.float64),
                torch.empty(most, dtype=torch.float64),
                torch.empty(most, dtype=torch.int32),
            )
        room[0].numpy()[:number], room[1].numpy()[:number] = places, ahead
        _launches.run(count, (number,), *self._map, *room)
        return room[2].numpy()[:number].astype(np.int64)
