"""Doors that turn: where the leaf of a door in an inner wall is, where its handle is, and what it passes over.

    share = 1 - cos(angle)    what a leaf leaves open of the width, seen along the wall's normal
    F = F_0 + max(0, P) w / (2 (w - d))    at the handle, d from the free edge [NFPA 92, 4.4.2.2]

P is the force of water and air on the leaf against its turn. A leaf in an inner wall hangs at the lower end of its
opening along the wall, in the middle of its thickness, and turns into the first side: to the south or the west. Angles
are 0 where it is shut and a quarter turn where it is open.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.scenes.shell import LEAF
from hazard_ms.scenes.walls import WALLS, on_wall, thickness_of
from hazard_ms.scenes.walls import angle as angle
from hazard_ms.scenes.walls import hinge as hinge
from hazard_ms.spec import Opening, Room

Number = TypeVar("Number", float, Tensor)
# Times of a quarter turn [s]: doors that move by themselves take 4 s to open, and 3 s to shut from 90 to 10 degrees and
# 1.5 s from there, at least [ANSI/BHMA A156.19, 4.1.2 and 4.2]: leaves of 45 kg then have no more than 1.69 J
OPENING_TIME, SHUTTING_TIME = 4.0, 4.5
HANDLE_HEIGHT = 1.0  # [m] ADA 404.2.7: 34 to 48 in, 0.86 to 1.22 m
BESIDE = 0.07  # as far as handles stand out from the middle of a leaf [m] [ours]
END, SPACING = 0.05, 0.02  # of the points below a leaf: from its ends, and between them [m] [ours]
HANDLE_EDGE = 0.07  # of the handle's middle from the free edge of the leaf [m] [NFPA 92: 0.07 m, as is usual]
# Force at the handle of an inner door without any pressure [N] [ADA 404.2.9: at most 5 lbf]
REST_FORCE = 22.2
LOWEST = 0.1  # height of the handle of a window above its lower edge, at least [m] [ours]


def share(angle: float) -> float:
    """Share of the width that a leaf at this `angle` [rad] leaves open."""
    return 1.0 - math.cos(angle)


def on_leaf(room: Room, o: Opening, angle: float, far: float) -> NDArray[np.float64]:
    """The place on the floor [m], [2], below what is `far` [m] from the hinge on a leaf at this `angle` [rad]."""
    start, along, out = hinge(room, o)
    return start + far * (math.cos(angle) * along + math.sin(angle) * out)


def inner(o: Opening) -> bool:
    """Whether it is in an inner wall: others do not turn into the room."""
    return o.wall not in WALLS


def spots(room: Room, o: Opening, shares: Sequence[float]) -> NDArray[np.float64]:
    """Points at half its height in an opening [m], [S, 3], at `shares` of its width from its middle, world frame."""
    deep, high = thickness_of(room, o.wall) / 2, o.sill + o.height / 2
    return np.array([on_wall(room, o.wall, o.centre + share * o.width, high, deep) for share in shares])


def handle_force(pressing: Number, width: Number) -> Number:
    """Force [N] at the handle of a leaf of `width` [m] on which `pressing` [N] acts against its turn, [...] each."""
    return REST_FORCE + (pressing + abs(pressing)) / 2.0 * width / (2.0 * (width - HANDLE_EDGE))


def handle(room: Room, o: Opening, angle: float) -> NDArray[np.float64]:
    """The middle of the handle of a leaf at this `angle` [rad], or of a window [m], [3], world frame."""
    if not inner(o):
        along = o.centre + o.width / 2 - HANDLE_EDGE
        return np.array(on_wall(room, o.wall, along, max(HANDLE_HEIGHT, o.sill + LOWEST), 0.0))
    return np.array([*on_leaf(room, o, angle, o.width - HANDLE_EDGE), o.sill + HANDLE_HEIGHT])


def under_leaf(room: Room, o: Opening, angle: float) -> NDArray[np.float64]:
    """Points on the floor below a leaf at this `angle` [rad] and its handles, without its ends [m], [P, 2]."""
    _, along, out = hinge(room, o)
    across = math.cos(angle) * out - math.sin(angle) * along
    middle = np.array([on_leaf(room, o, angle, far) for far in np.arange(END, o.width - END, SPACING)])
    return np.concatenate([middle + side * across for side in (-BESIDE, 0.0, BESIDE)])


def in_swing(
    room: Room, o: Opening, first: float, last: float, points: NDArray[np.float64], radius: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether discs around `points` [m], [N, 2], of `radius` [m], [N], meet a leaf that turns from `first` to `last`.

    Angles in [rad], in either order.
    """
    start, along, out = hinge(room, o)
    offset = points - start
    a, b = offset @ along, offset @ out
    far, at = np.hypot(a, b), np.arctan2(b, a)
    nearest = np.clip(at, min(first, last), max(first, last))
    reach = np.minimum(o.width, np.maximum(0.0, far * np.cos(at - nearest)))
    gap = np.hypot(a - reach * np.cos(nearest), b - reach * np.sin(nearest))
    inside = (at >= min(first, last)) & (at <= max(first, last)) & (far <= o.width)
    return inside | (gap < radius + LEAF / 2)
