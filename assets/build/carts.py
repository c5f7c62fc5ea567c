"""Shopping carts of our own: open, hollow, with a handle at +y and wheels. Metres."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shapes import Mesh, block, disc, dressed, material, moved, spline, tube

RIM, FLOOR = 0.88, 0.47  # heights of the basket's upper edge and of its floor [m]
TOP = np.array([[-0.262, -0.44], [0.262, -0.44], [0.262, 0.365], [-0.262, 0.365]])  # corners of the rim
BOTTOM = np.array([[-0.24, -0.385], [0.24, -0.385], [0.24, 0.365], [-0.24, 0.365]])  # corners of the floor
STEEL = material("#b4b8bc", 0.28, 0.85)
RUBBER = material("#26282b", 0.8)


def wires(ends: Any, radius: float, of: Any, sides: int = 5) -> Mesh:
    """Straight rods between pairs of points, [N, 2, 3], without caps."""
    a, b = np.swapaxes(np.asarray(ends, dtype=float), 0, 1)
    ahead = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    other = np.where(np.abs(ahead[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    u = np.cross(ahead, other)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(ahead, u)
    angle = np.arange(sides) * 2 * np.pi / sides
    out = np.cos(angle)[None, :, None] * u[:, None] + np.sin(angle)[None, :, None] * v[:, None]  # [N, sides, 3]
    vertices = np.concatenate([a[:, None] + radius * out, b[:, None] + radius * out], axis=1)  # [N, 2 sides, 3]
    k = np.arange(sides)
    after = (k + 1) % sides
    one = np.concatenate([np.stack([k, after, after + sides], 1), np.stack([k, after + sides, k + sides], 1)])
    faces = (np.arange(len(a))[:, None, None] * 2 * sides + one).reshape(-1, 3)
    normals = np.concatenate([out, out], axis=1).reshape(-1, 3)
    return dressed(Mesh(vertices.reshape(-1, 3), faces, vertex_normals=normals, process=False), of)


def _level(height: float) -> np.ndarray:
    """Corners of the tapered basket at a height [m], [4, 3]."""
    t = (height - FLOOR) / (RIM - FLOOR)
    return np.c_[BOTTOM * (1 - t) + TOP * t, np.full(4, height)]


def _walls(spacing: float, rings: int) -> list[Sequence[np.ndarray]]:
    """Ends of the wires of the four walls and of the floor."""
    low, high = _level(FLOOR), _level(RIM)
    found: list[Sequence[np.ndarray]] = []
    for i in range(4):
        j = (i + 1) % 4
        count = round(float(np.linalg.norm(low[j] - low[i])) / spacing)
        for t in np.linspace(0, 1, count + 1)[:-1]:
            found.append((low[i] * (1 - t) + low[j] * t, high[i] * (1 - t) + high[j] * t))
        for z in np.linspace(FLOOR, RIM, rings):
            level = _level(z)
            found.append((level[i], level[j]))
    for axis, other in ((0, 1), (1, 0)):
        edge = BOTTOM.min(axis=0), BOTTOM.max(axis=0)
        for at in np.arange(edge[0][axis], edge[1][axis], spacing):
            ends = np.full((2, 3), FLOOR - 0.006)
            ends[:, axis], ends[:, other] = at, (edge[0][other], edge[1][other])
            found.append((ends[0], ends[1]))
    return found


def _chassis(of: Any) -> list[Mesh]:
    """Two bent side tubes from the front wheels to the handle, cross bars, a lower rack, and four castors."""
    parts: list[Mesh] = []
    for x in (-0.235, 0.235):
        path = [(x * 0.75, -0.4, 0.14), (x, 0.3, 0.15), (x, 0.385, 0.25), (x, 0.395, 0.7), (x, 0.4, 0.9), (x * 1.04, 0.45, 1.0)]
        parts.append(tube(spline(path, 26), 0.013, of, 8))
        parts.append(tube([(x * 0.8, -0.3, 0.14), (x * 0.8, -0.32, 0.3), (x * 0.8, -0.33, FLOOR - 0.01)], 0.011, of, 8))
    rack = [((x, -0.36, 0.15), (x, 0.32, 0.155)) for x in np.linspace(-0.18, 0.18, 7)]
    rack += [((-0.2, y, 0.148), (0.2, y, 0.148)) for y in (-0.36, 0.0, 0.3)]
    parts.append(wires(rack, 0.006, of))
    for x, y in ((-0.18, -0.38), (0.18, -0.38), (-0.235, 0.3), (0.235, 0.3)):
        parts.append(moved(disc(0.055, 0.026, RUBBER, 0.006, 18), (x - 0.013, y, 0.055), "y", 90))
        parts.append(moved(disc(0.02, 0.03, STEEL, sides=10), (x - 0.015, y, 0.055), "y", 90))
        parts += [moved(block((0.006, 0.03, 0.1), STEEL), (x + s * 0.018, y, 0.1)) for s in (-1, 1)]
    return parts


def _handle(color: str) -> list[Mesh]:
    grip = material(color, 0.45)
    bar = tube([(-0.245, 0.455, 1.0), (-0.1, 0.455, 1.0), (0.1, 0.455, 1.0), (0.245, 0.455, 1.0)], 0.018, grip, 14)
    caps = [moved(block((0.04, 0.05, 0.05), grip, 0.012), (s * 0.245, 0.453, 1.0)) for s in (-1, 1)]
    return [bar, *caps, moved(block((0.11, 0.03, 0.045), RUBBER, 0.01), (0, 0.455, 1.0))]


def _rim(of: Any) -> list[Mesh]:
    ring = np.vstack([_level(RIM), _level(RIM)[:1]])
    foot = np.vstack([_level(FLOOR), _level(FLOOR)[:1]])
    sides = [wires([(r[i], r[i + 1]) for i in range(4)], t, of, 8) for r, t in ((ring, 0.011), (foot, 0.008))]
    return [*sides, wires([(_level(FLOOR)[i], _level(RIM)[i]) for i in range(4)], 0.008, of, 8)]


def wire_cart(color: str = "#c2202b", spacing: float = 0.045) -> list[Mesh]:
    """A supermarket cart of steel wire with a coloured handle, a folded child's seat and a coin lock."""
    basket = wires(_walls(spacing, 6), 0.0032, STEEL, 4)
    tray = moved(block((0.47, 0.74, 0.004), material("#8d9296", 0.5, 0.5)), (0, -0.01, FLOOR - 0.012))
    flap = moved(block((0.4, 0.008, 0.2), material(color, 0.5), 0.003), (0, 0.353, 0.75))
    plate = moved(block((0.26, 0.006, 0.1), material(color, 0.5), 0.002), (0, -0.437, 0.8), "x", -8)
    return [basket, tray, flap, plate, *_rim(STEEL), *_chassis(STEEL), *_handle(color)]


