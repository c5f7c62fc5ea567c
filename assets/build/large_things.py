"""Larger things of our own: bags, cases, boxes, a printer, the rescue bag, and the openings of rooms. Metres."""

from __future__ import annotations

import numpy as np

from patterns import fabric, label, wicker, wood
from shapes import Mesh, block, bulge, disc, lathe, material, moved, panel, spline, tube

METAL = material("#9a9ca0", 0.35, 0.7)


def rescue_bag() -> list[Mesh]:
    """An open-topped red bag with reflecting bands and a white cross; faces -y."""
    red = material(rough=0.85, image=fabric((186, 34, 30), (150, 20, 20), seed=3))
    dark, band = material("#571411", 0.9), material("#d9d9cf", 0.25, 0.2)
    x, y, z = 0.24, 0.16, 0.32
    sides = [moved(block((2 * x, 0.02, z), red, 0.009, tile=0.2), (0, s * (y - 0.01), z / 2)) for s in (-1, 1)] + [
        moved(block((0.02, 2 * y - 0.02, z), red, 0.009, tile=0.2), (s * (x - 0.01), 0, z / 2)) for s in (-1, 1)
    ]
    floor = moved(block((2 * x - 0.02, 2 * y - 0.02, 0.016), dark, 0.006), (0, 0, 0.008))
    bands = [moved(block((2 * x + 0.004, 2 * y + 0.004, 0.03), band, 0.01), (0, 0, 0.07))]
    hollow = moved(block((2 * x - 0.04, 2 * y - 0.04, 0.031), dark), (0, 0, 0.07))
    white = material("#f1f1ec", 0.6)
    cross = [moved(block((a, 0.006, b), white), (0, -y - 0.001, 0.2)) for a, b in ((0.12, 0.04), (0.04, 0.12))]
    arch = [(0.1 * np.cos(a), 0.0, 0.12 * np.sin(a)) for a in np.linspace(np.pi, 0, 20)]
    handles = [moved(tube(arch, 0.009, dark, 10), (0, s * (y - 0.012), z - 0.03)) for s in (-1, 1)]
    return [*sides, floor, *bands, hollow, *cross, *handles]


def backpack(color: tuple[int, int, int] = (38, 74, 112), trim: str = "#e08a2c") -> list[Mesh]:
    """A school bag that stands; faces -y."""
    cloth, edge, strap = material(rough=0.9, image=fabric(color, color)), material(trim, 0.7), material("#22262c", 0.9)
    body = moved(bulge((0.3, 0.17, 0.42), (0.45, 0.5), cloth, 40, 3.0), (0, 0, 0.21))
    pocket = moved(bulge((0.23, 0.1, 0.19), (0.5, 0.5), cloth, 30, 2.0), (0, -0.075, 0.12))
    zips = [
        moved(
            tube(spline([(-0.1, 0, 0), (-0.07, 0, 0.035), (0, 0, 0.05), (0.07, 0, 0.035), (0.1, 0, 0)], 20), 0.004, edge, 8), at
        )
        for at in ((0, -0.118, 0.155), (0, -0.075, 0.33))
    ]
    straps = [
        tube(spline([(s, 0.06, 0.38), (s, 0.115, 0.3), (s, 0.12, 0.16), (s, 0.075, 0.05)], 20), 0.014, strap, 8)
        for s in (-0.08, 0.08)
    ]
    loop = tube(spline([(-0.03, 0.03, 0.405), (0, 0.03, 0.45), (0.03, 0.03, 0.405)], 12), 0.006, strap, 8)
    return [body, pocket, *zips, *straps, loop]


def trolley_case(color: str = "#8c2f3c") -> list[Mesh]:
    """A hard suitcase on wheels, upright, handle pushed in; faces -y."""
    shell, dark = material(color, 0.35), material("#24262a", 0.6)
    parts = [moved(block((0.38, 0.105, 0.5), shell, 0.03, 2), (0, s * 0.053, 0.29)) for s in (-1, 1)]
    parts += [
        moved(block((0.02, 0.218, 0.44), material(color, 0.5), 0.006), (x, 0, 0.29)) for x in (-0.12, -0.06, 0.0, 0.06, 0.12)
    ]
    parts.append(moved(block((0.384, 0.012, 0.504), dark, 0.005), (0, 0, 0.29)))
    parts += [
        moved(disc(0.022, 0.02, dark, 0.003, 24), (x - 0.01, y, 0.022), "y", 90) for x in (-0.15, 0.15) for y in (-0.07, 0.07)
    ]
    parts += [moved(block((0.03, 0.03, 0.03), dark, 0.004), (x, y, 0.045)) for x in (-0.15, 0.15) for y in (-0.07, 0.07)]
    grip = tube(spline([(-0.09, 0.03, 0.535), (-0.08, 0.03, 0.57), (0.08, 0.03, 0.57), (0.09, 0.03, 0.535)], 20), 0.009, dark, 10)
    return [*parts, grip]


