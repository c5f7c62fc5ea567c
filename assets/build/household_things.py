"""Tools and machines of our own: pots, an extinguisher, pliers, skates, vacuum cleaners, torches. Metres."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from trimesh.visual.material import PBRMaterial

from patterns import label, wood
from shapes import Mesh, block, bulge, disc, lathe, material, moved, spline, tube

STEEL = material("#a4a6ab", 0.3, 0.8)
IRON = material("#4b4d51", 0.4, 0.7)
BLACK = material("#1c1d1f", 0.6)
BRASS = material("#b99450", 0.35, 0.7)


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
    red, text = (
        material("#b3201c", 0.3),
        label(512, 256, "#f2f0e8", "#8b1512", [("CO2", 0.34, 0.3), ("2 kg  -  class B", 0.13, 0.62), ("pull, aim, squeeze", 0.1, 0.84)]),
    )
    body = lathe(
        [(0, 0), (0.054, 0), (0.058, 0.006), *spline([(0.058, 0.3), (0.055, 0.36), (0.03, 0.42), (0.018, 0.44)], 14), (0, 0.44)], red, 36
    )
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
    hide, sole, lace = material("#f0eee8", 0.45), material("#2c2d31", 0.6), material("#c94f74", 0.8)
    foot = moved(bulge((0.088, 0.25, 0.1), (0.75, 0.75), hide, 34), (0, -0.01, 0.135))
    toe = moved(bulge((0.09, 0.11, 0.075), (0.8, 0.9), hide, 26), (0, -0.085, 0.125))
    leg = [(0, 0), (0.046, 0), (0.044, 0.06), (0.05, 0.14), (0.047, 0.145), (0.038, 0.13), (0, 0.12)]
    shaft = lathe(leg, hide, 34)
    shaft.vertices[:, 1] *= 1.15
    moved(shaft, (0, 0.058, 0.135))
    lining = moved(disc(0.04, 0.004, material("#d1a5b0", 0.9), sides=30), (0, 0.058, 0.262))
    base = moved(block((0.082, 0.25, 0.018), sole, 0.007), (0, -0.01, 0.088))
    heel = moved(block((0.072, 0.075, 0.024), sole, 0.006), (0, 0.075, 0.098))
    ties = [(-0.062, 0.178), (-0.043, 0.183), (-0.024, 0.187), (0.006, 0.207), (0.004, 0.229), (0.001, 0.251)]
    laces = [moved(tube([(-0.026, 0.006, 0), (0, 0, 0.002), (0.026, 0.006, 0)], 0.0032, lace, 8), (0, y, z)) for y, z in ties]
    return [foot, toe, shaft, lining, base, heel, *laces, *_wheels(material("#e0567a", 0.35))]


def _wheels(of: PBRMaterial) -> list[Mesh]:
    """The skate's plate, its two axles with two wheels each, and the stopper."""
    tyre = [(0, 0), (0.022, 0), (0.031, 0.005), (0.031, 0.029), (0.022, 0.034), (0, 0.034)]
    parts = [moved(block((0.05, 0.24, 0.012), STEEL, 0.003), (0, -0.01, 0.074))]
    for y in (-0.085, 0.075):
        parts.append(moved(block((0.03, 0.03, 0.045), STEEL, 0.006), (0, y, 0.055)))
        parts.append(moved(disc(0.005, 0.13, IRON, 0.0, 12), (-0.065, y, 0.031), "y", 90))
        parts += [moved(lathe(tyre, of, 30), (s * 0.043 - 0.017, y, 0.031), "y", 90) for s in (-1, 1)]
        parts += [moved(disc(0.01, 0.037, STEEL, 0.001, 18), (s * 0.043 - 0.0185, y, 0.031), "y", 90) for s in (-1, 1)]
    stopper = lathe([(0, 0), (0.02, 0), (0.023, 0.008), (0.014, 0.03), (0, 0.03)], of, 24)
    return [*parts, moved(stopper, (0, -0.128, 0.038), "x", -20)]


