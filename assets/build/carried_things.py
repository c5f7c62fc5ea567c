"""Things of our own that people carry about: bags, cases, baskets, boxes, money, cameras, headphones. Metres; what has a face faces -y."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from trimesh.visual.material import PBRMaterial

from patterns import fabric, label, wicker, wood
from shapes import Mesh, block, bulge, disc, lathe, material, moved, panel, spline, tube

STEEL = material("#a9abb0", 0.35, 0.7)
DARK = material("#1d1e21", 0.6)


def tote_bag() -> list[Mesh]:
    """A canvas bag with two loops and a print on it, standing."""
    canvas = material(rough=0.95, image=fabric((222, 208, 178), (200, 186, 156), seed=81))
    print_ = label(256, 256, "#dccfb0", "#2f5d50", [("MARKET", 0.17, 0.36), ("fresh every day", 0.08, 0.56)], "")
    body = bulge((0.36, 0.13, 0.36), (0.3, 0.45), canvas, 36, 3.0)
    x, y, z = body.vertices.T
    body.vertices = np.c_[x * (1 + 0.25 * z), y * (1 - 1.6 * np.clip(z, 0, None)), z]  # wider and thinner towards the top
    front = moved(panel(0.2, 0.2, material(rough=0.95, image=print_)), (0, -0.0655, 0.17), "x", 90)
    arch = spline([(-0.08, 0, 0.28), (-0.085, 0, 0.42), (-0.05, 0, 0.53), (0.05, 0, 0.53), (0.085, 0, 0.42), (0.08, 0, 0.28)], 30)
    loops = [moved(tube(arch, 0.009, material("#2f5d50", 0.9), 8), (0, s * 0.05, 0)) for s in (-1, 1)]
    return [moved(body, (0, 0, 0.18)), front, *loops]


def sports_bag() -> list[Mesh]:
    """A round duffel with end caps, a zip and two handles."""
    cloth, cap, web = (
        material(rough=0.85, image=fabric((34, 60, 92), (28, 50, 80), seed=83)),
        material("#20242b", 0.8),
        material("#d9b23c", 0.8),
    )
    body = moved(
        lathe([(0.0, -0.25), (0.125, -0.25), (0.135, -0.235), (0.138, 0), (0.135, 0.235), (0.125, 0.25), (0, 0.25)], cloth, 36),
        (0, 0, 0.125),
        "y",
        90,
    )
    x, y, z = body.vertices.T
    body.vertices = np.c_[x, y, np.where(z < 0.03, 0.4 * (z - 0.03) + 0.03, z)]  # it lies flat
    ends = [moved(disc(0.11, 0.012, cap, 0.004, 32), (s * 0.25 - 0.006, 0, 0.135), "y", 90) for s in (-1, 1)]
    bands = [
        moved(lathe([(0.139, -0.015), (0.1405, -0.01), (0.1405, 0.01), (0.139, 0.015)], web, 36), (s * 0.12, 0, 0.125), "y", 90)
        for s in (-1, 1)
    ]
    for band in bands:
        x, y, z = band.vertices.T
        band.vertices = np.c_[x, y, np.where(z < 0.03, 0.4 * (z - 0.03) + 0.03, z)]
    zip_ = moved(block((0.44, 0.012, 0.004), cap, 0.001), (0, 0, 0.263))
    arch = spline([(-0.12, 0, 0.2), (-0.1, 0, 0.31), (0, 0, 0.335), (0.1, 0, 0.31), (0.12, 0, 0.2)], 26)
    loops = [moved(tube(arch, 0.008, web, 8), (0, s * 0.075, 0)) for s in (-1, 1)]
    return [body, *ends, *bands, zip_, *loops]


def rucksack() -> list[Mesh]:
    """A hiker's pack: flap, side pockets, a rolled mat on top."""
    cloth, flap, strap = (
        material(rough=0.9, image=fabric((86, 98, 58), (78, 90, 52), seed=85)),
        material(rough=0.9, image=fabric((62, 70, 44), (56, 64, 40), seed=86)),
        material("#5a3d26", 0.7),
    )
    body = moved(bulge((0.3, 0.2, 0.46), (0.3, 0.5), cloth, 36, 3.0), (0, 0, 0.23))
    lid = moved(bulge((0.32, 0.23, 0.13), (0.6, 0.5), flap, 30, 2.0), (0, -0.005, 0.44))
    sides = [moved(bulge((0.1, 0.14, 0.2), (0.5, 0.5), flap, 22, 2.0), (s * 0.155, 0, 0.13)) for s in (-1, 1)]
    pocket = moved(bulge((0.2, 0.09, 0.17), (0.5, 0.5), flap, 26, 2.0), (0, -0.1, 0.13))
    mat = moved(
        lathe([(0, -0.2), (0.05, -0.2), (0.055, -0.19), (0.055, 0.19), (0.05, 0.2), (0, 0.2)], material("#b8562c", 0.9), 28),
        (0, 0, 0.535),
        "y",
        90,
    )
    belts = [moved(block((0.025, 0.006, 0.2), strap, 0.002), (s * 0.07, -0.116, 0.34)) for s in (-1, 1)]
    ties = [
        moved(lathe([(0.0555, -0.012), (0.058, -0.01), (0.058, 0.01), (0.0555, 0.012)], strap, 28), (s * 0.09, 0, 0.535), "y", 90)
        for s in (-1, 1)
    ]
    buckles = [moved(block((0.032, 0.008, 0.024), STEEL, 0.002), (s * 0.07, -0.12, 0.28)) for s in (-1, 1)]
    arms = [tube(spline([(s, 0.08, 0.42), (s, 0.135, 0.34), (s, 0.14, 0.2), (s, 0.09, 0.06)], 20), 0.013, strap, 8) for s in (-0.08, 0.08)]
    return [body, lid, *sides, pocket, mat, *belts, *ties, *buckles, *arms]


