"""The pieces of a town as quads: houses, gardens, trees, lamps, bins, bicycles, signs.

Each stands at a frame on the ground, faces -y, and is made of paintings of painting.py. Sizes are in metres [ours].
"""

from __future__ import annotations

import math

from hazard_ms.effects.streets.cloth import awning, flag, hanging_sign
from hazard_ms.effects.streets.fronts import SHOPS
from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.painting import WALLS
from hazard_ms.effects.streets.town import Town, cut, paint
from hazard_ms.scenes.generate.draw import Draw

FRONTS = 16  # paintings of house fronts
ROOFS = ("roof_slate", "roof_red", "roof_brown")
CROWNS = ("crown_1", "crown_2", "crown_3")
SWAY = 0.35  # how far the wind moves the top of a tree at most [m]


def house(town: Town, frame: Frame, width: float, depth: float, number: int, draw: Draw) -> None:
    """A house with front `number`, its gables to the sides, a chimney, and what hangs on the front."""
    storeys = 2 if number % 3 else 3
    high, rise = 2.75 * storeys, 0.32 * depth
    x, wall, roof = width / 2, paint(WALLS[number % 4]), paint(ROOFS[number % 3])
    mesh, ridge, low = town.firm, high + rise, high - 0.12
    mesh.quad(frame, [(-x, 0, 0), (x, 0, 0), (x, 0, high), (-x, 0, high)], paint(f"front_{number}"))
    mesh.quad(frame, [(x, depth, 0), (-x, depth, 0), (-x, depth, high), (x, depth, high)], wall)
    for side, (near, far) in ((-x, (depth, 0.0)), (x, (0.0, depth))):
        gable = paint(f"gable_{number % 4}")
        mesh.quad(frame, [(side, near, 0), (side, far, 0), (side, far, high), (side, near, high)], gable)
        mesh.quad(
            frame,
            [(side, near, high), (side, far, high), (side, depth / 2, ridge), (side, depth / 2, ridge)],
            wall,
        )
    e = 0.3
    mesh.quad(
        frame,
        [(-x - 0.1, -e, low), (x + 0.1, -e, low), (x + 0.1, depth / 2, ridge), (-x - 0.1, depth / 2, ridge)],
        roof,
    )
    back = depth + e
    mesh.quad(
        frame,
        [(x + 0.1, back, low), (-x - 0.1, back, low), (-x - 0.1, depth / 2, ridge), (x + 0.1, depth / 2, ridge)],
        roof,
    )
    mesh.box(frame, (-x, -0.16, high - 0.16), (x, -0.02, high - 0.04), paint("white"))  # the gutter
    at = draw.uniform(-0.6, 0.6) * x
    mesh.box(
        frame, (at, depth / 2 - 0.3, high), (at + 0.7, depth / 2 + 0.3, ridge + 0.8), paint("wall_brick"), paint("dark")
    )
    _hung(town, frame, x, high / storeys, number, draw)


def _hung(town: Town, frame: Frame, x: float, storey: float, number: int, draw: Draw) -> None:
    """An awning and a sign on a shop; flags, ivy or boxes of flowers on a house."""
    if number in SHOPS:
        awning(town, frame, 1.7 * x, 0.8 * storey, draw)
        hanging_sign(town, frame.moved(0.9 * x, 0.0), storey + 0.4, draw)
        return
    kind = draw.uniform()
    if kind < 0.35:
        flag(town, frame.moved(draw.uniform(-0.5, 0.5) * x, -0.05), 1.2 * storey, draw)
    elif kind < 0.65:
        a = draw.uniform(-0.2, 0.1) * x
        town.firm_cut.quad(frame, [(-x, -0.06, 0), (a, -0.06, 0), (a, -0.06, 5.2), (-x, -0.06, 5.2)], cut("ivy"))
    step = paint("stone")
    town.firm.box(frame, (-0.9 * x, -0.5, 0.0), (-0.4 * x, 0.0, 0.14), step)