def canister_vacuum(color: str = "#8f1f2a") -> list[Mesh]:
    """A vacuum cleaner on two large wheels, its tube standing behind it; it faces -y."""
    shell, dark = material(color, 0.25), material("#2a2c30", 0.5)
    body = moved(bulge((0.27, 0.38, 0.24), (0.75, 0.65), shell, 40), (0, 0, 0.14))
    skirt = moved(bulge((0.285, 0.39, 0.1), (0.5, 0.65), dark, 36), (0, 0, 0.085))
    wheels = [
        moved(
            lathe([(0, 0), (0.055, 0), (0.075, 0.008), (0.075, 0.028), (0.055, 0.036), (0, 0.036)], dark, 32),
            (s * 0.14 - 0.018, 0.1, 0.075),
            "y",
            90,
        )
        for s in (-1, 1)
    ]
    hubs = [moved(disc(0.045, 0.004, STEEL, 0.001, 28), (s * 0.159 - 0.002, 0.1, 0.075), "y", 90) for s in (-1, 1)]
    castor = moved(disc(0.025, 0.03, dark, 0.004, 22), (-0.015, -0.13, 0.025), "y", 90)
    button = moved(disc(0.022, 0.012, STEEL, 0.003, 26), (0, 0.06, 0.25))
    grip = tube(spline([(0, -0.03, 0.255), (0, -0.01, 0.3), (0, 0.1, 0.3), (0, 0.135, 0.235)], 20), 0.012, dark, 10)
    port = moved(disc(0.03, 0.04, dark, 0.004, 28), (0, -0.16, 0.165), "x", 65)
    hose = tube(
        spline([(0, -0.185, 0.18), (0.03, -0.29, 0.3), (0.15, -0.3, 0.42), (0.2, -0.1, 0.52), (0.2, 0.1, 0.62)], 60),
        0.019 + 0.0025 * (np.arange(60) % 2),
        material("#55585e", 0.6),
        12,
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
    brush = [
        moved(tube([(0, 0, 0), (0.03, 0, 0), (0.062, 0, 0)], 0.0018, material("#c9c13c", 0.8), 6), (0.1, -0.11, 0.009), "z", -60 + 120 * k)
        for k in range(3)
    ]
    return [body, bumper, top, turret, button, *wheels, *brush]


def mallet() -> list[Mesh]:
    """A rubber mallet, lying, with an ash handle."""
    ash, rubber = material(rough=0.6, image=wood((178, 138, 90), (216, 182, 134), size=128, seed=97)), material("#1f2022", 0.8)
    handle = tube([(0, 0.0, 0.032), (0, -0.1, 0.032), (0, -0.2, 0.03), (0, -0.3, 0.03)], [0.012, 0.011, 0.014, 0.015], ash, 16)
    head = moved(
        lathe([(0, -0.055), (0.028, -0.055), (0.032, -0.05), (0.03, 0), (0.032, 0.05), (0.028, 0.055), (0, 0.055)], rubber, 32),
        (0, 0.012, 0.032),
        "y",
        90,
    )
    return [handle, head, moved(disc(0.012, 0.004, ash, sides=16), (0, 0.0455, 0.032), "x", 90)]


def torch() -> list[Mesh]:
    """A slim aluminium torch, lying, lens to +x."""
    alu, rubber, lens = material("#34506e", 0.35, 0.6), material("#1c1d20", 0.7), material("#f4f1da", 0.1)
    body = lathe(
        [
            (0, 0),
            (0.012, 0),
            (0.0135, 0.002),
            (0.0135, 0.014),
            (0.0125, 0.016),
            (0.0125, 0.1),
            (0.0135, 0.105),
            (0.0185, 0.125),
            (0.0195, 0.127),
            (0.0195, 0.15),
            (0.018, 0.152),
            (0.0165, 0.149),
        ],
        alu,
        32,
    )
    glass = lathe([(0.0168, 0.149), (0, 0.1495)], lens, 28)
    knurl = [
        lathe([(0.01255, z), (0.0133, z + 0.001), (0.0133, z + 0.003), (0.01255, z + 0.004)], rubber, 28)
        for z in np.arange(0.024, 0.09, 0.0075)
    ]
    switch = moved(block((0.009, 0.003, 0.016), rubber, 0.001), (0, -0.0135, 0.094))
    return [moved(p, (0, 0, 0.0195), "y", 90) for p in (body, glass, *knurl, switch)]


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
        parts.append(
            tube(spline([(0.005, -s * 0.003, 0.0058), (-0.02, -s * 0.006, 0.006), (-0.035, -s * 0.012, 0.006)], 12), 0.0055, black, 10)
        )
        ring = [(-0.063 + 0.03 * np.cos(a), -s * 0.025 + 0.016 * np.sin(a) - s * 0.002, 0.006) for a in np.linspace(0, 2 * np.pi, 40)]
        parts.append(tube(ring, 0.0058, black, 10))
    return [*parts, moved(disc(0.0055, 0.009, IRON, 0.001, 20), (0.006, 0, 0.0015))]


MAKERS: dict[str, Callable[..., list[Mesh]]] = {
    f.__name__: f
    for f in (
        moka_pot,
        extinguisher,
        pliers,
        roller_skate,
        canister_vacuum,
        robot_vacuum,
        mallet,
        torch,
        kitchen_shears,
    )
}
