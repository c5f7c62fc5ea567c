"""Small things of our own: each function returns its parts; the base need not be at z = 0 yet. Metres."""

from __future__ import annotations

import numpy as np

from patterns import fabric, label, wood
from shapes import Mesh, block, bulge, cut, disc, lathe, material, moved, panel, spline, tube

STEEL = {"rough": 0.3, "metal": 0.8}


def disposable_lighter(color: str = "#d8372a") -> list[Mesh]:
    body = moved(block((0.025, 0.012, 0.055), material(color, 0.25), 0.004), (0, 0, 0.0275))
    hood = moved(block((0.024, 0.0118, 0.017), material("#c4c6ca", **STEEL), 0.002), (0, 0, 0.0635))
    wheel = moved(disc(0.0045, 0.007, material("#4a4a4c", 0.5, 0.7), sides=20), (0.004, 0.0035, 0.0735), "x", 90)
    key = moved(block((0.008, 0.009, 0.006), material("#1c1c1c"), 0.001), (-0.007, 0, 0.0735))
    return [body, hood, wheel, key]


def flip_lighter() -> list[Mesh]:
    steel = material("#b9a26a", 0.3, 0.7)
    body = moved(block((0.038, 0.013, 0.036), steel, 0.003), (0, 0, 0.018))
    lid = moved(block((0.038, 0.013, 0.020), steel, 0.003), (0, 0, 0.047))
    seam = moved(block((0.0375, 0.0125, 0.002), material("#3c3a33", 0.5)), (0, 0, 0.0365))
    hinge = moved(disc(0.002, 0.016, material("#8a8a8c", **STEEL), sides=12), (0.0195, 0, 0.029))
    return [body, lid, seam, hinge]


def toothbrush(color: str = "#1e8cd2", electric: bool = False) -> list[Mesh]:
    if electric:
        return _electric_toothbrush(color)
    x = np.linspace(0, 0.18, 40)
    bend = 0.003 * np.sin(np.linspace(0, 2 * np.pi, 40))
    radius = np.interp(x / 0.18, [0, 0.1, 0.5, 0.75, 0.85, 1], [0.004, 0.0062, 0.0065, 0.0035, 0.0045, 0.005])
    handle = tube(np.c_[x, 0 * x, bend + 0.0065], radius, material(color, 0.3), 14)
    return [handle, *_bristles(0.155, 0.0105, 9, 3)]


def _bristles(x: float, z: float, columns: int, rows: int) -> list[Mesh]:
    white, blue = material("#f4f4f8", 0.8), material("#49aee0", 0.8)
    return [
        moved(disc(0.0012, 0.011, white if (i + j) % 3 else blue, sides=8), (x + i * 0.0027, (j - (rows - 1) / 2) * 0.003, z))
        for i in range(columns)
        for j in range(rows)
    ]


def _electric_toothbrush(color: str) -> list[Mesh]:
    white, soft = material("#f0f0f2", 0.3), material(color, 0.6)
    body = lathe(spline([(0.002, 0), (0.014, 0.004), (0.0155, 0.06), (0.013, 0.12), (0.006, 0.138)]).clip(0), white)
    neck = lathe([(0, 0.136), (0.0055, 0.138), (0.004, 0.19), (0, 0.192)], white)
    button = moved(disc(0.005, 0.003, soft, 0.001, 20), (0, -0.0135, 0.09), "x", 90)
    grip = lathe([(0.0153, 0.03), (0.0162, 0.032), (0.0161, 0.07), (0.0150, 0.072)], soft)
    head = moved(disc(0.007, 0.006, white, 0.001, 24), (0, 0.001, 0.195), "x", 90)
    tufts = [moved(t, about="x", degrees=90) for t in _bristles(-0.004, 0.0, 4, 3)]
    for tuft in tufts:
        moved(tuft, (0, -0.004, 0.195))
    parts = [body, neck, button, grip, head, *tufts]
    return [moved(p, about="y", degrees=90) for p in parts]  # it lies


def soda_can(ground: str, band: str, name: str) -> list[Mesh]:
    metal = material("#c8c8cd", 0.3, 0.6)
    picture = label(512, 256, ground, "#ffffff", [(name, 0.17, 0.5), ("ZERO PLASTIC - 330 ml", 0.06, 0.8)], band)
    side = lathe([(0.033, 0.012), (0.033, 0.105)], material(rough=0.35, image=picture))
    foot = lathe([(0, 0.006), (0.024, 0.006), (0.026, 0), (0.0285, 0.003), (0.033, 0.012)], metal)
    top = lathe([(0.033, 0.105), (0.0285, 0.117), (0.0275, 0.121), (0.026, 0.1185), (0, 0.1185)], metal)
    ring = moved(block((0.022, 0.013, 0.0012), material("#9c9ca2", 0.3, 0.7), 0.0005), (0.008, 0, 0.1192))
    return [side, foot, top, ring]


