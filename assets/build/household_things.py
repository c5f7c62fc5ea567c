"""Tools, prizes, crockery, food and machines of our own. Metres."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from patterns import label, wood
from shapes import Mesh, block, bulge, cut, disc, lathe, material, moved, panel, spline, tube

STEEL = material("#a4a6ab", 0.3, 0.8)
IRON = material("#4b4d51", 0.4, 0.7)
BLACK = material("#1c1d1f", 0.6)
GOLD = material("#d2a63c", 0.25, 0.8)
BRASS = material("#b99450", 0.35, 0.7)


def bee(length: float = 0.03, toy: bool = False) -> list[Mesh]:
    """A bumblebee, much magnified in the toy: striped body, head, wings; it looks to +x."""
    yellow, dark = material("#e8b020", 0.9), material("#2a1c12", 0.9)
    wing = material("#e9eef2" if not toy else "#f6f3e8", 0.3)
    n = 9
    u = np.linspace(0, np.pi, 4 * n + 1)
    parts = []
    for k in range(n):  # rings of the body, dark and yellow in turn
        a = u[4 * k : 4 * k + 5]
        ring = np.c_[0.3 * np.sin(a).clip(0) ** 0.8, -0.5 * np.cos(a)]
        parts.append(moved(lathe(ring, (dark, yellow)[k % 2], 22), (0, 0, 0.31), "y", 90))
    parts.append(moved(bulge((0.26, 0.32, 0.28), (1, 1), dark, 18), (0.52, 0, 0.31)))
    parts += [moved(bulge((0.06, 0.09, 0.11), (1, 1), BLACK, 10), (0.6, s * 0.11, 0.35)) for s in (-1, 1)]
    for s in (-1, 1):
        for x, size, turn in ((0.08, (0.3, 0.52, 0.02), 18), (-0.12, (0.22, 0.38, 0.02), -12)):
            parts.append(moved(moved(bulge(size, (1, 1), wing, 18), (0, s * size[1] / 2, 0), "z", s * turn), (x, s * 0.1, 0.57), "x", s * 16))
        parts.append(tube(spline([(0.6, s * 0.06, 0.42), (0.68, s * 0.1, 0.5), (0.76, s * 0.12, 0.48)], 8), 0.012, dark, 6))
        for x in (-0.12, 0.06, 0.24):
            parts.append(tube(spline([(x, s * 0.22, 0.2), (x, s * 0.32, 0.14), (x - 0.03, s * 0.36, 0)], 8), 0.014, dark, 6))
    for part in parts:
        part.apply_scale(length / 1.2)
    return parts


def cork(sparkling: bool = False) -> list[Mesh]:
    """A bottle's cork, standing; that of sparkling wine has a head."""
    bark = material(rough=0.95, image=wood((176, 134, 88), (214, 176, 130), size=128, seed=93))
    if sparkling:
        return [lathe([(0, 0), (0.015, 0), (0.0148, 0.004), (0.0095, 0.022), (0.0105, 0.026), (0.0155, 0.03), (0.0155, 0.044), (0.012, 0.048), (0, 0.048)], bark, 32)]
    ring = material("#6d1f2c", 0.9)
    return [
        lathe([(0, 0), (0.0112, 0), (0.012, 0.001), (0.012, 0.044), (0.0112, 0.045), (0, 0.045)], bark, 28),
        lathe([(0.01205, 0.0), (0.01205, 0.007)], ring, 28),
    ]


def moka_pot() -> list[Mesh]:
    """An eight-sided pot for the stove."""
    alu, grip = material("#b4b6ba", 0.35, 0.6), material("#18191b", 0.5)
    low = lathe([(0, 0), (0.05, 0), (0.052, 0.004), (0.041, 0.075), (0, 0.075)], alu, 8)
    ring = lathe([(0, 0.074), (0.042, 0.074), (0.043, 0.08), (0.042, 0.088), (0, 0.088)], alu, 36)
    high = lathe([(0, 0.087), (0.04, 0.087), (0.052, 0.165), (0, 0.165)], alu, 8)
    lid = lathe([(0.053, 0.165), (0.053, 0.169), (0.03, 0.18), (0.008, 0.186), (0, 0.186)], alu, 8)
    knob = moved(lathe([(0.006, 0), (0.012, 0.008), (0.01, 0.016), (0, 0.018)], grip, 20), (0, 0, 0.184))
    beak = moved(block((0.03, 0.022, 0.03), alu, 0.006), (-0.05, 0, 0.152), "y", -25)
    arm = tube(spline([(0.045, 0, 0.158), (0.085, 0, 0.16), (0.098, 0, 0.14), (0.092, 0, 0.09)], 20), [0.008] * 8 + [0.01] * 12, grip, 10)
    return [low, ring, high, lid, knob, beak, arm]


