"""Things that flutter or hang: awnings, signs, flags, washing, bunting. Sizes are in metres [ours]."""

from __future__ import annotations

import math

from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.town import Town, paint, rod
from hazard_ms.scenes.generate.draw import Draw

FLUTTER = 0.28  # how far the wind moves the free edge of cloth at most [m] [ours]


def awning(town: Town, frame: Frame, width: float, high: float, draw: Draw) -> None:
    """A striped awning over a shop, whose valance flutters."""
    cell, x, out = paint(draw.one(("awning", "awning_green"))), width / 2, 1.1
    town.firm.quad(
        frame, [(-x, -out, high - 0.35), (x, -out, high - 0.35), (x, 0, high + 0.1), (-x, 0, high + 0.1)], cell
    )
    town.loose.quad(
        frame,
        [(-x, -out, high - 0.6), (x, -out, high - 0.6), (x, -out, high - 0.35), (-x, -out, high - 0.35)],
        cell,
        (0.3 * FLUTTER, 0.3 * FLUTTER, 0.0, 0.0),
    )


def hanging_sign(town: Town, frame: Frame, high: float, draw: Draw) -> None:
    """A sign that stands out of a front."""
    cell = paint(f"sign_{draw.whole(0, 7)}")
    town.firm.box(frame, (-0.02, -0.95, high + 0.72), (0.02, 0.0, high + 0.76), paint("dark"))
    for x, (a, b) in ((-0.03, (-0.15, -0.85)), (0.03, (-0.85, -0.15))):
        town.firm.quad(frame, [(x, a, high), (x, b, high), (x, b, high + 0.7), (x, a, high + 0.7)], cell)


def flag(town: Town, frame: Frame, high: float, draw: Draw, width: float = 1.1, cell: str = "") -> None:
    """A flag on a pole that leans out of a wall: it hangs from the pole's end and flutters."""
    out = 1.25
    rod(town, frame, (0.0, 0.0, high), (0.0, -out, high + 0.8), 0.02, "timber")
    pennant(town, frame.moved(0.0, -out, math.pi / 2), high + 0.75, width, 0.7, cell or f"cloth_{draw.whole(0, 5)}")


def pennant(town: Town, frame: Frame, top: float, width: float, tall: float, cell: str) -> None:
    """Cloth that is held by its left edge, in three strips, the last of which flies most."""
    left, upper, right, lower = paint(cell)
    for k in range(3):
        a, b = k / 3, (k + 1) / 3
        drop = (0.12 * a * tall, 0.12 * b * tall)
        town.loose.quad(
            frame,
            [
                (a * width, 0, top - tall - drop[0]),
                (b * width, 0, top - tall - drop[1]),
                (b * width, 0, top - drop[1]),
                (a * width, 0, top - drop[0]),
            ],
            (left + (right - left) * a, upper, left + (right - left) * b, lower),
            (FLUTTER * a, FLUTTER * b, FLUTTER * b, FLUTTER * a),
        )


def laundry(town: Town, frame: Frame, width: float, high: float, draw: Draw) -> None:
    """A line with washing along x, between two posts."""
    x = -width / 2
    for side in (x, -x):
        rod(town, frame, (side, 0, 0), (side, 0, high + 0.1), 0.04, "timber")
    rod(town, frame, (x, 0, high), (-x, 0, high), 0.012, "white")
    while x < width / 2 - 1.0:
        wide, tall = draw.uniform(0.5, 0.95), draw.uniform(0.5, 1.1)
        cell = paint(draw.one(("cloth_0", "cloth_3", "cloth_4", "pink", "white", "teal")))
        town.loose.quad(
            frame,
            [(x, 0, high - tall), (x + wide, 0, high - tall), (x + wide, 0, high), (x, 0, high)],
            cell,
            (FLUTTER, FLUTTER, 0.0, 0.0),
        )
        x += wide + draw.uniform(0.08, 0.3)


def bunting(town: Town, start: Frame, length: float, high: float, draw: Draw) -> None:
    """Small flags on a string along x of `start`."""
    count = int(length / 0.55)
    rod(town, start, (0, 0, high), (length, 0, high), 0.012, "white")
    for k in range(count):
        x = (k + 0.5) * length / count
        cell = paint(draw.one(("red", "yellow", "blue", "white", "green", "orange")))
        town.loose.quad(
            start,
            [(x, 0, high - 0.34), (x, 0, high - 0.34), (x + 0.17, 0, high), (x - 0.17, 0, high)],
            cell,
            (0.5 * FLUTTER, 0.5 * FLUTTER, 0.0, 0.0),
        )