def chocolate(wrapper: str, name: str, dark: bool) -> list[Mesh]:
    cocoa = material("#2e150b" if dark else "#5a3018", 0.45)
    parts = [moved(block((0.16, 0.074, 0.006), cocoa, 0.001), (0, 0, 0.003))]
    for i in range(6):
        for j in range(3):
            parts.append(moved(block((0.023, 0.021, 0.006), cocoa, 0.002), (-0.0645 + i * 0.0258, -0.0235 + j * 0.0235, 0.007)))
    face = label(256, 200, wrapper, "#f6e7c1", [(name, 0.16, 0.36), ("CACAO", 0.1, 0.6), ("100 g", 0.07, 0.82)])
    parts.append(moved(block((0.1, 0.079, 0.013), material(wrapper, 0.35), 0.002), (0.034, 0, 0.0065)))
    parts.append(moved(panel(0.096, 0.072, material(rough=0.35, image=face)), (0.034, 0, 0.01315)))
    foil = moved(block((0.012, 0.077, 0.0125), material("#d8d8dc", 0.3, 0.8), 0.002), (-0.018, 0, 0.00625))
    return [*parts, foil]


def coffee_grinder() -> list[Mesh]:
    """A hand mill: wooden body, drawer, brass bowl, crank."""
    walnut, oak = material(rough=0.55, image=wood()), material(rough=0.55, image=wood((92, 54, 26), (136, 86, 46), seed=9))
    iron, brass = material("#4a4a4c", 0.4, 0.7), material("#b99450", 0.35, 0.7)
    body = moved(block((0.11, 0.11, 0.1), walnut, 0.005), (0, 0, 0.062))
    plates = [moved(block((0.125, 0.125, 0.012), oak, 0.004), (0, 0, z)) for z in (0.006, 0.116)]
    bowl = lathe(
        np.r_[spline([(0.012, 0.12), (0.04, 0.134), (0.052, 0.164)], 12), [[0.048, 0.164], [0.036, 0.14], [0, 0.13]]], brass
    )
    axle = moved(disc(0.005, 0.07, iron, sides=14), (0, 0, 0.122))
    crank = tube(spline([(0, 0, 0.19), (0.03, 0, 0.197), (0.065, 0, 0.195), (0.09, 0, 0.19)], 14), 0.004, iron, 8)
    knob = moved(bulge((0.026, 0.026, 0.03), (1, 1), walnut, 20), (0.09, 0, 0.204))
    drawer = moved(block((0.07, 0.01, 0.04), oak, 0.003), (0, -0.056, 0.05))
    pull = moved(disc(0.006, 0.014, brass, 0.002, 16), (0, -0.06, 0.05), "x", 90)
    return [body, *plates, bowl, axle, crank, knob, drawer, pull]


def electric_grinder() -> list[Mesh]:
    red, black, grey = material("#a3201f", 0.3), material("#1d1d1f", 0.4), material("#b8babd", **STEEL)
    base = lathe([(0, 0), (0.054, 0), (0.056, 0.006), (0.05, 0.06), (0.047, 0.11), (0, 0.11)], red)
    band = lathe([(0.0475, 0.11), (0.0485, 0.113), (0.0485, 0.122), (0.0475, 0.125)], grey)
    lid = lathe([(0.046, 0.125), (0.045, 0.165), (0.036, 0.182), (0, 0.186)], material("#5a4a40", 0.15))
    switch = moved(block((0.024, 0.01, 0.014), black, 0.003), (0, -0.049, 0.09))
    return [base, band, lid, switch, disc(0.05, 0.004, black)]


def pillow(color: tuple[int, int, int], thread: tuple[int, int, int], stripes: int, round_one: bool = False) -> list[Mesh]:
    cloth = material(rough=0.95, image=fabric(color, thread, stripes))
    if round_one:
        cushion = bulge((0.4, 0.4, 0.13), (0.75, 1.0), cloth, 40)
        button = moved(bulge((0.035, 0.035, 0.016), (1, 1), material("#3a2a24", 0.8), 14), (0, 0, 0.064))
        return [cushion, button]
    cushion = bulge((0.42, 0.42, 0.15), (1.35, 0.32), cloth, 48)
    x, y, z = cushion.vertices.T / 0.21
    cushion.vertices = np.c_[x * (1 - 0.06 * (1 - abs(y)) ** 2), y * (1 - 0.06 * (1 - abs(x)) ** 2), z] * 0.21
    return [cushion]