def extinguisher() -> list[Mesh]:
    """A carbon dioxide extinguisher: slim steel bottle with a black horn."""
    red, text = material("#b3201c", 0.3), label(512, 256, "#f2f0e8", "#8b1512", [("CO2", 0.34, 0.3), ("2 kg  -  class B", 0.13, 0.62), ("pull, aim, squeeze", 0.1, 0.84)])
    body = lathe([(0, 0), (0.054, 0), (0.058, 0.006), *spline([(0.058, 0.3), (0.055, 0.36), (0.03, 0.42), (0.018, 0.44)], 14), (0, 0.44)], red, 36)
    paper = lathe([(0.0584, 0.13), (0.0584, 0.25)], material(rough=0.6, image=text), 36)
    valve = [moved(disc(0.019, 0.04, BRASS, 0.003, 24), (0, 0, 0.435)), moved(block((0.05, 0.022, 0.02), IRON, 0.004), (-0.005, 0, 0.478))]
    levers = [moved(block((0.13, 0.018, 0.006), IRON, 0.002), (0.04, 0, z), "y", a) for z, a in ((0.487, 0), (0.508, -12))]
    hose = tube(spline([(-0.03, 0, 0.475), (-0.075, 0, 0.45), (-0.088, 0, 0.38)], 14), 0.008, BLACK, 10)
    horn = moved(lathe([(0.012, 0.16), (0.015, 0.15), (0.036, 0.0), (0.033, 0.0), (0.011, 0.14)], BLACK, 28), (-0.088, 0, 0.225))
    gauge = moved(disc(0.013, 0.008, STEEL, 0.002, 24), (0, -0.02, 0.458), "x", 90)
    return [body, paper, *valve, *levers, hose, horn, gauge]


def pliers(grip: str = "#b8281f") -> list[Mesh]:
    """Combination pliers, lying, jaws to +x."""
    rubber, parts = material(grip, 0.6), []
    for s in (-1, 1):
        shank = spline([(0.0, -s * 0.004, 0.009), (-0.03, s * 0.013, 0.009), (-0.07, s * 0.026, 0.009), (-0.13, s * 0.023, 0.009)], 24)
        parts.append(tube(shank[:8], 0.0055, STEEL, 10))
        parts.append(tube(shank[6:], np.interp(np.arange(18), [0, 2, 9, 15, 17], [0.007, 0.0085, 0.0085, 0.0085, 0.005]), rubber, 12))
        jaw = moved(block((0.052, 0.0105, 0.011), STEEL, 0.002), (0.032, s * 0.0062, 0.009), "z", -s * 5)
        parts.append(jaw)
        parts += [moved(block((0.0016, 0.002, 0.0112), IRON), (0.036 + 0.0035 * k, s * 0.0012, 0.009)) for k in range(5)]
    parts.append(moved(lathe([(0, 0), (0.013, 0), (0.014, 0.002), (0.014, 0.011), (0.013, 0.013), (0, 0.013)], STEEL, 30), (0, 0, 0.0025)))
    parts.append(moved(disc(0.006, 0.015, IRON, 0.001, 20), (0, 0, 0.002)))
    return parts


