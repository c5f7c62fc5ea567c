"""Paintings of surfaces and of things that are cut out: bricks, tiles, kerbs, crowns of trees, a bicycle."""

from __future__ import annotations

import zlib

import cv2
import numpy as np

from hazard_ms.effects.textures import noise

Array = np.ndarray
Colour = tuple[int, int, int]

SURFACES = {  # colours of the paintings of `surface` [ours]
    "roof_slate": (74, 78, 86),
    "roof_red": (140, 68, 50),
    "roof_brown": (98, 74, 60),
    "wall_brick": (134, 78, 62),
    "wall_yellow": (176, 150, 106),
    "wall_plaster": (190, 184, 170),
    "wall_dark": (110, 96, 88),
    "fence": (118, 92, 66),
    "hedge": (52, 78, 34),
    "awning": (176, 40, 36),
    "awning_green": (36, 104, 66),
    "kerb": (150, 148, 142),
    "gutter": (46, 46, 47),
    "drain": (52, 53, 56),
    "manhole": (64, 64, 66),
    "bed": (64, 50, 36),
    "slabs": (142, 138, 130),
    "mended": (62, 62, 63),
    "wheel": (22, 22, 24),
    "grille": (30, 31, 34),
}


def plain(colour: Colour, side: int, grain: float) -> Array:
    """A plain colour with some `grain`, [side, side, 3] uint8."""
    speck = grain * (noise(side, sum(colour))[..., None] - 0.5) * 4.0
    return np.clip(np.array(colour) + speck, 0, 255).astype(np.uint8)


def bricks(colour: Colour, side: int, rows: int, across: int, seed: int, joint: float = 0.72) -> Array:
    """Rows of bricks, slates or boards that differ a little, [side, side, 3] uint8."""
    draw = np.random.default_rng(seed)
    y, x = np.mgrid[0:side, 0:side] * 1.0 / side
    row = np.minimum((y * rows).astype(int), rows - 1)
    column = ((x * across + 0.5 * (row % 2)) % across).astype(int)
    shade = 0.84 + 0.32 * draw.random((rows, across))[row, column] + 0.25 * (noise(side, seed) - 0.5)
    edge = ((y * rows) % 1.0 < 1.6 * rows / side) | ((x * across + 0.5 * (row % 2)) % 1.0 < 1.3 * across / side)
    shade = np.where(edge, joint, shade)
    return np.clip(np.array(colour) * shade[..., None], 0, 255).astype(np.uint8)


def surface(name: str, side: int) -> Array:
    """The painting of a name of SURFACES, [side, side, 3] uint8."""
    colour, seed = SURFACES[name], zlib.crc32(name.encode()) % 997
    if name.startswith("roof"):
        return bricks(colour, side, 20, 18, seed, 0.55)
    if name in ("wall_brick", "wall_yellow", "wall_dark"):
        return bricks(colour, side, 32, 12, seed, 0.85)
    image = plain(colour, side, 12.0)
    if name in _DETAILS:
        _DETAILS[name](image, side)
    return image


def _fence(image: Array, side: int) -> None:
    for k in range(10):
        x = k * side // 10
        cv2.line(image, (x, 0), (x, side), (54, 40, 28), 2)


def _hedge(image: Array, side: int) -> None:
    draw = np.random.default_rng(5)
    for _ in range(900):
        x, y, tone = draw.integers(0, side), draw.integers(0, side), draw.uniform(0.6, 1.7)
        cv2.circle(image, (int(x), int(y)), 2, tuple(int(c * tone) for c in SURFACES["hedge"]), -1)