def laser_printer() -> list[Mesh]:
    """A desk printer; faces -y."""
    white, grey, dark = material("#dfe0de", 0.45), material("#8b8f94", 0.5), material("#25272b", 0.4)
    body = moved(block((0.38, 0.35, 0.2), white, 0.015), (0, 0, 0.1))
    hood = moved(block((0.36, 0.2, 0.03), grey, 0.01), (0, 0.07, 0.21))
    slot = moved(block((0.28, 0.1, 0.02), dark, 0.004), (0, -0.08, 0.195))
    paper = moved(block((0.21, 0.16, 0.004), material("#fbfbf8", 0.9)), (0, -0.07, 0.209), "x", 6)
    tray = moved(block((0.3, 0.012, 0.05), grey, 0.004), (0, -0.175, 0.045))
    screen = moved(
        panel(0.07, 0.03, material(rough=0.2, image=label(140, 60, "#173a5e", "#bfe3ff", [("READY", 0.5, 0.5)]))),
        (0.13, -0.12, 0.2005),
    )
    lamp = moved(disc(0.006, 0.003, material("#35c76a", 0.3), sides=16), (0.175, -0.13, 0.2))
    return [body, hood, slot, paper, tray, screen, lamp]


def woven_basket() -> list[Mesh]:
    """A round laundry basket, open, with two handles."""
    reed = material(rough=0.9, image=wicker())
    wall = lathe([(0, 0.012), (0.13, 0.012), (0.15, 0.23), (0.156, 0.245), (0.164, 0.23), (0.142, 0), (0, 0)][::-1], reed, 48)
    wall.visual.uv = wall.visual.uv * [8, 5]
    rim = moved(
        tube(
            [(0.158 * np.cos(a), 0.158 * np.sin(a), 0.24) for a in np.linspace(0, 2 * np.pi, 60)],
            0.008,
            material("#7a4f28", 0.8),
            8,
        )
    )
    arch = [(0.05 * np.cos(a), 0, 0.05 * np.sin(a)) for a in np.linspace(np.pi, 0, 16)]
    handles = [moved(tube(arch, 0.007, material("#7a4f28", 0.8), 8), (0, s * 0.158, 0.238)) for s in (-1, 1)]
    return [wall, rim, *handles]


def gift_box() -> list[Mesh]:
    paper, ribbon = material("#2f6f63", 0.5), material("#d9b44a", 0.4, 0.2)
    body, lid = (
        moved(block((0.26, 0.26, 0.16), paper, 0.002), (0, 0, 0.08)),
        moved(block((0.27, 0.27, 0.05), paper, 0.003), (0, 0, 0.165)),
    )
    bands = [moved(block(e, ribbon, 0.001), (0, 0, 0.0955)) for e in ((0.04, 0.274, 0.192), (0.274, 0.04, 0.192))]
    loop = [(0.045 * np.cos(a), 0, 0.028 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 24)]
    bow = [
        moved(tube([(x + s * 0.045, y, z) for x, y, z in loop], 0.008, ribbon, 8), (0, 0, 0.218), "z", a)
        for s, a in ((1, 20), (-1, 20), (1, -40))
    ]
    return [body, lid, *bands, *bow]


def kitchen_run(width: float = 1.2) -> list[Mesh]:
    """A run of lower cabinets with an oak worktop; faces -y."""
    front, carcass, dark = material("#dcdad2", 0.5), material("#c8c5bb", 0.6), material("#2a2a2c", 0.6)
    top = moved(
        block((width, 0.62, 0.038), material(rough=0.4, image=wood((128, 88, 50), (186, 140, 92), seed=23)), 0.004, tile=0.6),
        (0, 0, 0.881),
    )
    body = moved(block((width, 0.56, 0.76), carcass), (0, 0.03, 0.482))
    plinth = moved(block((width, 0.5, 0.1), dark), (0, 0.06, 0.05))
    parts, doors = [top, body, plinth], max(1, round(width / 0.4))
    each = width / doors
    for i in range(doors):
        x = -width / 2 + each * (i + 0.5)
        parts.append(moved(block((each - 0.006, 0.02, 0.58), front, 0.003), (x, -0.26, 0.4)))
        parts.append(moved(block((each - 0.006, 0.02, 0.16), front, 0.003), (x, -0.26, 0.775)))
        parts += [moved(tube([(-0.06, 0, 0), (0, 0, 0), (0.06, 0, 0)], 0.005, METAL, 8), (x, -0.285, z)) for z in (0.64, 0.775)]
        parts += [
            moved(disc(0.004, 0.02, METAL, sides=8), (x + s * 0.05, -0.268, z), "x", 90) for z in (0.64, 0.775) for s in (-1, 1)
        ]
    return parts


def picture_frame() -> list[Mesh]:
    """A framed abstract picture for a wall; hangs with its back at +y."""
    size = 256
    y, x = np.mgrid[0:size, 0:size] / size
    from patterns import picture

    sky, hill = np.array([205, 190, 150]), np.array([70, 100, 96])
    ridge = 0.55 + 0.12 * np.sin(5 * x) + 0.05 * np.sin(17 * x + 1)
    art = picture(np.where((y > ridge)[..., None], hill * (1.25 - 0.6 * y[..., None]), sky * (0.7 + 0.5 * y[..., None])))
    canvas = moved(panel(0.62, 0.42, material(rough=0.9, image=art)), (0, -0.012, 0.25), "x", 90)
    bar = material(rough=0.5, image=wood((40, 26, 16), (74, 48, 30)))
    frame = [moved(block((0.7, 0.03, 0.04), bar, 0.004), (0, 0, z)) for z in (0.02, 0.48)]
    frame += [moved(block((0.04, 0.03, 0.42), bar, 0.004), (s * 0.33, 0, 0.25)) for s in (-1, 1)]
    return [canvas, *frame, moved(block((0.64, 0.012, 0.44), material("#6b5a45")), (0, 0.005, 0.25))]


MAKERS = {f.__name__: f for f in list(globals().values()) if callable(f) and getattr(f, "__module__", "") == __name__}