def roller_skate() -> list[Mesh]:
    """A high boot on a plate with four wheels and a stopper; its toe is at -y."""
    hide, sole, wheel = material("#f0eee8", 0.45), material("#2c2d31", 0.6), material("#e0567a", 0.35)
    foot = moved(bulge((0.088, 0.25, 0.1), (0.75, 0.75), hide, 34), (0, -0.01, 0.135))
    toe = moved(bulge((0.09, 0.11, 0.075), (0.8, 0.9), hide, 26), (0, -0.085, 0.125))
    shaft = moved(lathe([(0, 0), (0.046, 0), (0.044, 0.06), (0.05, 0.14), (0.047, 0.145), (0.038, 0.13), (0, 0.12)], hide, 34), (0, 0.058, 0.135))
    shaft.vertices[:, 1] = 0.058 + (shaft.vertices[:, 1] - 0.058) * 1.15
    lining = moved(disc(0.04, 0.004, material("#d1a5b0", 0.9), sides=30), (0, 0.058, 0.262))
    base = moved(block((0.082, 0.25, 0.018), sole, 0.007), (0, -0.01, 0.088))
    heel = moved(block((0.072, 0.075, 0.024), sole, 0.006), (0, 0.075, 0.098))
    plate = moved(block((0.05, 0.24, 0.012), STEEL, 0.003), (0, -0.01, 0.074))
    parts = [foot, toe, shaft, lining, base, heel, plate]
    for y in (-0.085, 0.075):
        parts.append(moved(block((0.03, 0.03, 0.045), STEEL, 0.006), (0, y, 0.055)))
        parts.append(moved(disc(0.005, 0.13, IRON, 0.0, 12), (-0.065, y, 0.031), "y", 90))
        for s in (-1, 1):
            parts.append(moved(lathe([(0, 0), (0.022, 0), (0.031, 0.005), (0.031, 0.029), (0.022, 0.034), (0, 0.034)], wheel, 30), (s * 0.043 - 0.017, y, 0.031), "y", 90))
            parts.append(moved(disc(0.01, 0.037, STEEL, 0.001, 18), (s * 0.043 - 0.0185, y, 0.031), "y", 90))
    parts.append(moved(lathe([(0, 0), (0.02, 0), (0.023, 0.008), (0.014, 0.03), (0, 0.03)], wheel, 24), (0, -0.128, 0.038), "x", -20))
    for k in range(6):
        y, z = -0.06 + 0.014 * k, 0.182 + 0.014 * k if k < 3 else 0.19 + 0.017 * k
        parts.append(moved(tube([(-0.026, 0, 0), (0, -0.006, 0.004), (0.026, 0, 0)], 0.0032, material("#c94f74", 0.8), 8), (0, min(y, 0.0) - 0.002, z)))
    return parts


def canister_vacuum(color: str = "#8f1f2a") -> list[Mesh]:
    """A vacuum cleaner on two large wheels, its tube standing behind it; it faces -y."""
    shell, dark = material(color, 0.25), material("#2a2c30", 0.5)
    body = moved(bulge((0.27, 0.38, 0.24), (0.75, 0.65), shell, 40), (0, 0, 0.14))
    skirt = moved(bulge((0.285, 0.39, 0.1), (0.5, 0.65), dark, 36), (0, 0, 0.085))
    wheels = [moved(lathe([(0, 0), (0.055, 0), (0.075, 0.008), (0.075, 0.028), (0.055, 0.036), (0, 0.036)], dark, 32), (s * 0.14 - 0.018, 0.1, 0.075), "y", 90) for s in (-1, 1)]
    hubs = [moved(disc(0.045, 0.004, STEEL, 0.001, 28), (s * 0.159 - 0.002, 0.1, 0.075), "y", 90) for s in (-1, 1)]
    castor = moved(disc(0.025, 0.03, dark, 0.004, 22), (-0.015, -0.13, 0.025), "y", 90)
    button = moved(disc(0.022, 0.012, STEEL, 0.003, 26), (0, 0.06, 0.25))
    grip = tube(spline([(0, -0.03, 0.255), (0, -0.01, 0.3), (0, 0.1, 0.3), (0, 0.135, 0.235)], 20), 0.012, dark, 10)
    port = moved(disc(0.03, 0.04, dark, 0.004, 28), (0, -0.16, 0.165), "x", 65)
    hose = tube(
        spline([(0, -0.185, 0.18), (0.03, -0.29, 0.3), (0.15, -0.3, 0.42), (0.2, -0.1, 0.52), (0.2, 0.1, 0.62)], 60), 0.019 + 0.0025 * (np.arange(60) % 2), material("#55585e", 0.6), 12
    )
    pipe = tube([(0.2, 0.08, 0.63), (0.2, 0.14, 0.36), (0.2, 0.2, 0.05)], 0.016, STEEL, 16)
    head = moved(block((0.27, 0.1, 0.05), dark, 0.015), (0.2, 0.2, 0.025))
    neck = moved(disc(0.022, 0.06, dark, 0.003, 24), (0.2, 0.195, 0.04))
    handle = tube(spline([(0.2, 0.085, 0.6), (0.2, 0.04, 0.66), (0.2, -0.03, 0.69)], 12), 0.017, dark, 12)
    return [body, skirt, *wheels, *hubs, castor, button, grip, port, hose, pipe, head, neck, handle]


