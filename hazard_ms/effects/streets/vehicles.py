"""Parked vehicles as quads: a hatchback, a saloon, an estate, a van and a pickup, from their outlines."""

from __future__ import annotations

import math
from typing import NamedTuple

from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.town import Town, paint
from hazard_ms.scenes.generate.draw import Draw

COATS = ("red", "blue", "white", "silver", "black", "green", "teal", "cream", "grey")  # paints
ROUND = 10  # corners of a wheel
WHEEL = 0.33  # radius [m]
NARROWER = 0.16  # by which the roof is narrower than the body on each side [m]


class Outline(NamedTuple):
    """A vehicle seen from its left: from the front, x [m] and height [m] of the lower body and of the cabin."""

    length: float
    width: float
    body: tuple[tuple[float, float], ...]  # along its upper edge, from the front bumper to the rear one
    cabin: tuple[tuple[float, float], ...]  # foot of the windscreen, roof in front, roof behind, foot of the rear pane
    axles: tuple[float, float]
    panes: bool = True  # whether the sides of the cabin are glass all along


KINDS = (
    Outline(
        3.9,
        1.74,
        ((0.0, 0.62), (0.9, 0.86), (3.75, 0.92), (3.9, 0.7)),
        ((0.85, 0.86), (1.55, 1.46), (3.1, 1.5), (3.75, 0.92)),
        (0.75, 3.2),
    ),
    Outline(
        4.6,
        1.80,
        ((0.0, 0.6), (1.15, 0.84), (4.45, 0.9), (4.6, 0.66)),
        ((1.1, 0.84), (1.9, 1.42), (3.15, 1.42), (3.9, 0.9)),
        (0.85, 3.7),
    ),
    Outline(
        4.7,
        1.82,
        ((0.0, 0.62), (1.1, 0.88), (4.6, 0.95), (4.7, 0.66)),
        ((1.05, 0.88), (1.8, 1.5), (4.2, 1.5), (4.6, 0.95)),
        (0.85, 3.75),
    ),
    Outline(
        5.2,
        2.0,
        ((0.0, 0.75), (0.6, 1.1), (5.2, 1.1), (5.2, 1.0)),
        ((0.55, 1.1), (1.2, 2.2), (5.15, 2.25), (5.2, 1.1)),
        (0.95, 4.2),
        False,
    ),
    Outline(
        5.1,
        1.9,
        ((0.0, 0.8), (1.2, 1.05), (5.0, 1.05), (5.1, 0.95)),
        ((1.15, 1.05), (1.75, 1.75), (2.9, 1.75), (3.1, 1.05)),
        (0.95, 4.1),
    ),
)


def vehicle(town: Town, frame: Frame, draw: Draw) -> None:
    """A parked vehicle along x, its front at -x, with its middle at the frame's place."""
    kind, colour = draw.one(KINDS), draw.one(COATS)
    own = frame.moved(-kind.length / 2, 0.0)
    half = kind.width / 2
    coat, sill = paint(colour), 0.26
    edge = [(0.0, sill), *kind.body, (kind.length, sill)]
    for (a, h), (b, k) in zip(edge[:-1], edge[1:], strict=True):  # bonnet, deck, ends
        town.firm.quad(own, [(a, half, h), (a, -half, h), (b, -half, k), (b, half, k)], coat)
    for fore, aft in zip(kind.body[:-1], kind.body[1:], strict=True):
        for y in (-half, half):
            ends = (fore, aft) if y < 0 else (aft, fore)
            town.firm.quad(
                own,
                [
                    (ends[0][0], y, sill),
                    (ends[1][0], y, sill),
                    (ends[1][0], y, ends[1][1]),
                    (ends[0][0], y, ends[0][1]),
                ],
                coat,
            )
    _cabin(town, own, kind, half, colour)
    for at in kind.axles:
        for y in (-half - 0.02, half + 0.02):
            _wheel(town, own.moved(at, y), y > 0)
    for x, name in ((-0.02, "lamp"), (kind.length + 0.02, "tail")):
        for y in (-half + 0.12, half - 0.42):
            left, right = (y + 0.3, y) if x < 0 else (y, y + 0.3)
            town.firm.quad(own, [(x, left, 0.5), (x, right, 0.5), (x, right, 0.66), (x, left, 0.66)], paint(name))
    town.firm.quad(
        own, [(-0.02, 0.4, 0.34), (-0.02, -0.4, 0.34), (-0.02, -0.4, 0.54), (-0.02, 0.4, 0.54)], paint("grille")
    )