def tree(town: Town, frame: Frame, draw: Draw) -> None:
    """A tree: a trunk and crossed pictures of its crown, which the wind bends."""
    conifer = draw.uniform() < 0.25
    name = "conifer" if conifer else draw.one(CROWNS)
    high, wide = draw.uniform(5.0, 8.0), draw.uniform(3.6, 5.4)
    if conifer:
        wide *= 0.6
    foot = 0.4 if conifer else 0.26 * high
    town.firm.box(frame, (-0.14, -0.14, 0.0), (0.14, 0.14, foot + 0.25 * high), paint("skin"))
    turn = draw.uniform(0.0, math.pi)
    for k in range(3):
        own = frame.moved(0.0, 0.0, turn + k * math.pi / 3)
        x = wide / 2
        town.loose_cut.quad(
            own,
            [(-x, 0, foot), (x, 0, foot), (x, 0, high), (-x, 0, high)],
            cut(name),
            (0.2 * SWAY, 0.2 * SWAY, SWAY, SWAY),
        )


def lamp(town: Town, frame: Frame) -> None:
    """A street lamp with an arm over the road."""
    town.firm.box(frame, (-0.06, -0.06, 0.0), (0.06, 0.06, 5.2), paint("dark"))
    town.firm.box(frame, (-0.05, -1.5, 5.1), (0.05, 0.0, 5.2), paint("dark"))
    town.firm.box(frame, (-0.12, -1.7, 5.02), (0.12, -1.1, 5.12), paint("lamp"), paint("dark"))
    town.firm.quad(
        frame, [(-0.1, -1.65, 5.01), (-0.1, -1.15, 5.01), (0.1, -1.15, 5.01), (0.1, -1.65, 5.01)], paint("lamp")
    )


def bins(town: Town, frame: Frame, draw: Draw) -> None:
    """One to three bins on wheels, side by side."""
    for k in range(draw.whole(1, 3)):
        at = frame.moved(0.68 * k, draw.uniform(-0.08, 0.08), draw.uniform(-0.2, 0.2))
        cell = paint(draw.one(("green", "dark", "blue", "grey")))
        town.firm.box(at, (-0.27, -0.3, 0.05), (0.27, 0.3, 0.95), cell)
        town.firm.box(at, (-0.3, -0.34, 0.95), (0.3, 0.34, 1.02), paint("black"))


def bicycle(town: Town, frame: Frame, lean: float = 0.16) -> None:
    """A bicycle along x that leans towards +y."""
    corners = [(-0.9, 0, 0), (0.9, 0, 0), (0.9, lean, 1.5), (-0.9, lean, 1.5)]
    left, upper, right, lower = cut("bicycle")
    town.firm_cut.quad(frame, corners, (left, upper + 0.14 * (lower - upper), right, upper + 0.92 * (lower - upper)))


def road_sign(town: Town, frame: Frame, draw: Draw) -> None:
    """A sign on a post."""
    town.firm.box(frame, (-0.03, -0.03, 0.0), (0.03, 0.03, 2.7), paint("grey"))
    cell = paint(draw.one(("blue", "red", "yellow")))
    town.firm.box(frame, (-0.32, -0.07, 2.1), (0.32, -0.03, 2.7), cell)
    town.firm.box(frame, (-0.22, -0.09, 2.2), (0.22, -0.07, 2.6), paint("white"))


def garden(town: Town, frame: Frame, width: float, draw: Draw) -> None:
    """A strip along x in front of a house, 1.6 m deep: a wall, hedge or railing, and flowers behind it."""
    x, kind = width / 2, draw.one(("wall", "hedge", "railing", "fence"))
    door = draw.uniform(-0.3, 0.3) * width
    for a, b in ((-x, door - 0.6), (door + 0.6, x)):
        if b - a < 0.4:
            continue
        if kind == "railing":
            for k in range(max(round((b - a) / 1.6), 1)):
                w = (b - a) / max(round((b - a) / 1.6), 1)
                c = a + k * w
                town.firm_cut.quad(frame, [(c, 0, 0), (c + w, 0, 0), (c + w, 0, 1.1), (c, 0, 1.1)], cut("railing"))
        else:
            thick, high = {"wall": (0.22, 0.75), "hedge": (0.55, 1.05), "fence": (0.06, 0.95)}[kind]
            top = {"wall": "stone", "hedge": "hedge", "fence": "timber"}[kind]
            side = {"wall": "wall_brick", "hedge": "hedge", "fence": "fence"}[kind]
            town.firm.box(frame, (a, 0.0, 0.0), (b, thick, high), paint(side), paint(top))
        town.firm.flat(frame.moved((a + b) / 2, 1.0), (b - a, 0.9), paint("bed"), 0.012)