def robot_vacuum() -> list[Mesh]:
    """A flat round cleaner."""
    dark, grey = material("#2b2d31", 0.35), material("#55585e", 0.3)
    body = lathe([(0, 0.006), (0.15, 0.006), (0.163, 0.014), (0.165, 0.05), (0.16, 0.07), (0.15, 0.076), (0, 0.076)], dark, 56)
    bumper = lathe([(0.1655, 0.018), (0.168, 0.022), (0.168, 0.048), (0.1655, 0.052)], grey, 56)
    top = moved(disc(0.125, 0.004, material("#d7d9dc", 0.25), 0.001, 56), (0, 0, 0.075))
    turret = moved(disc(0.042, 0.022, dark, 0.004, 40), (0, 0.03, 0.077))
    button = moved(disc(0.016, 0.004, material("#3aa6d8", 0.3), 0.001, 28), (0, -0.07, 0.078))
    wheels = [moved(disc(0.03, 0.022, BLACK, 0.004, 26), (s * 0.11 - 0.011, 0, 0.03), "y", 90) for s in (-1, 1)]
    brush = [moved(tube([(0, 0, 0), (0.03, 0, 0), (0.062, 0, 0)], 0.0018, material("#c9c13c", 0.8), 6), (0.1, -0.11, 0.009), "z", -60 + 120 * k) for k in range(3)]
    return [body, bumper, top, turret, button, *wheels, *brush]


def trophy(of_star: bool = False) -> list[Mesh]:
    """A cup with two handles, or a star on a column, each on a dark foot with a plate."""
    stone = material("#2a211c", 0.25)
    plate = moved(panel(0.05, 0.02, material(rough=0.3, image=label(200, 80, "#d8b658", "#3a2a10", [("CHAMPION", 0.4, 0.5)]))), (0, -0.0405, 0.025), "x", 90)
    base = moved(block((0.08, 0.08, 0.05), stone, 0.003), (0, 0, 0.025))
    if of_star:
        column = lathe([(0, 0.05), (0.026, 0.05), (0.02, 0.06), (0.014, 0.16), (0.02, 0.168), (0, 0.17)], GOLD, 28)
        return [base, plate, column, moved(_star(0.06, 0.02), (0, 0, 0.222))]
    cup = lathe([(0, 0.05), (0.03, 0.05), (0.026, 0.056), (0.009, 0.075), (0.008, 0.1), (0.016, 0.112), *spline([(0.03, 0.125), (0.058, 0.17), (0.066, 0.24)], 12), (0.07, 0.247), (0.064, 0.247), *spline([(0.06, 0.235), (0.05, 0.17), (0.02, 0.135)], 10), (0, 0.13)], GOLD, 40)
    ears = [tube(spline([(s * 0.062, 0, 0.23), (s * 0.098, 0, 0.232), (s * 0.1, 0, 0.18), (s * 0.05, 0, 0.145)], 24), 0.005, GOLD, 10) for s in (-1, 1)]
    return [base, plate, cup, *ears]


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
    made = bulge((1, 1, 1), (1, 1), GOLD, 4)
    made.visual.uv = None
    mesh.visual = type(made.visual)(uv=np.zeros((len(mesh.vertices), 2)), material=GOLD)
    return mesh


def bell_pepper(color: str = "#b81d16") -> list[Mesh]:
    """Four lobes and a green stalk."""
    body = bulge((0.08, 0.08, 0.085), (0.75, 1.0), material(color, 0.2), 40)
    x, y, z = body.vertices.T
    lobes = 1 + 0.1 * np.cos(4 * np.arctan2(y, x)) * np.clip(np.hypot(x, y) / 0.03, 0, 1)
    taper = 1 - 2.0 * np.clip(-z, 0, None)
    dent = 0.012 * np.exp(-(np.hypot(x, y) / 0.014) ** 2) * np.sign(z)
    body.vertices = np.c_[x * lobes * taper, y * lobes * taper, z - dent]
    stalk = tube(spline([(0, 0, 0.06), (0.001, 0, 0.078), (0.006, 0, 0.094)], 10), np.linspace(0.009, 0.005, 10), material("#4c7a2c", 0.7), 12)
    return [moved(body, (0, 0, 0.0425)), stalk]


