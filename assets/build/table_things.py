"""Food, crockery, toys, prizes and corks of our own. Metres."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from patterns import label, noise, picture, wood
from shapes import Mesh, block, bulge, disc, dressed, lathe, material, moved, panel, spline, tube

BLACK = material("#1c1d1f", 0.6)
GOLD = material("#d2a63c", 0.25, 0.8)


def bee(length: float = 0.03, toy: bool = False) -> list[Mesh]:
    """A bumblebee, magnified, or a fat one of felt; it looks to +x. Drawn 1.2 long, then scaled."""
    yellow, dark = material("#f2c53d" if toy else "#e8b020", 0.9), material("#4a3426" if toy else "#2a1c12", 0.9)
    wing, wide, n = material("#f6f3e8" if toy else "#e9eef2", 0.9 if toy else 0.3), 0.4 if toy else 0.3, 5 if toy else 9
    along, parts = np.linspace(0, np.pi, 4 * n + 1), []
    for k in range(n):  # rings of the body, dark and yellow in turn
        a = along[4 * k : 4 * k + 5]
        ring = np.c_[wide * np.sin(a).clip(0) ** 0.8, -0.5 * np.cos(a)]
        parts.append(moved(lathe(ring, (yellow, dark)[k % 2] if toy else (dark, yellow)[k % 2], 26), (0, 0, wide + 0.01), "y", 90))
    head, z = (0.42, 0.46, 0.42) if toy else (0.26, 0.32, 0.28), wide + 0.01
    parts.append(moved(bulge(head, (1, 1), yellow if toy else dark, 20), (0.5, 0, z)))
    for s in (-1, 1):
        parts.append(moved(bulge((0.05, 0.09, 0.11), (1, 1), BLACK, 10), (0.5 + 0.44 * head[0], s * 0.11, z + 0.06)))
        for x, size, turn in ((0.08, (0.3, 0.52, 0.04), 18), (-0.12, (0.22, 0.38, 0.04), -12)):
            flat = moved(bulge(size, (1, 1), wing, 18), (0, s * size[1] / 2, 0), "z", s * turn)
            parts.append(moved(flat, (x, s * 0.1, 2 * wide - 0.03), "x", s * (40 if toy else 16)))
        feeler = spline([(0.6, s * 0.06, z + 0.1), (0.68, s * 0.1, z + 0.26), (0.76, s * 0.12, z + 0.24)], 8)
        parts.append(tube(feeler, 0.02 if toy else 0.012, dark, 6))
        legs = [spline([(x, s * 0.22, 0.2), (x, s * 0.32, 0.14), (x - 0.03, s * 0.36, 0)], 8) for x in (-0.12, 0.06, 0.24)]
        parts += [] if toy else [tube(leg, 0.014, dark, 6) for leg in legs]
    for part in parts:
        part.apply_scale(length / 1.2)
    return parts


def cork(sparkling: bool = False) -> list[Mesh]:
    """A bottle's cork, standing; that of sparkling wine has a head."""
    bark = material(rough=0.95, image=wood((176, 134, 88), (214, 176, 130), size=128, seed=93))
    if sparkling:
        return [
            lathe(
                [
                    (0, 0),
                    (0.015, 0),
                    (0.0148, 0.004),
                    (0.0095, 0.022),
                    (0.0105, 0.026),
                    (0.0155, 0.03),
                    (0.0155, 0.044),
                    (0.012, 0.048),
                    (0, 0.048),
                ],
                bark,
                32,
            )
        ]
    ring = material("#6d1f2c", 0.9)
    return [
        lathe([(0, 0), (0.0112, 0), (0.012, 0.001), (0.012, 0.044), (0.0112, 0.045), (0, 0.045)], bark, 28),
        lathe([(0.01205, 0.0), (0.01205, 0.007)], ring, 28),
    ]