def plastic_cart(color: str = "#1f5fa8", trim: str = "#e3b23c") -> list[Mesh]:
    """A cart whose basket is of slotted plastic, on a dark frame."""
    shell, frame = material(color, 0.5), material("#3b3f45", 0.35, 0.6)
    low, high = _level(FLOOR), _level(RIM)
    parts = [moved(block((0.48, 0.75, 0.012), shell, 0.004), (0, -0.01, FLOOR - 0.016))]
    slats: list[tuple[np.ndarray, np.ndarray]] = []
    for i in range(4):
        j = (i + 1) % 4
        count = round(float(np.linalg.norm(low[j] - low[i])) / 0.06)
        slats += [(low[i] * (1 - t) + low[j] * t, high[i] * (1 - t) + high[j] * t) for t in np.linspace(0, 1, count + 1)[:-1]]
    parts.append(wires(slats, 0.014, shell, 6))
    for z, thick in ((FLOOR + 0.01, 0.018), (0.6, 0.012), (0.74, 0.012), (RIM - 0.005, 0.022)):
        level = _level(z)
        parts.append(wires([(level[i], level[(i + 1) % 4]) for i in range(4)], thick, shell, 8))
        parts += [moved(disc(thick, 0.004, shell, sides=8), (*corner[:2], corner[2])) for corner in level]
    return [*parts, *_chassis(frame), *_handle(trim)]


MAKERS = {f.__name__: f for f in (wire_cart, plastic_cart)}