def chilli(color: str = "#2f7a2a") -> list[Mesh]:
    """A long pepper, lying bent."""
    path = spline([(0.075, 0.012, 0.012), (0.03, -0.003, 0.014), (-0.03, -0.004, 0.012), (-0.085, 0.018, 0.006)], 30)
    body = tube(path, np.interp(np.linspace(0, 1, 30), [0, 0.06, 0.3, 0.8, 1], [0.006, 0.012, 0.0135, 0.007, 0.001]), material(color, 0.2), 18)
    stalk = tube(spline([(0.073, 0.012, 0.012), (0.088, 0.018, 0.013), (0.104, 0.028, 0.016)], 8), np.linspace(0.006, 0.003, 8), material("#6d8a3c", 0.7), 10)
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
            leaf = np.c_[(0.051 + 0.004 * np.sin(9 * angle)) * np.cos(angle), (0.051 + 0.004 * np.sin(7 * angle)) * np.sin(angle), z + 0.02 + 0.002 * np.sin(11 * angle)]
            parts.append(tube(leaf, 0.0035, material("#6fa032", 0.6), 6))
            parts.append(moved(disc(0.046, 0.007, material("#c3402c", 0.35), 0.002, 32), (0, 0, z + 0.018)))
    top = spline([(0.05, 0.0), (0.052, 0.008), (0.04, 0.028), (0.02, 0.036), (0.0, 0.038)], 14)
    parts.append(moved(lathe([(0, 0), *top], crust, 38), (0, 0, 0.062)))
    rng = np.random.default_rng(95)
    for r, a in zip(0.038 * np.sqrt(rng.random(36)), rng.random(36) * 2 * np.pi, strict=True):
        height = 0.062 + np.interp(r, top[::-1, 0], top[::-1, 1])
        parts.append(moved(bulge((0.0045, 0.0028, 0.002), (1, 1), material("#f2e3b8", 0.6), 6), (r * np.cos(a), r * np.sin(a), height), "z", np.degrees(a)))
    return parts


def enamel_mug() -> list[Mesh]:
    white, blue = material("#eef0f0", 0.25), material("#1f3f86", 0.3)
    body = lathe([(0, 0), (0.038, 0), (0.04, 0.003), (0.04, 0.078), (0.0375, 0.078), (0.0375, 0.006), (0, 0.006)], white, 40)
    rim = lathe([(0.0372, 0.077), (0.0385, 0.0805), (0.0412, 0.0805), (0.0408, 0.076)], blue, 40)
    ear = tube(spline([(0.039, 0, 0.066), (0.066, 0, 0.064), (0.068, 0, 0.03), (0.039, 0, 0.018)], 24), 0.0038, blue, 10)
    return [body, rim, ear]


def sitting_bear(fur: str = "#efe3cc", inner: str = "#c99a72") -> list[Mesh]:
    """A plush bear with a bow, sitting; it faces -y."""
    plush, soft, dark, bow = material(fur, 1.0), material(inner, 1.0), material("#20150f", 0.3), material("#b3342e", 0.7)
    parts = [moved(bulge((0.15, 0.13, 0.17), (0.9, 1), plush, 30), (0, 0, 0.09)), moved(bulge((0.095, 0.03, 0.1), (1, 1), soft, 20), (0, -0.053, 0.085))]
    parts += [moved(bulge((0.14, 0.125, 0.12), (0.95, 1), plush, 30), (0, -0.005, 0.215)), moved(bulge((0.062, 0.05, 0.045), (1, 1), soft, 20), (0, -0.062, 0.2))]
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


def mallet() -> list[Mesh]:
    """A rubber mallet, lying, with an ash handle."""
    ash, rubber = material(rough=0.6, image=wood((178, 138, 90), (216, 182, 134), size=128, seed=97)), material("#1f2022", 0.8)
    handle = tube([(0, 0.0, 0.032), (0, -0.1, 0.032), (0, -0.2, 0.03), (0, -0.3, 0.03)], [0.012, 0.011, 0.014, 0.015], ash, 16)
    head = moved(lathe([(0, -0.055), (0.028, -0.055), (0.032, -0.05), (0.03, 0), (0.032, 0.05), (0.028, 0.055), (0, 0.055)], rubber, 32), (0, 0.012, 0.032), "y", 90)
    return [handle, head, moved(disc(0.012, 0.004, ash, sides=16), (0, 0.0455, 0.032), "x", 90)]