def trophy(of_star: bool = False) -> list[Mesh]:
    """A cup with two handles, or a star on a column, each on a dark foot with a plate."""
    stone = material("#2a211c", 0.25)
    words = label(200, 80, "#d8b658", "#3a2a10", [("CHAMPION", 0.4, 0.5)])
    plate = moved(panel(0.05, 0.02, material(rough=0.3, image=words)), (0, -0.0405, 0.025), "x", 90)
    foot = [moved(block((0.08, 0.08, 0.05), stone, 0.003), (0, 0, 0.025)), plate]
    if of_star:
        column = [(0, 0.05), (0.026, 0.05), (0.02, 0.06), (0.014, 0.16), (0.02, 0.168), (0, 0.17)]
        return [*foot, lathe(column, GOLD, 28), moved(_star(0.06, 0.02), (0, 0, 0.213))]
    stem = [(0, 0.05), (0.03, 0.05), (0.026, 0.056), (0.009, 0.075), (0.008, 0.1), (0.016, 0.112)]
    outside = spline([(0.03, 0.125), (0.058, 0.17), (0.066, 0.24)], 12)
    inside = spline([(0.06, 0.235), (0.05, 0.17), (0.02, 0.135)], 10)
    cup = lathe([*stem, *outside, (0.07, 0.247), (0.064, 0.247), *inside, (0, 0.13)], GOLD, 40)
    curve = np.array([(0.062, 0, 0.23), (0.098, 0, 0.232), (0.1, 0, 0.18), (0.05, 0, 0.145)])
    return [*foot, cup, *(tube(spline(curve * (s, 1, 1), 24), 0.005, GOLD, 10) for s in (-1, 1))]


def _star(radius: float, thick: float) -> Mesh:
    """Five points, upright, pitched like a roof on both sides."""
    angle = np.pi / 2 + np.arange(10) * np.pi / 5
    r = np.where(np.arange(10) % 2, 0.42, 1.0) * radius
    rim = np.c_[r * np.cos(angle), np.zeros(10), r * np.sin(angle)]
    vertices = np.vstack([rim, [[0, -thick / 2, 0], [0, thick / 2, 0]]])
    faces = [f for k in range(10) for f in ([k, (k + 1) % 10, 10], [(k + 1) % 10, k, 11])]
    mesh = Mesh(vertices, faces, process=False)
    mesh.fix_normals()
    mesh.unmerge_vertices()
    return dressed(mesh, GOLD)


def bell_pepper(color: str = "#b81d16") -> list[Mesh]:
    """Four lobes and a green stalk."""
    body = bulge((0.08, 0.08, 0.085), (0.75, 1.0), material(color, 0.2), 40)
    x, y, z = body.vertices.T
    lobes = 1 + 0.1 * np.cos(4 * np.arctan2(y, x)) * np.clip(np.hypot(x, y) / 0.03, 0, 1)
    taper = 1 - 2.0 * np.clip(-z, 0, None)
    dent = 0.012 * np.exp(-((np.hypot(x, y) / 0.014) ** 2)) * np.sign(z)
    body.vertices = np.c_[x * lobes * taper, y * lobes * taper, z - dent]
    stalk = tube(
        spline([(0, 0, 0.06), (0.001, 0, 0.078), (0.006, 0, 0.094)], 10), np.linspace(0.009, 0.005, 10), material("#4c7a2c", 0.7), 12
    )
    return [moved(body, (0, 0, 0.0425)), stalk]


def chilli(color: str = "#2f7a2a") -> list[Mesh]:
    """A long pepper, lying bent."""
    path = spline([(0.075, 0.012, 0.012), (0.03, -0.003, 0.014), (-0.03, -0.004, 0.012), (-0.085, 0.018, 0.006)], 30)
    body = tube(
        path, np.interp(np.linspace(0, 1, 30), [0, 0.06, 0.3, 0.8, 1], [0.006, 0.012, 0.0135, 0.007, 0.001]), material(color, 0.2), 18
    )
    stalk = tube(
        spline([(0.073, 0.012, 0.012), (0.088, 0.018, 0.013), (0.104, 0.028, 0.016)], 8),
        np.linspace(0.006, 0.003, 8),
        material("#6d8a3c", 0.7),
        10,
    )
    return [body, stalk]


