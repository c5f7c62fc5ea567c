"""Paints fronts of houses: walls, doors, shops, and windows with the rooms behind them, some of them lit at night."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from hazard_ms.effects.streets.patterns import Array, Colour, bricks, plain
from hazard_ms.effects.textures import noise

SHOPS = frozenset({1, 4, 7, 10, 13})  # numbers of the fronts that are shops
WORDS = {1: "BAKERY", 4: "BOOKS", 7: "FLORIST", 10: "CAFE", 13: "BICYCLES"}
WALLS: tuple[tuple[str, Colour], ...] = (
    ("brick", (140, 82, 66)),
    ("plaster", (204, 194, 172)),
    ("boards", (150, 168, 178)),
    ("brick", (180, 152, 110)),
    ("plaster", (176, 124, 104)),
    ("stone", (140, 136, 128)),
    ("brick", (112, 70, 62)),
    ("plaster", (186, 198, 184)),
)
DOORS: tuple[Colour, ...] = (  # paints of doors [ours]
    (42, 72, 96),
    (112, 32, 34),
    (38, 78, 54),
    (96, 66, 40),
    (40, 42, 46),
)
ROOMS: tuple[Colour, ...] = (  # colours of rooms [ours]
    (134, 108, 78),
    (104, 116, 112),
    (140, 126, 104),
    (96, 88, 104),
    (128, 92, 82),
)
LIGHT: Colour = (255, 206, 134)  # of lit rooms


class _Canvas(NamedTuple):
    """The colours and the light of a front, [side, side, 3] each."""

    colour: Array
    glow: Array
    draw: np.random.Generator
    side: int

    def box(self, area: tuple[float, float, float, float], colour: Colour, edge: int = -1) -> None:
        """A rectangle: left, upper, right, lower, as shares of the side."""
        a, b, c, d = (round(v * self.side) for v in area)
        cv2.rectangle(self.colour, (a, b), (c, d), colour, edge)


def front(number: int, side: int) -> tuple[Array, Array]:
    """Front `number`, 0 to 15: its colours and the light that shines out of it at night, [side, side, 3] uint8 each."""
    canvas = _Canvas(_wall(number, side), np.zeros((side, side, 3), np.uint8), np.random.default_rng(number), side)
    storeys = 2 if number % 3 else 3
    trim: Colour = [(214, 210, 200), (62, 60, 58), (182, 170, 150)][number % 3]
    ground = 1.0 - 1.0 / storeys
    canvas.box((0.0, 0.0, 1.0, 0.03), trim)
    canvas.box((0.0, ground - 0.012, 1.0, ground + 0.006), _darker(trim, 0.8))
    count = 2 + number % 2
    for storey in range(storeys - 1):
        top = (storey + 0.22) / storeys
        for k in range(count):
            middle = (k + 0.5) / count
            half = min(0.13, 0.36 / count)
            _window(canvas, (middle - half, top, middle + half, (storey + 0.84) / storeys), trim)
    if number in SHOPS:
        _shop(canvas, number, ground, trim)
    else:
        _door(canvas, number, ground, trim)
    canvas.box((0.0, 0.975, 1.0, 1.0), (84, 82, 78))
    _weather(canvas)
    return canvas.colour, canvas.glow


def _wall(number: int, side: int) -> Array:
    kind, colour = WALLS[number % len(WALLS)]
    if kind == "brick":
        return bricks(colour, side, 58, 20, number, 0.86)
    if kind == "boards":
        return bricks(colour, side, 30, 1, number, 0.62)
    if kind == "stone":
        return bricks(colour, side, 18, 9, number, 0.66)
    return plain(colour, side, 9.0)


def _weather(canvas: _Canvas) -> None:
    """Dirt that runs down, and the wet foot of the wall."""
    side = canvas.side
    streak = cv2.resize(noise(128, 31)[:, :128], (side, side))
    streak = cv2.blur(streak, (1, side // 3))
    foot = np.clip((np.arange(side) / side - 0.86) / 0.14, 0.0, 1.0)[:, None]
    shade = (0.90 + 0.20 * streak) * (1.0 - 0.28 * foot)
    canvas.colour[:] = np.clip(canvas.colour * shade[..., None], 0, 255).astype(np.uint8)


def _room(canvas: _Canvas, area: tuple[float, float, float, float], lit: bool) -> None:
    """A room behind a pane, in perspective: walls, ceiling, floor, and something in it."""
    draw, side = canvas.draw, canvas.side
    a, b, c, d = (v * side for v in area)
    wide, high = c - a, d - b
    tone: Colour = ROOMS[int(draw.integers(0, len(ROOMS)))]
    dim = 0.85 if lit else 0.34
    back = (a + 0.24 * wide, b + 0.16 * high, c - 0.24 * wide, d - 0.26 * high)
    outer = [(a, b), (c, b), (c, d), (a, d)]
    inner = [(back[0], back[1]), (back[2], back[1]), (back[2], back[3]), (back[0], back[3])]
    for k, light in enumerate((1.15, 0.62, 0.42, 0.74)):  # ceiling, right, floor, left
        n = (k + 1) % 4
        points = np.array([outer[k], outer[n], inner[n], inner[k]]).round().astype(np.int32)
        cv2.fillPoly(canvas.colour, [points], _darker(tone, dim * light))
    flat = np.array(inner).round().astype(np.int32)
    cv2.fillPoly(canvas.colour, [flat], _darker(tone, dim * 0.92))
    x, y = back[0] + draw.uniform(0.15, 0.6) * (back[2] - back[0]), back[1] + 0.25 * (back[3] - back[1])
    cv2.rectangle(  # a picture on the wall
        canvas.colour, (int(x), int(y)), (int(x + 0.22 * wide), int(y + 0.18 * high)), _darker((190, 150, 90), dim), -1
    )
    seat = (int(a + draw.uniform(0.1, 0.5) * wide), int(d - 0.28 * high))
    cv2.rectangle(canvas.colour, seat, (int(seat[0] + 0.36 * wide), int(d)), _darker((90, 60, 52), dim), -1)
    lamp = (int((a + c) / 2), int(b + 0.15 * high))
    cv2.circle(canvas.colour, lamp, max(int(0.05 * wide), 2), LIGHT if lit else _darker(LIGHT, 0.5), -1, cv2.LINE_AA)
    if lit:
        y0, y1, x0, x1 = (round(v) for v in (b, d, a, c))
        inside = canvas.colour[y0:y1, x0:x1].astype(float) * (np.array(LIGHT) / 235.0)
        canvas.glow[y0:y1, x0:x1] = np.clip(inside, 0, 255)


def _window(canvas: _Canvas, area: tuple[float, float, float, float], trim: Colour) -> None:
    draw, (a, b, c, d) = canvas.draw, area
    canvas.box((a - 0.018, b - 0.018, c + 0.018, d + 0.014), trim)
    canvas.box((a - 0.03, d + 0.006, c + 0.03, d + 0.022), _darker(trim, 0.92))
    canvas.box((a - 0.03, d + 0.022, c + 0.03, d + 0.032), (52, 46, 42))
    _room(canvas, area, bool(draw.random() < 0.5))
    drape: Colour = [(196, 190, 178), (140, 60, 56), (86, 104, 128), (180, 160, 110)][int(draw.integers(0, 4))]
    wide = (c - a) * draw.uniform(0.10, 0.26)
    if draw.random() < 0.75:
        canvas.box((a, b, a + wide, d), _darker(drape, 0.7))
        canvas.box((c - wide, b, c, d), _darker(drape, 0.6))
        for x in (a, c - wide):
            left, right, top, low = (round(v * canvas.side) for v in (x, x + wide, b, d))
            canvas.glow[top:low, left:right] //= 2
    canvas.box(((a + c) / 2 - 0.006, b, (a + c) / 2 + 0.006, d), trim)
    canvas.box((a, (b + d) / 2 - 0.005, c, (b + d) / 2 + 0.005), trim)
    _shine(canvas, area)


def _shine(canvas: _Canvas, area: tuple[float, float, float, float]) -> None:
    """The sky in a pane: lighter towards its upper corner."""
    a, b, c, d = (round(v * canvas.side) for v in area)
    y, x = np.mgrid[0 : d - b, 0 : c - a] * 1.0
    sheen = np.clip(1.0 - (x / max(c - a, 1) + y / max(d - b, 1)), 0.0, 1.0)[..., None] * 0.5
    part = canvas.colour[b:d, a:c]
    part[:] = (part * (1.0 - sheen) + np.array([168, 182, 194]) * sheen).astype(np.uint8)


def _door(canvas: _Canvas, number: int, ground: float, trim: Colour) -> None:
    left = (0.62, 0.12)[number % 2]
    tall = 1.0 - ground
    door = (left, ground + 0.22 * tall, left + 0.17, 0.985)
    canvas.box((door[0] - 0.025, door[1] - 0.03, door[2] + 0.025, 1.0), trim)
    canvas.box(door, DOORS[number % len(DOORS)])
    for k in range(2):
        for m in range(2):
            x, y = door[0] + 0.02 + 0.075 * k, door[1] + 0.05 + 0.36 * tall * m
            canvas.box((x, y, x + 0.055, y + 0.24 * tall), _darker(DOORS[number % len(DOORS)], 0.7), 1)
    canvas.box((door[2] - 0.025, door[1] + 0.42 * tall, door[2] - 0.012, door[1] + 0.45 * tall), (210, 180, 90))
    windows = ((0.08, 0.5),) if left > 0.5 else ((0.40, 0.62), (0.70, 0.92))
    for a, c in windows:
        _window(canvas, (a, ground + 0.24 * tall, c, ground + 0.74 * tall), trim)


def _shop(canvas: _Canvas, number: int, ground: float, trim: Colour) -> None:
    """A shop front: a board with its name, two wide panes with shelves behind, and a door between them."""
    tall, wood = 1.0 - ground, _darker(DOORS[number % len(DOORS)], 1.0)
    canvas.box((0.03, ground + 0.02 * tall, 0.97, 1.0), wood)
    board = (0.05, ground + 0.05 * tall, 0.95, ground + 0.24 * tall)
    canvas.box(board, _darker(wood, 0.7))
    word, side = WORDS[number], canvas.side
    size = 0.62 * 0.9 * side / max(cv2.getTextSize(word, cv2.FONT_HERSHEY_TRIPLEX, 1.0, 1)[0][0], 1)
    size = min(size, 0.13 * tall * side / 20.0)
    wide = cv2.getTextSize(word, cv2.FONT_HERSHEY_TRIPLEX, size, 1)[0][0]
    at = ((side - wide) // 2, int((board[3] - 0.04 * tall) * side))
    cv2.putText(canvas.colour, word, at, cv2.FONT_HERSHEY_TRIPLEX, size, (236, 220, 176), 1, cv2.LINE_AA)
    cv2.putText(canvas.glow, word, at, cv2.FONT_HERSHEY_TRIPLEX, size, (190, 160, 96), 1, cv2.LINE_AA)
    for a, c in ((0.07, 0.40), (0.60, 0.93)):
        area = (a, ground + 0.30 * tall, c, 0.93)
        _room(canvas, area, True)
        _goods(canvas, area)
        _shine(canvas, area)
    door = (0.43, ground + 0.30 * tall, 0.57, 0.985)
    _room(canvas, door, True)
    canvas.box(door, trim, 2)


def _goods(canvas: _Canvas, area: tuple[float, float, float, float]) -> None:
    """Shelves with goods of many colours."""
    a, b, c, d = area
    for row in range(3):
        y = b + (0.42 + 0.24 * row) * (d - b)
        canvas.box((a, y, c, y + 0.008), (96, 70, 48))
        x = a + 0.01
        while x < c - 0.03:
            wide, high = canvas.draw.uniform(0.015, 0.035), canvas.draw.uniform(0.025, 0.05)
            colour = tuple(int(v) for v in canvas.draw.integers(60, 220, 3))
            canvas.box((x, y - high, x + wide, y - 0.004), (colour[0], colour[1], colour[2]))
            x += wide + canvas.draw.uniform(0.002, 0.016)
    y0, y1, x0, x1 = (round(v * canvas.side) for v in (b, d, a, c))
    canvas.glow[y0:y1, x0:x1] = np.clip(canvas.colour[y0:y1, x0:x1] * (np.array(LIGHT) / 255.0), 0, 255)


def _darker(colour: Colour, share: float) -> Colour:
    r, g, b = (int(min(c * share, 255)) for c in colour)
    return r, g, b
