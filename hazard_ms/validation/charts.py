"""Line charts of results of the physics beside the numbers that they must match."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.pictures.drawing import (
    ACCENT,
    BLUE,
    EDGE,
    GOLD,
    GOOD,
    NIGHT,
    SOFT,
    TEXT,
    Colour,
    dot,
    text_width,
    write,
)

WIDTH, HEIGHT = 880, 520  # [pixels]
LEFT, RIGHT, TOP, BOTTOM = 84, 24, 84, 62  # margins [pixels]
COLOURS: tuple[Colour, ...] = (ACCENT, BLUE, GOOD, GOLD, (200, 130, 240), (240, 120, 130))
STEPS = (1, 2, 2.5, 5, 10)  # of ticks, times a power of ten
TICKS = 6  # at most, roughly


@dataclass(frozen=True)
class Line:
    """One curve, or the points that a publication or an exact solution gives."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    points: bool = False


@dataclass(frozen=True)
class Chart:
    """A picture of several curves. `file` without ending."""

    file: str
    title: str
    x: str  # with its unit
    y: str
    lines: tuple[Line, ...]


def ticks(low: float, high: float) -> list[float]:
    """Round numbers from `low` to `high`."""
    raw = (high - low) / TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(s * power for s in STEPS if s * power >= raw)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def draw(chart: Chart) -> NDArray[np.uint8]:
    """The chart, RGB [H, W, 3]."""
    image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    image[:] = NIGHT
    every_x, every_y = (
        np.concatenate([np.asarray(getattr(line, k), float) for line in chart.lines]) for k in ("x", "y")
    )
    (x0, x1), (y0, y1) = (every_x.min(), every_x.max()), (min(every_y.min(), 0.0), every_y.max() * 1.05)

    def at(x: float, y: float) -> tuple[int, int]:
        across, up = (x - x0) / (x1 - x0), (y - y0) / (y1 - y0)
        return round(LEFT + across * (WIDTH - LEFT - RIGHT)), round(HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))

    write(image, chart.title, (LEFT, 16), 21, TEXT)
    for x in ticks(x0, x1):
        cv2.line(image, at(x, y0), at(x, y1), EDGE, 1, cv2.LINE_AA)
        write(image, f"{x:g}", (at(x, y0)[0], HEIGHT - BOTTOM + 8), 15, SOFT, "middle")
    for y in ticks(y0, y1):
        cv2.line(image, at(x0, y), at(x1, y), EDGE, 1, cv2.LINE_AA)
        write(image, f"{y:g}", (LEFT - 10, at(x0, y)[1] - 10), 15, SOFT, "right")
    write(image, chart.x, (WIDTH - RIGHT, HEIGHT - 28), 15, SOFT, "right")
    write(image, chart.y, (16, 52), 15, SOFT)
    _lines(image, chart, at)
    return image


def _lines(image: NDArray[np.uint8], chart: Chart, at: Callable[[float, float], tuple[int, int]]) -> None:
    """The curves and their names, in place."""
    place = 16 + text_width(chart.y, 15) + 40
    for line, colour in zip(chart.lines, COLOURS, strict=False):
        spots = [at(float(x), float(y)) for x, y in zip(line.x, line.y, strict=True)]
        if line.points:
            for spot in spots:
                dot(image, spot, 5.0, colour)
        else:
            cv2.polylines(image, [np.array(spots, np.int32)], False, colour, 2, cv2.LINE_AA)
        dot(image, (place, 62), 5.0, colour)
        write(image, line.name, (place + 12, 52), 15, TEXT)
        place += 40 + text_width(line.name, 15)