def double_burger() -> list[Mesh]:
    """Two patties, cheese, salad, tomato, a bun with seeds."""
    crust, meat = material("#c07f36", 0.55), material("#4a2a18", 0.8)
    parts = [lathe([(0, 0), (0.046, 0), (0.05, 0.006), (0.049, 0.018), (0, 0.018)], crust, 36)]
    angle = np.linspace(0, 2 * np.pi, 60)
    for z, salad in ((0.018, True), (0.045, False)):
        parts.append(moved(lathe([(0, 0), (0.049, 0), (0.052, 0.006), (0.049, 0.014), (0, 0.014)], meat, 34), (0, 0, z)))
        parts.append(moved(block((0.092, 0.092, 0.003), material("#f0b429", 0.4), 0.001), (0, 0, z + 0.0155), "z", 30 if salad else 75))
        if salad:
            leaf = np.c_[
                (0.051 + 0.004 * np.sin(9 * angle)) * np.cos(angle),
                (0.051 + 0.004 * np.sin(7 * angle)) * np.sin(angle),
                z + 0.02 + 0.002 * np.sin(11 * angle),
            ]
            parts.append(tube(leaf, 0.0035, material("#6fa032", 0.6), 6))
            parts.append(moved(disc(0.046, 0.007, material("#c3402c", 0.35), 0.002, 32), (0, 0, z + 0.018)))
    top = spline([(0.05, 0.0), (0.052, 0.008), (0.04, 0.028), (0.02, 0.036), (0.0, 0.038)], 14)
    parts.append(moved(lathe([(0, 0), *top], crust, 38), (0, 0, 0.062)))
    rng = np.random.default_rng(95)
    for r, a in zip(0.038 * np.sqrt(rng.random(36)), rng.random(36) * 2 * np.pi, strict=True):
        height = 0.062 + np.interp(r, top[::-1, 0], top[::-1, 1])
        parts.append(
            moved(
                bulge((0.0045, 0.0028, 0.002), (1, 1), material("#f2e3b8", 0.6), 6),
                (r * np.cos(a), r * np.sin(a), height),
                "z",
                np.degrees(a),
            )
        )
    return parts


def half_orange() -> list[Mesh]:
    """Cut in two: the segments show above."""
    size = 256
    y, x = np.mgrid[0:size, 0:size] / (size / 2) - 1
    r, a = np.hypot(x, y), np.arctan2(y, x)
    art = np.where(
        (r < 0.86)[..., None], np.array([244, 150, 36]) * (0.85 + 0.25 * noise(size, 99, 5, 16))[..., None], np.array([250, 226, 176])
    )
    wall = (np.abs(((a / (2 * np.pi) * 10) % 1) - 0.5) > 0.46) | (r < 0.1)
    art = np.where((wall & (r < 0.86))[..., None], np.array([250, 214, 150]), art)
    art = np.where((r > 0.95)[..., None], np.array([232, 128, 22]), art)
    peel = lathe([(0, 0), *spline([(0.012, 0.001), (0.03, 0.012), (0.0385, 0.03), (0.039, 0.038)], 12)], material("#e07f17", 0.5), 36)
    face = lathe([(0.039, 0.038), (0, 0.0385)], material(rough=0.35, image=picture(art)), 36)
    face.visual.uv = face.vertices[:, :2] / 0.078 + 0.5
    return [peel, face]