def _cabin(town: Town, own: Frame, kind: Outline, half: float, colour: str) -> None:
    """The windscreen, the roof, the rear pane and the sides, which lean inwards."""
    (a, low), (b, high), (c, top), (d, foot) = kind.cabin
    up, glass, coat = half - NARROWER, paint("glass"), paint(colour)
    town.firm.quad(own, [(a, half - 0.05, low), (a, 0.05 - half, low), (b, -up, high), (b, up, high)], glass)
    town.firm.quad(own, [(b, up, high), (b, -up, high), (c, -up, top), (c, up, top)], coat)
    town.firm.quad(
        own,
        [(d, 0.05 - half, foot), (d, half - 0.05, foot), (c, up, top), (c, -up, top)],
        glass if kind.panes else coat,
    )
    for side in (-1.0, 1.0):
        lower = [
            (a, side * (half - 0.02), low),
            (d, side * (half - 0.02), foot),
            (c, side * up, top),
            (b, side * up, high),
        ]
        town.firm.quad(own, lower if side < 0 else [lower[1], lower[0], lower[3], lower[2]], coat)
        ends = (0.12, 0.94) if kind.panes else (0.1, 0.26)
        pane = [
            _within(lower, u, v)
            for u, v in ((ends[0], 0.12), (ends[1], 0.12), (ends[1] - 0.03, 0.86), (ends[0] + 0.03, 0.86))
        ]
        pane = [(x, y + side * 0.012, z) for x, y, z in pane]
        middle = [_between(pane[0], pane[1], 0.5), _between(pane[3], pane[2], 0.5)]
        for quad in (  # two panes, with a post between
            [pane[0], _between(middle[0], pane[0], 0.06), _between(middle[1], pane[3], 0.06), pane[3]],
            [_between(middle[0], pane[1], 0.06), pane[1], pane[2], _between(middle[1], pane[2], 0.06)],
        ):
            town.firm.quad(own, quad if side < 0 else [quad[1], quad[0], quad[3], quad[2]], glass)


def _within(quad: list[tuple[float, float, float]], u: float, v: float) -> tuple[float, float, float]:
    """The point of a quad at the share `u` along its lower and upper edges and `v` upwards."""
    return _between(_between(quad[0], quad[1], u), _between(quad[3], quad[2], u), v)


def _between(a: tuple[float, float, float], b: tuple[float, float, float], share: float) -> tuple[float, float, float]:
    x, y, z = (p + share * (q - p) for p, q in zip(a, b, strict=True))
    return x, y, z


def _wheel(town: Town, own: Frame, left: bool) -> None:
    """A disc, as quads from its middle; the painting shows the rim."""
    a, b, c, d = paint("wheel")
    u, v = (a + c) / 2, (b + d) / 2
    reach = 0.5 * (c - a), 0.5 * (d - b)
    for k in range(0, ROUND, 2):
        turns = [2 * math.pi * (k + m) / ROUND * (-1 if left else 1) for m in range(3)]
        rim = [(WHEEL * math.cos(t), 0.0, WHEEL + WHEEL * math.sin(t)) for t in turns]
        spots = [(u, v), *((u + reach[0] * math.cos(t), v - reach[1] * math.sin(t)) for t in turns)]
        town.firm.shape(own, [(0.0, 0.0, WHEEL), *rim], spots)
