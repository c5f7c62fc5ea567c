"""Paintings of things that are cut out of their quads: crowns of trees, leaves, a bicycle, a railing."""

from __future__ import annotations

import zlib

import cv2
import numpy as np

from hazard_ms.effects.streets.patterns import Array


def cut(name: str, side: int) -> Array:
    """The painting `name` of CUT, cut out, [side, side, 4] uint8; alpha is 0 or 255."""
    image = np.zeros((side, side, 4), np.uint8)
    if name in ("bicycle", "railing"):
        (_bicycle if name == "bicycle" else _railing)(image, side)
    else:
        _leaves(image, side, name)
    image[..., 3] = np.where(image[..., 3] > 127, 255, 0)
    return image


def _leaves(image: Array, side: int, name: str) -> None:
    draw = np.random.default_rng(zlib.crc32(name.encode()))
    tones = {
        "crown_1": (62, 92, 36),
        "crown_2": (150, 92, 30),
        "crown_3": (84, 106, 48),
        "conifer": (36, 62, 42),
        "litter": (150, 100, 40),
        "ivy": (46, 80, 36),
    }
    count = {"litter": 150, "ivy": 900}.get(name, 1500)
    for _ in range(count):
        x, y = _leaf_place(name, draw)
        light = 0.55 + 0.55 * (1.0 - y) + 0.3 * draw.random()
        tone = tuple(
            int(min(c * light * f, 255)) for c, f in zip(tones[name], draw.uniform(0.85, 1.15, 3), strict=True)
        )
        size = (int(draw.integers(3, 6)), int(draw.integers(6, 11)))
        cv2.ellipse(image, (int(x * side), int(y * side)), size, float(draw.uniform(0, 180)), 0, 360, (*tone, 255), -1)


def _leaf_place(name: str, draw: np.random.Generator) -> tuple[float, float]:
    """A place in the picture, 0 to 1, downwards, where leaves of a plant may be."""
    while True:
        x, y = draw.uniform(0.05, 0.95, 2)
        across, up = abs(x - 0.5), 1.0 - y
        if name == "conifer":
            inside = across < 0.42 * (1.0 - up) + 0.03 and draw.random() < 0.95
        elif name == "litter":
            inside = draw.random() < np.exp(-((y - 0.6) ** 2) / 0.05)
        elif name == "ivy":
            inside = up < 0.5 + 0.35 * np.sin(7.0 * x) + 0.1
        else:
            lobes = [(0.5, 0.36, 0.31), (0.3, 0.52, 0.24), (0.7, 0.54, 0.25), (0.5, 0.62, 0.26)]
            inside = any((x - a) ** 2 + (y - b) ** 2 < r * r for a, b, r in lobes)
        if inside:
            return float(x), float(y)


def _bicycle(image: Array, side: int) -> None:
    s = side / 256.0

    def at(x: float, y: float) -> tuple[int, int]:
        return int(x * s), int(y * s)

    for x in (62, 194):
        cv2.circle(image, at(x, 178), int(54 * s), (26, 26, 28, 255), max(int(7 * s), 1))
        for k in range(6):
            turn = 0.5236 * 2 * k
            cv2.line(image, at(x, 178), at(x + 52 * np.cos(turn), 178 + 52 * np.sin(turn)), (90, 90, 92, 255), 1)
    frame = (30, 96, 120, 255)
    for a, b in (
        ((62, 178), (104, 112)),
        ((104, 112), (118, 184)),
        ((118, 184), (62, 178)),
        ((104, 112), (176, 104)),
        ((118, 184), (176, 104)),
        ((194, 178), (170, 78)),
        ((118, 184), (98, 88)),
    ):
        cv2.line(image, at(*a), at(*b), frame, max(int(8 * s), 2))
    cv2.line(image, at(82, 86), at(116, 84), (24, 22, 22, 255), max(int(11 * s), 2))
    cv2.line(image, at(156, 72), at(190, 82), (24, 22, 22, 255), max(int(8 * s), 2))


def _railing(image: Array, side: int) -> None:
    for k in range(12):
        x = int((k + 0.5) * side / 12)
        cv2.line(image, (x, int(0.1 * side)), (x, side), (34, 36, 38, 255), 5)
        cv2.circle(image, (x, int(0.08 * side)), 6, (34, 36, 38, 255), -1)
    for y in (0.2, 0.9):
        cv2.line(image, (0, int(y * side)), (side, int(y * side)), (34, 36, 38, 255), 7)