def _awning(image: Array, side: int) -> None:
    for k in range(0, 8, 2):
        cv2.rectangle(image, (k * side // 8, 0), ((k + 1) * side // 8, side), (222, 216, 200), -1)


def _kerb(image: Array, side: int) -> None:
    for k in range(4):
        cv2.line(image, (k * side // 4, 0), (k * side // 4, side), (88, 86, 82), 2)
    image[int(0.86 * side) :] = image[int(0.86 * side) :] // 2  # its shadow on the road


def _drain(image: Array, side: int) -> None:
    for k in range(7):
        x = (2 * k + 1) * side // 14
        cv2.rectangle(image, (x - 4, side // 8), (x + 3, 7 * side // 8), (10, 10, 11), -1)
    cv2.rectangle(image, (0, 0), (side - 1, side - 1), (78, 78, 80), 5)


def _manhole(image: Array, side: int) -> None:
    for r in range(side // 2 - 10, 4, -9):
        cv2.circle(image, (side // 2, side // 2), r, (40, 40, 41) if r % 2 else (92, 92, 94), 2, cv2.LINE_AA)
    cv2.circle(image, (side // 2, side // 2), side // 2 - 5, (30, 30, 31), 4, cv2.LINE_AA)


def _bed(image: Array, side: int) -> None:
    draw = np.random.default_rng(8)
    for _ in range(260):
        x, y = int(draw.integers(0, side)), int(draw.integers(0, side))
        cv2.circle(image, (x, y), 4, (44 + int(draw.integers(0, 24)), 74 + int(draw.integers(0, 30)), 30), -1)
    for _ in range(110):
        x, y = int(draw.integers(0, side)), int(draw.integers(0, side))
        colour = [(206, 60, 66), (226, 186, 60), (222, 218, 214), (150, 88, 160)][int(draw.integers(0, 4))]
        cv2.circle(image, (x, y), 2, colour, -1, cv2.LINE_AA)


def _slabs(image: Array, side: int) -> None:
    for k in range(5):
        cv2.line(image, (0, k * side // 4), (side, k * side // 4), (84, 82, 78), 2)
        cv2.line(image, (k * side // 4, 0), (k * side // 4, side), (84, 82, 78), 2)


def _wheel(image: Array, side: int) -> None:
    cv2.circle(image, (side // 2, side // 2), int(0.32 * side), (126, 128, 130), -1, cv2.LINE_AA)
    for k in range(5):
        turn = 1.2566 * k
        to = (int(side / 2 + 0.3 * side * np.cos(turn)), int(side / 2 + 0.3 * side * np.sin(turn)))
        cv2.line(image, (side // 2, side // 2), to, (60, 61, 63), 7, cv2.LINE_AA)


def _grille(image: Array, side: int) -> None:
    for k in range(6):
        cv2.line(image, (0, (2 * k + 1) * side // 12), (side, (2 * k + 1) * side // 12), (96, 98, 102), 3)


_DETAILS = {
    "fence": _fence,
    "hedge": _hedge,
    "awning": _awning,
    "awning_green": _awning,
    "kerb": _kerb,
    "drain": _drain,
    "manhole": _manhole,
    "bed": _bed,
    "slabs": _slabs,
    "wheel": _wheel,
    "grille": _grille,
}


def gable(name: str, side: int) -> Array:
    """The side of a house: the wall `name` of SURFACES with two small windows, [side, side, 3] uint8."""
    image = surface(name, side)
    for x, y in ((0.22, 0.30), (0.62, 0.62)):
        a, b, c, d = (round(v * side) for v in (x, y, x + 0.15, y + 0.17))
        cv2.rectangle(image, (a - 2, b - 2), (c + 2, d + 2), (206, 202, 192), -1)
        cv2.rectangle(image, (a, b), (c, d), (48, 58, 68), -1)
        cv2.fillPoly(image, [np.array([(a, b), ((a + c) // 2, b), (a, (b + d) // 2)])], (118, 132, 144))
        cv2.line(image, ((a + c) // 2, b), ((a + c) // 2, d), (206, 202, 192), 1)
        cv2.line(image, (a, (b + d) // 2), (c, (b + d) // 2), (206, 202, 192), 1)
    return image


def cloth(number: int, side: int) -> Array:
    """Striped, chequered and plain cloth, [side, side, 3] uint8."""
    one, two = [
        ((206, 204, 198), (70, 104, 160)),
        ((176, 46, 50), (222, 214, 204)),
        ((214, 178, 70), (206, 120, 50)),
        ((92, 132, 110), (212, 208, 196)),
        ((224, 220, 214), (224, 220, 214)),
        ((226, 88, 26), (238, 196, 40)),
    ][number % 6]
    y, x = np.mgrid[0:side, 0:side] * 6 // side
    other = [x % 2, y % 2, (x + y) % 2, x // 2 % 2, y % 3 == 1, y // 3][number % 6]
    image = np.where(other.astype(bool)[..., None], two, one) * (0.86 + 0.28 * noise(side, 60 + number))[..., None]
    return np.clip(image, 0, 255).astype(np.uint8)