def enamel_mug() -> list[Mesh]:
    """White, with a blue rim and a blue ear."""
    white, blue = material("#eef0f0", 0.25), material("#1f3f86", 0.3)
    body = lathe([(0, 0), (0.038, 0), (0.04, 0.003), (0.04, 0.078), (0.0375, 0.078), (0.0375, 0.006), (0, 0.006)], white, 40)
    rim = lathe([(0.0372, 0.077), (0.0385, 0.0805), (0.0412, 0.0805), (0.0408, 0.076)], blue, 40)
    ear = tube(spline([(0.039, 0, 0.066), (0.066, 0, 0.064), (0.068, 0, 0.03), (0.039, 0, 0.018)], 24), 0.0038, blue, 10)
    return [body, rim, ear]


def dinner_plate(ground: str = "#e9e4d6", rim: str = "#27476e") -> list[Mesh]:
    """Stoneware with a coloured rim."""
    clay, glaze = material(ground, 0.3), material(rim, 0.3)
    inside = [(0.123, 0.0235), (0.098, 0.0155), (0.084, 0.0075), (0, 0.0065)]
    body = lathe([(0, 0.002), (0.06, 0.002), (0.062, 0), (0.066, 0), (0.069, 0.003), (0.1, 0.011), (0.131, 0.0215)], clay, 48)
    return [body, lathe([(0.131, 0.0215), (0.1325, 0.0235), (0.131, 0.0255), (0.123, 0.0235)], glaze, 48), lathe(inside, clay, 48)]


def sitting_bear(fur: str = "#efe3cc", inner: str = "#c99a72") -> list[Mesh]:
    """A plush bear with a bow, sitting; it faces -y."""
    plush, soft, dark, bow = material(fur, 1.0), material(inner, 1.0), material("#20150f", 0.3), material("#b3342e", 0.7)
    parts = [
        moved(bulge((0.15, 0.13, 0.17), (0.9, 1), plush, 30), (0, 0, 0.09)),
        moved(bulge((0.095, 0.03, 0.1), (1, 1), soft, 20), (0, -0.053, 0.085)),
    ]
    parts += [
        moved(bulge((0.14, 0.125, 0.12), (0.95, 1), plush, 30), (0, -0.005, 0.215)),
        moved(bulge((0.062, 0.05, 0.045), (1, 1), soft, 20), (0, -0.062, 0.2)),
    ]
    parts.append(moved(bulge((0.022, 0.016, 0.015), (1, 1), dark, 12), (0, -0.086, 0.211)))
    for s in (-1, 1):
        parts.append(moved(bulge((0.052, 0.03, 0.052), (1, 1), plush, 18), (s * 0.055, 0, 0.268)))
        parts.append(moved(bulge((0.03, 0.02, 0.03), (1, 1), soft, 14), (s * 0.055, -0.009, 0.268)))
        parts.append(moved(bulge((0.014, 0.01, 0.015), (1, 1), dark, 10), (s * 0.03, -0.061, 0.232)))
        parts.append(moved(moved(bulge((0.05, 0.055, 0.125), (1, 1), plush, 20), (0, 0, 0), "y", -s * 28), (s * 0.088, -0.02, 0.115)))
        parts.append(moved(bulge((0.066, 0.13, 0.062), (0.9, 1), plush, 20), (s * 0.062, -0.085, 0.031)))
        parts.append(moved(bulge((0.046, 0.012, 0.046), (1, 1), soft, 16), (s * 0.062, -0.148, 0.032)))
        parts.append(moved(moved(bulge((0.055, 0.02, 0.034), (0.9, 1), bow, 16), (s * 0.026, 0, 0), "y", s * 12), (0, -0.063, 0.163)))
    return [*parts, moved(bulge((0.018, 0.022, 0.02), (1, 1), bow, 12), (0, -0.068, 0.163))]


MAKERS: dict[str, Callable[..., list[Mesh]]] = {
    f.__name__: f
    for f in (
        bee,
        cork,
        trophy,
        bell_pepper,
        chilli,
        double_burger,
        half_orange,
        enamel_mug,
        dinner_plate,
        sitting_bear,
    )
}