def shirt_button(color: str, holes: int) -> list[Mesh]:
    """22 mm across: a coat button rather than a shirt's 11 mm, so that it can be seen at all."""
    body = lathe(
        [(0, 0), (0.0095, 0), (0.011, 0.0012), (0.011, 0.0028), (0.0085, 0.0032), (0.0075, 0.0022), (0, 0.0022)],
        material(color, 0.3),
    )
    angle = np.arange(holes) * 2 * np.pi / holes + np.pi / 4
    drills = [
        moved(disc(0.0011, 0.01, body.visual.material, sides=10), (0.0028 * np.cos(a), 0.0028 * np.sin(a), -0.003)) for a in angle
    ]
    return [cut(body, *drills)]


def smartphone(color: str, screen: tuple[str, str]) -> list[Mesh]:
    glass = label(200, 420, screen[0], "#ffffff", [("10:24", 0.11, 0.2), ("Saturday 21", 0.035, 0.28)], screen[1])
    body = moved(block((0.071, 0.146, 0.0085), material(color, 0.3, 0.4), 0.004, 2), (0, 0, 0.00425))
    face = moved(panel(0.066, 0.138, material(rough=0.15, image=glass)), (0, 0, 0.00858))
    return [body, face]


def flip_phone() -> list[Mesh]:
    """An older phone with keys."""
    shell, keys = material("#2b3340", 0.35), material("#c9ced6", 0.5)
    body = moved(block((0.048, 0.112, 0.015), shell, 0.005, 2), (0, 0, 0.0075))
    glass = label(160, 130, "#9cc5a3", "#1d2b20", [("12:05", 0.3, 0.35), ("4 new", 0.16, 0.72)])
    face = moved(panel(0.036, 0.03, material(rough=0.2, image=glass)), (0, 0.03, 0.01515))
    pads = [
        moved(block((0.011, 0.007, 0.002), keys, 0.0008), (0.013 * (i - 1), -0.004 - 0.011 * j, 0.0153))
        for i in range(3)
        for j in range(4)
    ]
    return [body, face, *pads]


def book(cover: str, ink: str, title: str, author: str, size: tuple[float, float, float]) -> list[Mesh]:
    """A closed hardback, lying: cover up, back at -x."""
    w, h, t = size
    front = label(int(900 * w), int(900 * h), cover, ink, [(title, 0.1, 0.3), (author, 0.05, 0.8)])
    boards = [moved(block((w, h, 0.003), material(cover, 0.7), 0.0012), (0, 0, z)) for z in (0.0015, t - 0.0015)]
    pages = moved(block((w - 0.008, h - 0.008, t - 0.005), material("#e9e2cf", 0.95)), (0.001, 0, t / 2))
    back = moved(block((0.004, h, t), material(cover, 0.7), 0.0018), (-w / 2 + 0.002, 0, t / 2))
    face = moved(panel(w - 0.006, h - 0.006, material(rough=0.7, image=front)), (0, 0, t + 0.0002))
    return [*boards, pages, back, face]


def single_key() -> list[Mesh]:
    brass = material("#c2a14e", 0.35, 0.7)
    bow = cut(disc(0.0125, 0.003, brass, 0.0006), moved(disc(0.005, 0.02, brass, sides=20), (0.004, 0, -0.01)))
    blade = moved(block((0.036, 0.007, 0.0022), brass), (-0.029, 0, 0.0015))
    teeth = [
        moved(block((0.003, d, 0.0022), brass), (-0.02 - 0.0065 * i, -0.0035 - d / 2, 0.0015))
        for i, d in enumerate((0.002, 0.0035, 0.0025, 0.003))
    ]
    return [bow, blade, *teeth]


def frying_pan() -> list[Mesh]:
    black, steel = material("#26262a", 0.45, 0.3), material("#8f9196", **STEEL)
    outside = [(0, 0), (0.095, 0), (0.12, 0.03), (0.135, 0.045)]
    inside = [(0.132, 0.0455), (0.117, 0.031), (0.093, 0.005), (0, 0.005)]
    bowl = lathe([*outside, *inside], black, 44)
    arm = tube(
        spline([(0.125, 0, 0.036), (0.17, 0, 0.048), (0.23, 0, 0.056), (0.31, 0, 0.058)], 16), [0.007] * 4 + [0.011] * 12, black
    )
    rivet = moved(disc(0.012, 0.006, steel, sides=16), (0.126, 0, 0.04))
    return [bowl, arm, rivet]


