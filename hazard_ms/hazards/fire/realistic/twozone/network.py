"""The pressures of rooms that do not stand in a row: volumes balance in all of them at once (Warp).

What openings pass grows with the pressure over them, so the balance is the lowest point of a convex function of all
pressures. Newton's method looks for it, and each step goes as far as the lowest point on its line: where flows go with
the root of the pressure, whole steps swing around the solution for ever. Flows are those of `.balance`. Rooms that no
chain of openings joins to the outside are at 0: gas goes between them by its weight alone.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic.twozone import balance, vents
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

STEPS = 16  # of Newton's method [ours]
HALVINGS = 10  # of a step, to its lowest point [ours]
LITTLE = 1e-3  # difference of pressure by which a slope is found, in shares of that over the opening and in Pa [ours]
LEAST = 1e-7  # slope that keeps the matrix regular [m^3/s Pa] [ours]
MORE = 2  # columns of the matrix after those of the rooms: right-hand side, and 1 for rooms joined to the outside
FARTHEST = wp.constant(vents.HIGHEST * vents.HIGHEST)  # largest pressure [Pa]


@wp.func
def mark(e: int, rooms: Rooms, matrix: wp.array3d(dtype=float)):
    """Mark the rooms that openings join to the outside, directly or through others."""
    count = rooms.zone_area.shape[1]
    for r in range(count):
        matrix[e, r, count + 1] = 0.0
    for _ in range(count):
        for o in range(rooms.vents.shape[1]):
            vent = rooms.vents[e, o]
            if vent[0] > 0.0 and vent[2] > vent[1]:
                a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
                if b < 0:
                    matrix[e, a, count + 1] = 1.0
                else:
                    reached = wp.max(matrix[e, a, count + 1], matrix[e, b, count + 1])
                    matrix[e, a, count + 1] = reached
                    matrix[e, b, count + 1] = reached


@wp.func
def assemble(e: int, air: float, rooms: Rooms, work: wp.array3d(dtype=float), matrix: wp.array3d(dtype=float)):
    """Write what each room makes and does not lose [m^3/s], and how its losses grow with the pressures [m^3/s Pa]."""
    count = rooms.zone_area.shape[1]
    for r in range(count):
        for k in range(count):
            matrix[e, r, k] = 0.0
        matrix[e, r, r] = LEAST
        matrix[e, r, count] = work[e, r, balance.NEED]
    for o in range(rooms.vents.shape[1]):
        vent = rooms.vents[e, o]
        a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
        if vent[0] > 0.0 and vent[2] > vent[1] and matrix[e, a, count + 1] > 0.0:
            p, q = rooms.zone_pressure[e, a], float(0.0)
            if b >= 0:
                q = rooms.zone_pressure[e, b]
            there = balance.side(e, b, q, air, rooms)
            here = balance.side(e, a, p, air, rooms)
            flow = vents.volume(balance.passed(e, o, here, there, rooms), here, there)
            more = LITTLE * wp.max(wp.abs(p - q), 1.0)
            over = balance.side(e, a, p + more, air, rooms)
            slope = wp.max((vents.volume(balance.passed(e, o, over, there, rooms), over, there) - flow) / more, LEAST)
            matrix[e, a, count] = matrix[e, a, count] - flow
            matrix[e, a, a] = matrix[e, a, a] + slope
            if b >= 0:
                matrix[e, b, count] = matrix[e, b, count] + flow
                matrix[e, b, b] = matrix[e, b, b] + slope
                matrix[e, a, b] = matrix[e, a, b] - slope
                matrix[e, b, a] = matrix[e, b, a] - slope


@wp.func
def solve(e: int, count: int, matrix: wp.array3d(dtype=float)):
    """Eliminate; the solution is where the right-hand side was. The diagonal dominates: no pivots."""
    for k in range(count):
        for r in range(k + 1, count):
            share = matrix[e, r, k] / matrix[e, k, k]
            if share != 0.0:
                for c in range(k, count + 1):
                    matrix[e, r, c] = matrix[e, r, c] - share * matrix[e, k, c]
    for back in range(count):
        r = count - 1 - back
        value = 1.0 * matrix[e, r, count]
        for c in range(r + 1, count):
            value = value - matrix[e, r, c] * matrix[e, c, count]
        matrix[e, r, count] = value / matrix[e, r, r]


@wp.func
def downhill(
    e: int, part: float, air: float, rooms: Rooms, work: wp.array3d(dtype=float), matrix: wp.array3d(dtype=float)
) -> float:
    """Find the descent that is left after a `part` of a step; below 0 beyond the lowest point of its line."""
    count = rooms.zone_area.shape[1]
    found = float(0.0)
    for r in range(count):
        if matrix[e, r, count + 1] > 0.0:
            found = found + work[e, r, balance.NEED] * matrix[e, r, count]
    for o in range(rooms.vents.shape[1]):
        vent = rooms.vents[e, o]
        a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
        if vent[0] > 0.0 and vent[2] > vent[1] and matrix[e, a, count + 1] > 0.0:
            other, q = float(0.0), float(0.0)
            p = rooms.zone_pressure[e, a] + part * matrix[e, a, count]
            if b >= 0:
                other = 1.0 * matrix[e, b, count]
                q = rooms.zone_pressure[e, b] + part * other
            here, there = balance.side(e, a, p, air, rooms), balance.side(e, b, q, air, rooms)
            found = found - (matrix[e, a, count] - other) * vents.volume(
                balance.passed(e, o, here, there, rooms), here, there
            )
    return found


@wp.func
def settle_pressures(e: int, air: float, rooms: Rooms, work: wp.array3d(dtype=float), matrix: wp.array3d(dtype=float)):
    """Find the pressures of all rooms, from those that they had."""
    count = rooms.zone_area.shape[1]
    mark(e, rooms, matrix)
    for _ in range(STEPS):
        assemble(e, air, rooms, work, matrix)
        for r in range(count):
            if matrix[e, r, count + 1] <= 0.0:  # it stays where it is
                matrix[e, r, count] = 0.0
        solve(e, count, matrix)
        low, high = float(0.0), float(1.0)
        if downhill(e, 1.0, air, rooms, work, matrix) >= 0.0:
            low = float(1.0)
        else:
            for _half in range(HALVINGS):
                middle = 0.5 * (low + high)
                if downhill(e, middle, air, rooms, work, matrix) >= 0.0:
                    low = middle
                else:
                    high = middle
        for r in range(count):
            moved = rooms.zone_pressure[e, r] + low * matrix[e, r, count]
            rooms.zone_pressure[e, r] = wp.clamp(moved, -FARTHEST, FARTHEST)
            if matrix[e, r, count + 1] <= 0.0:
                rooms.zone_pressure[e, r] = 0.0