def storage_basket() -> list[Mesh]:
    """An open rectangular basket of willow with a linen lining folded over its rim."""
    reed, linen = material(rough=0.9, image=wicker()), material(rough=0.95, image=fabric((228, 220, 204), (214, 206, 190), seed=87))
    x, y, z, t = 0.19, 0.13, 0.2, 0.014
    walls = [moved(block((2 * x, t, z), reed, 0.006, tile=0.1), (0, s * (y - t / 2), z / 2)) for s in (-1, 1)]
    walls += [moved(block((t, 2 * y - 2 * t, z), reed, 0.006, tile=0.1), (s * (x - t / 2), 0, z / 2)) for s in (-1, 1)]
    floor = moved(block((2 * x - t, 2 * y - t, 0.012), reed, 0.004, tile=0.1), (0, 0, 0.008))
    cloth = [moved(block((2 * x + 0.004, t + 0.006, 0.06), linen, 0.006, tile=0.2), (0, s * (y - t / 2), z - 0.026)) for s in (-1, 1)]
    cloth += [moved(block((t + 0.006, 2 * y - t, 0.06), linen, 0.006, tile=0.2), (s * (x - t / 2), 0, z - 0.026)) for s in (-1, 1)]
    arch = [(0, 0.05 * np.cos(a), 0.035 * np.sin(a)) for a in np.linspace(np.pi, 0, 16)]
    loops = [moved(tube(arch, 0.006, material("#7a4f28", 0.8), 8), (s * (x + 0.003), 0, z - 0.002)) for s in (-1, 1)]
    return [*walls, floor, *cloth, *loops]


def _banknote(ground: str, ink: str, worth: str) -> Image.Image:
    """One side of a note of no country."""
    image = Image.new("RGB", (300, 150), ground)
    draw = ImageDraw.Draw(image)
    for k in range(26):  # a guilloche, as notes have
        draw.ellipse([60 + 5 * k, 75 - 60, 180 + 5 * k, 75 + 60], outline=ink)
    draw.rectangle([6, 6, 293, 143], outline=ink, width=3)
    draw.ellipse([112, 32, 188, 118], fill=ground, outline=ink, width=3)
    for at, size in (((40, 28), 30), ((258, 120), 30), ((150, 75), 44)):
        draw.text(at, worth, fill=ink, font=ImageFont.load_default(size=size), anchor="mm")
    return image


def _bundle(ground: str, ink: str, worth: str) -> list[Mesh]:
    """A hundred notes in a paper band, lying."""
    w, d, t = 0.14, 0.07, 0.012
    edges = material("#dcdccb", 0.9)
    face = material(rough=0.85, image=_banknote(ground, ink, worth))
    stack = [moved(block((w, d, t), edges, 0.0015), (0, 0, t / 2)), moved(panel(w - 0.002, d - 0.002, face), (0, 0, t + 0.0002))]
    return [*stack, moved(block((0.03, d + 0.001, t + 0.0012), material("#efe9d6", 0.8), 0.001), (0, 0, t / 2))]