def compact_camera(color: str = "#b4b6ba") -> list[Mesh]:
    silver, black, glass = material(color, 0.35, 0.3), material("#202024", 0.6), material("#16202c", 0.08, 0.2)
    body = moved(block((0.105, 0.028, 0.062), silver, 0.006, 2), (0, 0, 0.031))
    grip = moved(block((0.03, 0.03, 0.056), black, 0.005), (-0.036, -0.002, 0.03))
    rings = [
        moved(disc(r, d, m, 0.002, 36), (0.014, -0.013, 0.029), "x", 90)
        for r, d, m in ((0.026, 0.012, black), (0.022, 0.022, silver), (0.016, 0.0235, glass))
    ]
    flash = moved(block((0.018, 0.003, 0.008), material("#f2f2ee", 0.2), 0.001), (-0.012, -0.0145, 0.054))
    trigger = moved(disc(0.006, 0.005, black, 0.001, 20), (-0.036, 0, 0.061))
    return [body, grip, *rings, flash, trigger]


def wine_glass() -> list[Mesh]:
    outer = spline([(0.0035, 0.008), (0.0035, 0.075), (0.02, 0.09), (0.04, 0.13), (0.035, 0.2)], 30)
    inner = spline([(0.034, 0.2), (0.038, 0.13), (0.018, 0.093), (0.0005, 0.088)], 20)
    return [lathe(np.r_[[[0, 0.0], [0.035, 0.0], [0.034, 0.002], [0.006, 0.005]], outer, inner], material("#c9d8dc", 0.1))]


def wine_bottle(glass: str = "#24382a", paper: str = "#e8dfc8", name: str = "VALLE NERO", cap: str = "#5c1526") -> list[Mesh]:
    body = lathe(
        [
            (0, 0.003),
            (0.03, 0),
            (0.0365, 0.004),
            *spline([(0.0375, 0.012), (0.0375, 0.185), (0.028, 0.215), (0.0145, 0.24)], 20),
            (0.0142, 0.258),
        ],
        material(glass, 0.12),
    )
    seal = lathe([(0.0148, 0.236), (0.0152, 0.29), (0.0165, 0.292), (0.0165, 0.301), (0, 0.302)], material(cap, 0.5))
    front = label(512, 220, paper, "#3b1f1a", [(name, 0.2, 0.3), ("RISERVA 2019", 0.12, 0.6), ("750 ml", 0.08, 0.85)])
    band = lathe([(0.0378, 0.06), (0.0378, 0.14)], material(rough=0.8, image=front))
    return [body, seal, band]


def water_bottle() -> list[Mesh]:
    plastic, cap = material("#7fb8d6", 0.15), material("#1f5fae", 0.4)
    rings = [p for z in (0.05, 0.07, 0.15, 0.17) for p in ((0.032, z - 0.004), (0.0305, z), (0.032, z + 0.004))]
    body = lathe([(0, 0.004), (0.025, 0), (0.031, 0.006), *rings, (0.032, 0.185), (0.0125, 0.213), (0.0125, 0.221)], plastic)
    top = disc(0.0145, 0.014, cap, 0.001, 30)
    front = label(512, 190, "#f4f9fc", "#1b63a8", [("MONTE CHIARO", 0.22, 0.4), ("mineral water 0.5 l", 0.12, 0.7)])
    band = lathe([(0.0323, 0.083), (0.0323, 0.137)], material(rough=0.5, image=front))
    return [body, moved(top, (0, 0, 0.219)), band]


def candle(color: str = "#e9dfc4") -> list[Mesh]:
    wax = lathe(
        [(0, 0), (0.034, 0), (0.036, 0.002), (0.036, 0.118), (0.033, 0.122), (0.026, 0.119), (0, 0.117)], material(color, 0.5)
    )
    wick = tube([(0, 0, 0.115), (0.001, 0, 0.122), (0.0025, 0, 0.131)], 0.0013, material("#2b2420", 0.9), 8)
    dish = lathe([(0, 0), (0.046, 0), (0.054, 0.008), (0.052, 0.0085), (0.045, 0.003), (0, 0.003)], material("#8d7a4c", 0.4, 0.6))
    return [moved(wax, (0, 0, 0.003)), moved(wick, (0, 0, 0.003)), dish]


MAKERS = {f.__name__: f for f in list(globals().values()) if callable(f) and getattr(f, "__module__", "") == __name__}