def torch() -> list[Mesh]:
    """A slim aluminium torch, lying, lens to +x."""
    alu, rubber, lens = material("#34506e", 0.35, 0.6), material("#1c1d20", 0.7), material("#f4f1da", 0.1)
    body = lathe(
        [(0, 0), (0.012, 0), (0.0135, 0.002), (0.0135, 0.014), (0.0125, 0.016), (0.0125, 0.1), (0.0135, 0.105), (0.0185, 0.125), (0.0195, 0.127), (0.0195, 0.15), (0.018, 0.152), (0.0165, 0.149)],
        alu,
        32,
    )
    glass = lathe([(0.0168, 0.149), (0, 0.1495)], lens, 28)
    knurl = [lathe([(0.01255, z), (0.0133, z + 0.001), (0.0133, z + 0.003), (0.01255, z + 0.004)], rubber, 28) for z in np.arange(0.024, 0.09, 0.0075)]
    switch = moved(block((0.009, 0.003, 0.016), rubber, 0.001), (0, -0.0135, 0.094))
    return [moved(p, (0, 0, 0.0195), "y", 90) for p in (body, glass, *knurl, switch)]


def dinner_plate(ground: str = "#e9e4d6", rim: str = "#27476e") -> list[Mesh]:
    """Stoneware with a coloured rim."""
    clay, glaze = material(ground, 0.3), material(rim, 0.3)
    inside = [(0.123, 0.0235), (0.098, 0.0155), (0.084, 0.0075), (0, 0.0065)]
    body = lathe([(0, 0.002), (0.06, 0.002), (0.062, 0), (0.066, 0), (0.069, 0.003), (0.1, 0.011), (0.131, 0.0215)], clay, 48)
    return [body, lathe([(0.131, 0.0215), (0.1325, 0.0235), (0.131, 0.0255), (0.123, 0.0235)], glaze, 48), lathe(inside, clay, 48)]


def kitchen_shears() -> list[Mesh]:
    """Steel scissors with black rings, lying, points to +x."""
    black, parts = material("#26282c", 0.6), []
    for s in (-1, 1):
        blade = moved(block((0.11, 0.014, 0.0025), STEEL, 0.0008), (0.055, s * 0.004, 0.0055 + 0.0013 * s), "z", s * 5)
        cut_off = blade.vertices
        tip = np.clip((cut_off[:, 0] - 0.03) / 0.08, 0, 1)
        cut_off[:, 1] -= (cut_off[:, 1] - s * 0.008) * 0.85 * tip
        blade.vertices = cut_off
        parts.append(blade)
        parts.append(tube(spline([(0.005, -s * 0.003, 0.0058), (-0.02, -s * 0.006, 0.006), (-0.035, -s * 0.012, 0.006)], 12), 0.0055, black, 10))
        ring = [(-0.063 + 0.03 * np.cos(a), -s * 0.025 + 0.016 * np.sin(a) - s * 0.002, 0.006) for a in np.linspace(0, 2 * np.pi, 40)]
        parts.append(tube(ring, 0.0058, black, 10))
    return [*parts, moved(disc(0.0055, 0.009, IRON, 0.001, 20), (0.006, 0, 0.0015))]


def half_orange() -> list[Mesh]:
    """Cut in two: the segments show above."""
    size = 256
    y, x = np.mgrid[0:size, 0:size] / (size / 2) - 1
    r, a = np.hypot(x, y), np.arctan2(y, x)
    from patterns import noise, picture

    art = np.where((r < 0.86)[..., None], np.array([244, 150, 36]) * (0.85 + 0.25 * noise(size, 99, 5, 16))[..., None], np.array([250, 226, 176]))
    wall = (np.abs(((a / (2 * np.pi) * 10) % 1) - 0.5) > 0.46) | (r < 0.1)
    art = np.where((wall & (r < 0.86))[..., None], np.array([250, 214, 150]), art)
    art = np.where((r > 0.95)[..., None], np.array([232, 128, 22]), art)
    peel = lathe([(0, 0), *spline([(0.012, 0.001), (0.03, 0.012), (0.0385, 0.03), (0.039, 0.038)], 12)], material("#e07f17", 0.5), 36)
    face = lathe([(0.039, 0.038), (0, 0.0385)], material(rough=0.35, image=picture(art)), 36)
    face.visual.uv = face.vertices[:, :2] / 0.078 + 0.5
    return [peel, face]


MAKERS: dict[str, Callable[..., list[Mesh]]] = {
    f.__name__: f
    for f in (
        bee,
        cork,
        moka_pot,
        extinguisher,
        pliers,
        roller_skate,
        canister_vacuum,
        robot_vacuum,
        trophy,
        bell_pepper,
        chilli,
        double_burger,
        enamel_mug,
        sitting_bear,
        mallet,
        torch,
        dinner_plate,
        kitchen_shears,
        half_orange,
    )
}