def money(ground: str = "#c9dcc4", ink: str = "#2c5b46", worth: str = "50", bundles: int = 1) -> list[Mesh]:
    """Bundles of banknotes: one, or a heap of several, crosswise."""
    parts = []
    for k in range(bundles):
        at = ((0, 0, 0), (0, 0.074, 0), (0.004, 0.036, 0.0132), (-0.01, 0.03, 0.0264))[k]
        parts += [moved(p, at, "z", (0, 3, -8, 24)[k]) for p in _bundle(ground, ink, worth)]
    return parts


def wooden_crate() -> list[Mesh]:
    """A fruit crate of slats, with a lid."""
    pine = material(rough=0.75, image=wood((166, 126, 78), (212, 176, 126), seed=89))
    dark = material("#6d5232", 0.9)
    x, y, z = 0.2, 0.14, 0.2
    parts = [moved(block((2 * x - 0.03, 2 * y - 0.03, z - 0.02), dark), (0, 0, z / 2))]
    for k in range(3):
        at = 0.034 + 0.062 * k
        parts += [moved(block((2 * x, 0.012, 0.052), pine, 0.002, tile=0.3), (0, s * (y - 0.006), at)) for s in (-1, 1)]
        parts += [moved(block((0.012, 2 * y - 0.024, 0.052), pine, 0.002, tile=0.3), (s * (x - 0.006), 0, at)) for s in (-1, 1)]
        parts.append(moved(block((2 * x, 0.085, 0.012), pine, 0.002, tile=0.3), (0, 0.092 * (k - 1), z)))
    parts += [
        moved(block((0.03, 0.008, z), pine, 0.002, tile=0.3), (sx * (x - 0.03), sy * (y + 0.002), z / 2))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    arch = [(0, 0.05 * np.cos(a), -0.035 * np.sin(a)) for a in np.linspace(np.pi, 0, 14)]
    return [*parts, *(moved(tube(arch, 0.005, material("#c9ae7a", 0.9), 8), (s * (x + 0.004), 0, 0.14)) for s in (-1, 1))]


def leather_case() -> list[Mesh]:
    """An old travelling case, upright, with corners, two straps and a grip."""
    hide, edge = material(rough=0.55, image=fabric((132, 82, 44), (124, 76, 40), seed=91)), material("#4e2e18", 0.5)
    brass = material("#b99450", 0.35, 0.7)
    w, d, h = 0.52, 0.17, 0.36
    parts = [
        moved(block((w, d, h), hide, 0.018, tile=0.25), (0, 0, h / 2)),
        moved(block((w + 0.004, 0.008, h + 0.004), edge, 0.003), (0, -0.03, h / 2)),
    ]
    parts += [moved(block((0.032, d + 0.008, h + 0.008), edge, 0.006), (s * 0.15, 0, h / 2)) for s in (-1, 1)]
    parts += [moved(block((0.05, 0.012, 0.04), brass, 0.003), (s * 0.15, -d / 2 - 0.004, 0.27)) for s in (-1, 1)]
    parts += [
        moved(block((0.05, d + 0.004, 0.05), edge, 0.018), (sx * (w / 2 - 0.022), 0, h / 2 + sz * (h / 2 - 0.022)))
        for sx in (-1, 1)
        for sz in (-1, 1)
    ]
    grip = tube(spline([(-0.07, 0, h), (-0.06, 0, h + 0.045), (0.06, 0, h + 0.045), (0.07, 0, h)], 20), 0.011, edge, 10)
    return [*parts, grip, *(moved(block((0.03, 0.02, 0.016), brass, 0.003), (s * 0.07, 0, h + 0.004)) for s in (-1, 1))]


def headphones(color: str = "#e6e2da", pad: str = "#3a3b3f") -> list[Mesh]:
    """Over-ear headphones, lying on their side: band in the plane of the floor."""
    shell, soft = material(color, 0.3), material(pad, 0.9)
    arc = np.array([(0.085 * np.cos(a), 0.095 * np.sin(a) + 0.02, 0.038) for a in np.linspace(np.pi, 0, 40)])
    band, cushion = tube(arc, 0.007, shell, 12), tube(arc[10:30] * (0.93, 0.93, 1), 0.011, soft, 12)
    parts = [band, cushion]
    for s in (-1, 1):
        parts.append(
            moved(
                lathe([(0, 0), (0.03, 0), (0.037, 0.006), (0.038, 0.014), (0.03, 0.02), (0, 0.02)], shell, 32),
                (s * 0.098, -0.01, 0.038),
                "y",
                -90 * s,
            )
        )
        parts.append(
            moved(
                lathe([(0, 0), (0.032, 0), (0.036, 0.007), (0.03, 0.018), (0.018, 0.018), (0.016, 0.012), (0, 0.012)], soft, 32),
                (s * 0.079, -0.01, 0.038),
                "y",
                -90 * s,
            )
        )
        parts.append(moved(disc(0.02, 0.002, STEEL, 0.0005, 28), (s * 0.0985, -0.01, 0.038), "y", 90 * s))
    return parts


def reflex_camera() -> list[Mesh]:
    """A camera with a long lens and a hump for the finder; it looks to -y."""
    body, grip = material("#26272a", 0.55), material("#141416", 0.85)
    case = [
        moved(block((0.13, 0.045, 0.085), body, 0.01, 2), (0, 0, 0.0425)),
        moved(block((0.038, 0.06, 0.085), grip, 0.012, 2), (-0.05, -0.01, 0.0425)),
        moved(block((0.05, 0.05, 0.03), body, 0.01), (0.008, -0.002, 0.094)),
        moved(block((0.03, 0.022, 0.008), DARK, 0.002), (0.008, 0.005, 0.11)),
    ]
    dials = [
        moved(disc(0.012, 0.01, DARK, 0.002, 24), (-0.045, 0, 0.083)),
        moved(disc(0.007, 0.006, STEEL, 0.001, 20), (-0.052, -0.025, 0.083)),
    ]
    lying = [(0.06, 0.01, 0.075), (0.09, 0.05, 0.02), (0.04, 0.085, 0.004)]
    strap = tube(spline([*lying, *((-x, y, z) for x, y, z in lying[::-1])], 40), 0.004, DARK, 8)
    return [*case, *dials, *_lens(body, grip), strap]


def _lens(body: PBRMaterial, grip: PBRMaterial) -> list[Mesh]:
    rings = [(0.034, 0.02, 0.02, body), (0.031, 0.035, 0.045, grip), (0.033, 0.06, 0.018, body), (0.035, 0.082, 0.02, body)]
    rings += [(0.0352, 0.079, 0.004, material("#b8862c", 0.4, 0.5)), (0.028, 0.1, 0.003, material("#1b2a3c", 0.05, 0.3))]
    return [moved(disc(radius, deep, of, 0.001, 36), (0.01, -start, 0.042), "x", 90) for radius, start, deep, of in rings]


def laptop(color: str = "#8e9399") -> list[Mesh]:
    """An open laptop with a picture on its screen; it faces -y."""
    shell, keys = material(color, 0.35, 0.4), material("#1c1d20", 0.6)
    base = moved(block((0.33, 0.23, 0.016), shell, 0.005), (0, 0, 0.008))
    well = moved(panel(0.29, 0.105, material("#2b2d31", 0.6)), (0, 0.035, 0.0163))
    caps = [
        moved(block((0.018, 0.016, 0.003), keys), (-0.133 + 0.0205 * i, -0.005 + 0.0205 * j, 0.0172)) for i in range(14) for j in range(5)
    ]
    pad = moved(panel(0.1, 0.06, material("#767b81", 0.3, 0.3)), (0, -0.065, 0.0163))
    lid = [moved(block((0.33, 0.22, 0.008), shell, 0.003), (0, 0.11, 0))]
    screen = label(480, 300, "#1d3a5c", "#eaf2fb", [("10:24", 0.2, 0.4), ("saturday, 21 november", 0.07, 0.6)], "#2c5f86")
    lid.append(moved(panel(0.318, 0.205, material("#0d0e10", 0.3)), (0, 0.11, 0.0042)))
    lid.append(moved(panel(0.3, 0.187, material(rough=0.2, image=screen)), (0, 0.112, 0.0045)))
    for part in lid:
        moved(part, (0, 0, 0), "x", 72)
        moved(part, (0, 0.113, 0.014))
    return [base, well, *caps, pad, *lid]


MAKERS: dict[str, Callable[..., list[Mesh]]] = {
    f.__name__: f
    for f in (
        tote_bag,
        sports_bag,
        rucksack,
        storage_basket,
        money,
        wooden_crate,
        leather_case,
        headphones,
        reflex_camera,
        laptop,
    )
}
