"""Furniture of our own for rooms: shelves, drawers, a workbench, lamps, rugs, pictures. It faces -y, backs at +y. Metres."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from trimesh.visual.material import PBRMaterial

from patterns import Rgb, blend, fabric, label, noise, picture, wood
from shapes import Mesh, block, bulge, disc, lathe, material, moved, panel, spline, tube

METAL = material("#9a9ca0", 0.35, 0.7)
BLACK = material("#1f2022", 0.5)
OAK: tuple[Rgb, Rgb] = ((150, 108, 64), (198, 154, 104))
WALNUT: tuple[Rgb, Rgb] = ((74, 46, 28), (118, 78, 48))
BEECH: tuple[Rgb, Rgb] = ((186, 146, 100), (222, 188, 142))
ART = 256  # edge of the pictures [pixels]


def board(size: tuple[float, float, float], at: tuple[float, float, float], of: PBRMaterial, round_by: float = 0.003) -> Mesh:
    """A box of `size` around `at`, its edges eased."""
    return moved(block(size, of, round_by, tile=0.5), at)


def open_shelves(width: float = 0.9, depth: float = 0.32, tops: tuple[float, ...] = (0.06, 0.4, 0.74, 1.08)) -> list[Mesh]:
    """Oak boards with their upper faces at the heights `tops`, between two sides, on a thin back."""
    oak, back = material(rough=0.55, image=wood(*OAK, seed=31)), material("#c9b190", 0.7)
    thick, high = 0.028, tops[-1]
    sides = [board((thick, depth, high - thick), (s * (width - thick) / 2, 0, (high - thick) / 2), oak) for s in (-1, 1)]
    boards = [board((width - 2 * thick, depth - 0.012, thick), (0, -0.002, z - thick / 2), oak) for z in tops[:-1]]
    top = board((width, depth, thick), (0, 0, high - thick / 2), oak)
    return [*sides, *boards, top, board((width - 0.02, 0.008, high - 0.04), (0, depth / 2 - 0.006, high / 2), back, 0)]


def sideboard() -> list[Mesh]:
    """Walnut, 1.5 m wide: an open compartment in the middle between two doors, on legs."""
    nut, front = material(rough=0.45, image=wood(*WALNUT, seed=37)), material("#d8d3c6", 0.5)
    w, d, low, high = 1.5, 0.42, 0.14, 0.78
    frame = [board((w, d, 0.03), (0, 0, z), nut) for z in (high - 0.015, low + 0.015)]
    frame += [board((0.03, d, high - low - 0.06), (x, 0, (high + low) / 2), nut) for x in (-w / 2 + 0.015, -0.25, 0.25, w / 2 - 0.015)]
    frame.append(board((w - 0.04, 0.01, high - low - 0.04), (0, d / 2 - 0.006, (high + low) / 2), nut, 0))
    frame.append(board((0.47, d - 0.03, 0.022), (0, 0, 0.46), nut))
    doors = [board((0.46, 0.02, high - low - 0.068), (s * 0.4925, -d / 2 + 0.012, (high + low) / 2), front) for s in (-1, 1)]
    pulls = [moved(disc(0.012, 0.02, METAL, 0.003, 20), (s * 0.3, -d / 2, 0.56), "x", 90) for s in (-1, 1)]
    legs = [lathe([(0, 0), (0.012, 0), (0.02, low), (0, low)], nut, 16) for _ in range(4)]
    spots = [(sx * (w / 2 - 0.12), sy * (d / 2 - 0.07), 0) for sx in (-1, 1) for sy in (-1, 1)]
    return [*frame, *doors, *pulls, *(moved(leg, at) for leg, at in zip(legs, spots, strict=True))]


def chest_of_drawers(color: str = "#7f95a0") -> list[Mesh]:
    """Painted, with an oak top and four drawers, 0.8 m wide."""
    paint, oak, dark = material(color, 0.55), material(rough=0.5, image=wood(*OAK, seed=41)), material("#43525b", 0.7)
    w, d, h = 0.8, 0.45, 0.9
    parts = [board((w, d, 0.03), (0, 0, h - 0.015), oak, 0.005), board((w - 0.03, d - 0.04, h - 0.1), (0, 0.015, (h + 0.04) / 2), dark, 0)]
    for k, (z, tall) in enumerate(((0.18, 0.22), (0.41, 0.22), (0.62, 0.18), (0.79, 0.14))):
        halves = ((-0.187, 0.366), (0.187, 0.366)) if k == 3 else ((0.0, 0.74),)
        for x, wide in halves:
            parts.append(board((wide, 0.02, tall - 0.012), (x, -d / 2 + 0.03, z), paint, 0.004))
            knobs = (x,) if wide < 0.5 else (-0.2, 0.2)
            parts += [
                moved(
                    lathe([(0.005, 0), (0.006, 0.012), (0.015, 0.02), (0.013, 0.028), (0, 0.03)], METAL, 18), (n, -d / 2 + 0.02, z), "x", 90
                )
                for n in knobs
            ]
    sides = [board((0.02, d - 0.03, h - 0.08), (s * (w / 2 - 0.012), 0.005, (h + 0.02) / 2), paint, 0.002) for s in (-1, 1)]
    feet = [board((0.06, 0.06, 0.06), (sx * (w / 2 - 0.04), sy * (d / 2 - 0.045), 0.03), oak) for sx in (-1, 1) for sy in (-1, 1)]
    return [*parts, *sides, *feet]


def workbench() -> list[Mesh]:
    """A beech bench with a lower board, a row of drawers and a vice, 1.5 m wide: for craft rooms."""
    beech, steel = material(rough=0.6, image=wood(*BEECH, seed=43)), material("#5d6166", 0.4, 0.6)
    w, d, h = 1.5, 0.7, 0.84
    parts = [board((w, d, 0.06), (0, 0, h - 0.03), beech, 0.006), board((w - 0.16, d - 0.16, 0.025), (0, 0, 0.2 - 0.0125), beech)]
    parts += [
        board((0.08, 0.08, h - 0.06), (sx * (w / 2 - 0.1), sy * (d / 2 - 0.1), (h - 0.06) / 2), beech) for sx in (-1, 1) for sy in (-1, 1)
    ]
    parts += [board((w - 0.28, 0.025, 0.1), (0, sy * (d / 2 - 0.09), h - 0.11), beech) for sy in (-1, 1)]
    for x in (-0.32, 0.32):
        parts.append(board((0.5, 0.02, 0.085), (x, -d / 2 + 0.075, h - 0.11), material(rough=0.5, image=wood(*OAK, seed=47)), 0.003))
        parts.append(moved(disc(0.011, 0.02, steel, 0.003, 18), (x, -d / 2 + 0.066, h - 0.11), "x", 90))
    jaw = board((0.2, 0.035, 0.1), (-w / 2 + 0.22, -d / 2 - 0.03, h - 0.055), beech, 0.005)
    screw = moved(disc(0.012, 0.16, steel, 0.0, 16), (-w / 2 + 0.22, -d / 2 + 0.04, h - 0.07), "x", 90)
    bar = moved(disc(0.006, 0.18, steel, 0.001, 12), (-w / 2 + 0.13, -d / 2 - 0.11, h - 0.07), "y", 90)
    return [*parts, jaw, screw, bar]


def wall_cupboard(width: float = 1.2) -> list[Mesh]:
    """Three doors that match the worktop made by kitchen_run; its back is flat at +y."""
    front, carcass = material("#dcdad2", 0.5), material("#c8c5bb", 0.6)
    parts, doors = [board((width, 0.33, 0.68), (0, 0.01, 0.34), carcass, 0)], round(width / 0.4)
    for i in range(doors):
        x = -width / 2 + 0.4 * (i + 0.5)
        parts.append(board((0.394, 0.02, 0.672), (x, -0.164, 0.34), front))
        parts.append(moved(tube([(0, 0, -0.06), (0, 0, 0), (0, 0, 0.06)], 0.005, METAL, 8), (x + 0.16, -0.19, 0.1)))
        parts += [moved(disc(0.004, 0.02, METAL, sides=8), (x + 0.16, -0.172, z), "x", 90) for z in (0.05, 0.15)]
    return parts


def microwave_oven() -> list[Mesh]:
    """A dark oven with a window at the left and a dial and a clock at the right."""
    shell, glass, trim = material("#2c2e31", 0.4), material("#0d0f11", 0.12), material("#b9bcc0", 0.3, 0.6)
    body = board((0.48, 0.36, 0.27), (0, 0.01, 0.145), shell, 0.008)
    door = board((0.345, 0.02, 0.245), (-0.06, -0.175, 0.145), trim, 0.004)
    pane = board((0.29, 0.022, 0.18), (-0.065, -0.176, 0.148), glass, 0.004)
    side = board((0.105, 0.02, 0.245), (0.177, -0.175, 0.145), shell, 0.004)
    clock = label(160, 70, "#07130d", "#58e08a", [("12:30", 0.6, 0.5)])
    face = moved(panel(0.075, 0.032, material(rough=0.2, image=clock)), (0.177, -0.1855, 0.23), "x", 90)
    dials = [moved(disc(r, 0.014, trim, 0.002, 28), (0.177, -0.184, z), "x", 90) for r, z in ((0.022, 0.16), (0.016, 0.095))]
    grip = moved(tube([(0, 0, -0.1), (0, 0, 0), (0, 0, 0.1)], 0.007, trim, 10), (0.1, -0.205, 0.145))
    posts = [moved(disc(0.004, 0.02, trim, sides=8), (0.1, -0.185, z), "x", 90) for z in (0.06, 0.23)]
    feet = [moved(disc(0.014, 0.012, BLACK, sides=14), (sx * 0.2, sy * 0.13 + 0.01, 0)) for sx in (-1, 1) for sy in (-1, 1)]
    return [body, door, pane, side, face, *dials, grip, *posts, *feet]


def tripod_lamp() -> list[Mesh]:
    """Three wooden legs and a linen drum."""
    oak, linen = material(rough=0.5, image=wood(*OAK, seed=53)), material(rough=0.9, image=fabric((226, 214, 188), (210, 196, 168)))
    legs = [tube([(0, 0.26, 0.012), (0, 0.15, 0.55), (0, 0.03, 1.15)], [0.012, 0.016, 0.013], oak, 10) for _ in range(3)]
    hub = moved(disc(0.045, 0.03, BLACK, 0.006), (0, 0, 1.13))
    pole = moved(disc(0.008, 0.14, METAL, sides=12), (0, 0, 1.15))
    shade = lathe([(0.2, 1.22), (0.22, 1.22), (0.2, 1.52), (0.19, 1.52), (0.2, 1.22)], linen, 44)
    bulb = moved(bulge((0.06, 0.06, 0.09), (1, 1), material("#fff3d0", 0.3), 16), (0, 0, 1.31))
    return [*(moved(leg, (0, 0, 0), "z", 120 * i) for i, leg in enumerate(legs)), hub, pole, shade, bulb]


def reading_lamp() -> list[Mesh]:
    """A black lamp that reaches forward over a chair."""
    foot = lathe([(0, 0), (0.13, 0), (0.132, 0.01), (0.12, 0.022), (0.02, 0.03), (0, 0.03)], BLACK, 40)
    pole = tube(spline([(0, 0, 0.02), (0, 0, 1.2), (0, -0.05, 1.45), (0, -0.2, 1.52), (0, -0.3, 1.47)], 40), 0.009, BLACK, 12)
    cone = lathe([(0.03, 0.16), (0.035, 0.14), (0.1, 0.0), (0.096, 0.0), (0.03, 0.13), (0.03, 0.16)], BLACK, 36)
    bulb = moved(bulge((0.05, 0.05, 0.07), (1, 1), material("#fff3d0", 0.3), 14), (0, -0.325, 1.38))
    ring = moved(disc(0.011, 0.03, METAL, 0.003, 20), (0, 0, 0.9))
    return [foot, pole, moved(cone, (0, -0.325, 1.32), "x", -8), bulb, ring]


def _rug(width: float, depth: float, art: np.ndarray, edge: str) -> list[Mesh]:
    """A mat of the colour `edge` with the picture on it."""
    body = moved(block((width, depth, 0.01), material(edge, 1.0), 0.003), (0, 0, 0.005))
    face = moved(panel(width - 0.02, depth - 0.02, material(rough=1.0, image=picture(art))), (0, 0, 0.0105))
    return [body, face]


def striped_rug() -> list[Mesh]:
    """A flat weave with bands across it."""
    size = 512
    bands: list[Rgb] = [
        (198, 186, 160),
        (158, 66, 46),
        (198, 186, 160),
        (58, 78, 92),
        (210, 158, 72),
        (58, 78, 92),
        (198, 186, 160),
        (120, 50, 40),
    ]
    wide = np.array([5, 2, 1, 3, 2, 3, 1, 2])
    edges = np.cumsum(np.tile(wide, 4)) / (4 * wide.sum())
    which = np.searchsorted(edges, (np.arange(size) + 0.5) / size) % len(bands)
    art = np.array(bands, float)[which][None].repeat(size, 0)
    y, x = np.mgrid[0:size, 0:size]
    teeth = (np.abs((y % 32) - 16) < np.abs((x % 64) - 32) / 2) & np.isin(which, (3, 5))[None]
    art[teeth] = (224, 214, 192)
    weave = 0.86 + 0.1 * ((x + y) % 4 < 2) + 0.08 * noise(size, 61)
    return _rug(2.3, 1.6, art * weave[..., None], "#b9ab8a")


def patterned_rug() -> list[Mesh]:
    """Wool with a field of diamonds and a border."""
    size = 512
    y, x = np.mgrid[0:size, 0:size] / size - 0.5
    rim = np.maximum(np.abs(x) * 2, np.abs(y) * 2)
    diamond = (np.abs((x * 6) % 1 - 0.5) + np.abs((y * 6) % 1 - 0.5)) % 0.5
    art = np.where((diamond < 0.11)[..., None], (222, 214, 196), np.where((diamond < 0.3)[..., None], (46, 84, 92), (72, 112, 116)))
    art = np.where((rim > 0.8)[..., None], (42, 58, 70), art)
    art = np.where(((rim > 0.84) & (rim < 0.88))[..., None], (214, 186, 122), art)
    pile = 0.8 + 0.25 * np.random.default_rng(67).random((size, size)) + 0.1 * noise(size, 68)
    return _rug(2.2, 1.7, art * pile[..., None], "#2a3a46")


def _framed(width: float, height: float, art: np.ndarray, bar: PBRMaterial, mount: float) -> list[Mesh]:
    """A picture `width` by `height` in a frame 3 cm wide, with a white mount; hangs with its back at +y, lowest edge at z = 0."""
    mid, b = height / 2, 0.03
    w, h = width - 2 * b, height - 2 * b
    paper = moved(panel(w, h, material("#efece4", 0.9)), (0, -0.008, mid), "x", 90)
    canvas = moved(panel(w - 2 * mount, h - 2 * mount, material(rough=0.85, image=picture(art))), (0, -0.0085, mid), "x", 90)
    frame = [board((width, 0.025, b), (0, 0, z), bar, 0.004) for z in (b / 2, height - b / 2)]
    frame += [board((b, 0.025, h), (s * (width - b) / 2, 0, mid), bar, 0.004) for s in (-1, 1)]
    return [paper, canvas, *frame, board((width - 0.04, 0.01, height - 0.04), (0, 0.005, mid), material("#6b5a45", 0.8), 0)]


def landscape_picture() -> list[Mesh]:
    """Hills by a lake in the evening, in a gilt frame."""
    y, x = np.mgrid[0:ART, 0:ART] / ART
    art = blend((86, 116, 150), (240, 190, 130), np.clip(y * 1.9, 0, 1))
    sun = np.exp(-(((x - 0.68) / 0.07) ** 2 + ((y - 0.4) / 0.05) ** 2))
    art = art + sun[..., None] * (60, 50, 20)
    for k, (level, tone) in enumerate(((0.44, (112, 112, 130)), (0.5, (70, 86, 92)), (0.55, (42, 58, 52)))):
        ridge = level + 0.06 * np.sin((5 + 3 * k) * x + 2 * k) + 0.02 * np.sin(23 * x + k)
        art = np.where((y > ridge)[..., None], np.array(tone) * (1.1 - 0.2 * y[..., None]), art)
    lake = y > 0.66
    glints = 0.8 + 0.12 * np.sin(y * 90 + 6 * noise(ART, 71)) + 0.3 * np.exp(-(((x - 0.68) / 0.1) ** 2))
    art = np.where(lake[..., None], np.array([120, 118, 120]) * glints[..., None], art)
    return _framed(0.8, 0.58, art * (0.9 + 0.2 * noise(ART, 72)[..., None]), material("#a8843e", 0.4, 0.5), 0.0)


def abstract_print() -> list[Mesh]:
    """Discs and arcs in a black frame, upright."""
    y, x = np.mgrid[0:ART, 0:ART] / ART
    art = np.full((ART, ART, 3), (236, 228, 212), float)
    for cx, cy, r, tone in ((0.4, 0.36, 0.27, (202, 92, 58)), (0.64, 0.56, 0.21, (44, 82, 104)), (0.34, 0.72, 0.15, (222, 170, 74))):
        art[np.hypot(x - cx, (y - cy) * 1.35) < r] = tone
    for k in range(4):
        art[np.abs(np.hypot(x - 0.9, (y - 1.0) * 1.35) - 0.3 - 0.07 * k) < 0.008] = (40, 44, 46)
    return _framed(0.5, 0.7, art * (0.94 + 0.08 * noise(ART, 73)[..., None]), material("#222324", 0.5), 0.05)


MAKERS: dict[str, Callable[..., list[Mesh]]] = {
    f.__name__: f
    for f in (
        open_shelves,
        sideboard,
        chest_of_drawers,
        workbench,
        wall_cupboard,
        microwave_oven,
        tripod_lamp,
        reading_lamp,
        striped_rug,
        patterned_rug,
        landscape_picture,
        abstract_print,
    )
}
