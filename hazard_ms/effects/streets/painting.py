"""Paints the textures of the town: house fronts, walls, cars' parts, signs, cloth, and what is cut out.

All of it is drawn by this code, once per process; the colours are sRGB, 0 to 255.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import cv2
import numpy as np

from hazard_ms.effects.streets import fronts, patterns, silhouettes
from hazard_ms.effects.streets.mesh import Array, Cell
from hazard_ms.effects.textures import noise

SIDE, SMALL = 256, 128  # of a house front and of a smaller cell [pixels]
WIDTH, HEIGHT = 2048, 1024  # of the atlas: fronts in its left half, smaller cells in its right half [pixels]
INSET = 1.5  # by which a cell is smaller than its painting, against its neighbours [pixels]
PAINTS = {  # of cars, bins, cloth and poles [ours]
    "red": (150, 30, 28),
    "blue": (38, 66, 120),
    "white": (212, 212, 206),
    "silver": (140, 146, 150),
    "black": (24, 25, 27),
    "green": (40, 92, 56),
    "yellow": (214, 168, 38),
    "orange": (224, 92, 24),
    "teal": (30, 112, 116),
    "cream": (206, 192, 160),
    "pink": (196, 120, 130),
    "grey": (92, 94, 96),
    "timber": (112, 78, 48),
    "stone": (150, 146, 138),
    "dark": (44, 44, 46),
    "glass": (34, 46, 56),
    "skin": (70, 58, 46),
    "lamp": (238, 226, 190),
    "tail": (190, 26, 20),
}
SIGNS = ("BAKERY", "BOOKS", "CAFE", "FLORIST", "SHOES", "TEA", "BIKES", "POST")
WALLS = ("wall_brick", "wall_plaster", "wall_dark", "wall_yellow")  # of the sides of houses, by the front's number
CUT = ("crown_1", "crown_2", "crown_3", "conifer", "bicycle", "railing", "litter", "ivy")


class Atlas(NamedTuple):
    """A painted texture: colours [H, W, 4] uint8, light that shines at night [H, W, 4] uint8, and cells by name."""

    colour: Array
    glow: Array
    cells: dict[str, Cell]


@cache
def solid() -> Atlas:
    """The atlas of all that is solid: 16 fronts "front_0" on, and smaller cells by the names of their paintings."""
    colour, glow = np.full((HEIGHT, WIDTH, 4), 255, np.uint8), np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    glow[..., 3] = 255
    cells: dict[str, Cell] = {}
    for k in range(16):
        y, x = (k // 4) * SIDE, (k % 4) * SIDE
        colour[y : y + SIDE, x : x + SIDE, :3], glow[y : y + SIDE, x : x + SIDE, :3] = fronts.front(k, SIDE)
        cells[f"front_{k}"] = _cell(x, y, SIDE, WIDTH, HEIGHT)
    for k, (name, image) in enumerate(_small().items()):
        y, x = (k // 8) * SMALL, WIDTH // 2 + (k % 8) * SMALL
        colour[y : y + SMALL, x : x + SMALL, :3] = image
        if name == "lamp":
            glow[y : y + SMALL, x : x + SMALL, :3] = image
        cells[name] = _cell(x, y, SMALL, WIDTH, HEIGHT)
    return Atlas(colour, glow, cells)


@cache
def cut_out() -> Atlas:
    """The atlas of what is cut out of its quads: the names of CUT."""
    colour, cells = np.zeros((2 * SIDE, 4 * SIDE, 4), np.uint8), {}
    for k, name in enumerate(CUT):
        y, x = (k // 4) * SIDE, (k % 4) * SIDE
        colour[y : y + SIDE, x : x + SIDE] = silhouettes.cut(name, SIDE)
        cells[name] = _cell(x, y, SIDE, 4 * SIDE, 2 * SIDE)
    return Atlas(colour, np.zeros_like(colour), cells)


def puddle(side: int = SIDE) -> Array:
    """The outline of a puddle and its dark ground, [side, side, 4] uint8."""
    y, x = (np.mgrid[0:side, 0:side] + 0.5) / side - 0.5
    inside = 0.40 - np.hypot(x, y) + 0.30 * (noise(128, 21).repeat(side // 128, 0).repeat(side // 128, 1) - 0.5)
    image = np.zeros((side, side, 4), np.uint8)
    image[..., :3] = (44, 45, 46)
    image[..., 3] = np.where(cv2.GaussianBlur(inside, (9, 9), 3.0) > 0.0, 255, 0)
    return image


def clouds(side: int = 256) -> Array:
    """Tileable clouds, [side, side, 4] uint8: dark undersides, and gaps through which the sky is seen."""
    body, shade = noise(side, 11), noise(side, 12)
    cover = np.clip((body - 0.42) / 0.30, 0.0, 1.0)
    image = np.zeros((side, side, 4), np.uint8)
    grey = 150.0 + 75.0 * shade - 70.0 * cover * body
    image[..., :3] = np.clip(grey[..., None] * [0.97, 0.99, 1.02], 0, 255)
    image[..., 3] = 235 * cover
    return image


def _cell(x: int, y: int, side: int, wide: int, high: int) -> Cell:
    return (x + INSET) / wide, (y + INSET) / high, (x + side - INSET) / wide, (y + side - INSET) / high


def _small() -> dict[str, Array]:
    """The smaller cells, [SMALL, SMALL, 3] each, by name; at most 64."""
    made = {name: patterns.plain(c, SMALL, 4.0) for name, c in PAINTS.items()}
    made |= {name: patterns.surface(name, SMALL) for name in patterns.SURFACES}
    made |= {f"sign_{k}": _sign(word, k) for k, word in enumerate(SIGNS)}
    made |= {f"gable_{k}": patterns.gable(name, SMALL) for k, name in enumerate(WALLS)}
    made |= {f"cloth_{k}": patterns.cloth(k, SMALL) for k in range(6)}
    return made


def _sign(word: str, number: int) -> Array:
    ground = [(28, 58, 44), (92, 24, 26), (30, 40, 74), (196, 182, 146)][number % 4]
    image = patterns.plain(ground, SMALL, 3.0)
    ink = (232, 222, 190) if sum(ground) < 300 else (40, 34, 28)
    cv2.rectangle(image, (4, 4), (SMALL - 5, SMALL - 5), ink, 2)
    size = 0.95 * 108 / max(cv2.getTextSize(word, cv2.FONT_HERSHEY_TRIPLEX, 1.0, 1)[0][0], 1)
    (wide, high), _ = cv2.getTextSize(word, cv2.FONT_HERSHEY_TRIPLEX, size, 1)
    cv2.putText(
        image, word, ((SMALL - wide) // 2, (SMALL + high) // 2), cv2.FONT_HERSHEY_TRIPLEX, size, ink, 1, cv2.LINE_AA
    )
    return image
