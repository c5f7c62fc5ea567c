"""Paintings on the ground: kerbs and gutters, drains, covers, mended asphalt, leaves, puddles.

All of it is flat, so nothing is hidden by it and nobody trips over it.
"""

from __future__ import annotations

import math

from hazard_ms.effects.shaders.dressing import PUDDLE
from hazard_ms.effects.streets.lots import Lots
from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.town import Town, cut, paint
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.spec import Patch, SceneSpec

KERB, GUTTER = 0.20, 0.30  # widths [m] [ours]
STONES = 4.0  # length of one painting of kerb stones [m]
PUDDLES = 60  # tries
PUDDLED = ("asphalt", "pavement", "line_white")  # materials on which water stands
LOW = 0.009, 0.011, 0.013  # heights of paintings over one another [m]; patches of ground reach 0.006
HIGHEST = 0.02  # nothing on the ground is higher [m]
REACH = 34.0  # how far from the middle kerbs are painted [m]


def paint_ground(town: Town, spec: SceneSpec, draw: Draw) -> None:
    """Paint the ground of the scene `spec`."""
    lots = Lots(spec.room)
    middle = spec.room.size[0] / 2, spec.room.size[1] / 2
    for patch in spec.room.patches:
        if patch.material != "asphalt":
            continue
        for start, turn, length in _edges(patch, middle):
            _edge(town, lots, Frame(*start, turn), length, draw)
        _road(town, lots, patch, middle, draw)
    if spec.room.floor == "asphalt":
        _road(town, lots, Patch("asphalt", (0.0, 0.0), spec.room.size), middle, draw)
    _litter(town, spec, draw)
    _puddles(town, lots, spec, draw)


def _edges(patch: Patch, middle: tuple[float, float]) -> list[tuple[tuple[float, float], float, float]]:
    """The long edges of a road, each with its road to the left: start [m], direction [rad], length [m]."""
    (a, b), (c, d) = patch.min, patch.max
    if c - a > d - b:
        low, high = max(a, middle[0] - REACH), min(c, middle[0] + REACH)
        return [((low, b), 0.0, high - low), ((high, d), math.pi, high - low)]
    low, high = max(b, middle[1] - REACH), min(d, middle[1] + REACH)
    return [((a, high), -math.pi / 2, high - low), ((c, low), math.pi / 2, high - low)]


def _edge(town: Town, lots: Lots, start: Frame, length: float, draw: Draw) -> None:
    """Kerb stones and a gutter along the edge of a road, with drains; not where another road goes on."""
    for k in range(int(length / STONES)):
        at = start.moved((k + 0.5) * STONES, 0.0)
        parts = [m for m in range(4) if _at_rim(lots, at.moved((m - 1.5) * STONES / 4, 0.0))]
        if not parts:
            continue
        a, b = (parts[0] - 2) * STONES / 4, (parts[-1] - 1) * STONES / 4
        piece, long = at.moved((a + b) / 2, 0.0), b - a
        left, upper, right, lower = paint("kerb")
        cell = (left, upper, left + (right - left) * long / STONES, lower)
        # the painting's lower edge, a shadow, lies towards the road
        town.firm.flat(piece.moved(0.0, -KERB / 2, math.pi), (long, KERB), cell, LOW[1])
        town.firm.flat(piece.moved(0.0, GUTTER / 2), (long, GUTTER), paint("gutter"), LOW[0])
        if k % 2 == 0:
            town.firm.flat(piece.moved(draw.uniform(-0.3, 0.3) * long, GUTTER / 2), (0.5, 0.28), paint("drain"), LOW[1])
        if draw.uniform() < 0.8:
            pile = draw.uniform(0.9, 1.9), draw.uniform(0.35, 0.6)
            town.firm_cut.flat(piece.moved(draw.uniform(-0.4, 0.4) * long, 0.3), pile, cut("litter"), LOW[2])


def _at_rim(lots: Lots, at: Frame) -> bool:
    """Whether the asphalt ends here, and no line is painted on it."""
    on, off = lots.material(at.moved(0.0, GUTTER)), lots.material(at.moved(0.0, -GUTTER))
    return on == "asphalt" and off not in ("asphalt", "line_white")


def _road(town: Town, lots: Lots, patch: Patch, middle: tuple[float, float], draw: Draw) -> None:
    """Covers and mended places in a road."""
    low = [max(patch.min[k] + 0.8, middle[k] - 20.0) for k in (0, 1)]
    high = [min(patch.max[k] - 0.8, middle[k] + 20.0) for k in (0, 1)]
    for k in range(14):
        at = Frame(draw.uniform(low[0], high[0]), draw.uniform(low[1], high[1]), draw.uniform(-0.1, 0.1))
        size = (0.7, 0.7) if k % 3 == 0 else (draw.uniform(0.6, 2.4), draw.uniform(0.5, 1.3))
        corners = [at.moved(x * size[0] / 2, y * size[1] / 2) for x in (-1, 0, 1) for y in (-1, 0, 1)]
        if all(lots.material(c) == "asphalt" for c in corners):
            town.firm.flat(at, size, paint("mended" if k % 3 else "manhole"), LOW[1 if k % 3 == 0 else 0])


def _litter(town: Town, spec: SceneSpec, draw: Draw) -> None:
    """Fallen leaves, more of them where the wind drives them."""
    (x, y), beyond = spec.room.size, spec.room.beyond
    for _ in range(46):
        at = Frame(draw.uniform(-beyond, x + beyond), draw.uniform(-beyond, y + beyond), draw.uniform(0.0, 6.3))
        town.firm_cut.flat(at, (draw.uniform(0.7, 1.6), draw.uniform(0.6, 1.1)), cut("litter"), LOW[2])


def _puddles(town: Town, lots: Lots, spec: SceneSpec, draw: Draw) -> None:
    """Puddles on roads and pavements."""
    (x, y), beyond = spec.room.size, spec.room.beyond + 6.0
    for _ in range(PUDDLES):
        at = Frame(draw.uniform(-beyond, x + beyond), draw.uniform(-beyond, y + beyond), draw.uniform(0.0, 6.3))
        size = draw.uniform(0.8, 2.6), draw.uniform(0.6, 1.6)
        corners = [at.moved(a * size[0] / 2, b * size[1] / 2) for a in (-1, 0, 1) for b in (-1, 0, 1)]
        if all(lots.material(c) in PUDDLED for c in corners):
            town.wet.quad(at, _flat(size, LOW[1]), (0.0, 0.0, 1.0, 1.0), (PUDDLE,) * 4)


def _flat(size: tuple[float, float], high: float) -> list[tuple[float, float, float]]:
    x, y = size[0] / 2, size[1] / 2
    return [(-x, -y, high), (x, -y, high), (x, y, high), (-x, y, high)]
