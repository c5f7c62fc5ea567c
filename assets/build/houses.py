"""Houses of our own, seen from outside only: their front looks to -y. Metres."""

from __future__ import annotations

from typing import Any

import numpy as np
from PIL import Image

import ground_patterns as ground
from patterns import label, noise, picture, plaster
from shapes import Mesh, block, disc, dressed, material, moved, panel, tube

WHITE = material("#e4e2dc", 0.6)
STONE = material("#a09c94", 0.9)
METAL = material("#5c6064", 0.4, 0.6)
TILE = 2.0  # edge of the square that one picture of a wall covers [m]


def _pane_picture(curtain: tuple[int, int, int], seed: int) -> Image.Image:
    """What is seen in a window by day: a dark room, light from the sky above, curtains at the sides."""
    h, w = 96, 72
    y, x = np.mgrid[0:h, 0:w] / np.array([h, w])[:, None, None]
    sky = np.clip(1.1 - 1.5 * y + 0.3 * noise(96, seed)[:h, :w], 0, 1)[..., None]
    out = np.array((30, 38, 46)) * (1 - 0.6 * sky) + np.array((120, 140, 158)) * 0.6 * sky
    side = np.minimum(x, 1 - x)
    hung = (side < 0.2 - 0.06 * y)[..., None]
    folds = (0.8 + 0.2 * np.sin(60 * side))[..., None]
    return picture(np.where(hung, np.array(curtain) * folds * (0.62 + 0.2 * (1 - y[..., None])), out))


def _window(w: float, h: float, at: tuple[float, float], wall: float, glass: Any, frame: Any = WHITE, bars: int = 1) -> list[Mesh]:
    """A window in a wall whose outer face is at y = `wall`: middle of its lower edge `at` (x, z)."""
    x, z = at
    parts = [moved(panel(w, h, glass), (0, 0, 0), "x", 90)]
    moved(parts[0], (x, wall - 0.012, z + h / 2))
    t = 0.07
    parts += [moved(block((w + t, 0.07, t), frame), (x, wall - 0.015, zz)) for zz in (z, z + h)]
    parts += [moved(block((t, 0.07, h), frame), (x + s * w / 2, wall - 0.015, z + h / 2)) for s in (-1, 1)]
    parts += [
        moved(block((0.035, 0.04, h), frame), (x + w * (k / (bars + 1) - 0.5), wall - 0.012, z + h / 2)) for k in range(1, bars + 1)
    ]
    parts.append(moved(block((w, 0.04, 0.035), frame), (x, wall - 0.012, z + 0.62 * h)))
    return [*parts, moved(block((w + 0.2, 0.14, 0.05), STONE), (x, wall - 0.03, z - 0.05))]


def _shutters(w: float, h: float, at: tuple[float, float], wall: float, of: Any) -> list[Mesh]:
    parts = []
    for s in (-1, 1):
        x = at[0] + s * (w / 2 + 0.04 + w / 4)
        parts.append(moved(block((w / 2, 0.035, h + 0.06), of), (x, wall - 0.02, at[1] + h / 2)))
        parts += [
            moved(block((w / 2 - 0.08, 0.02, 0.03), of), (x, wall - 0.042, z)) for z in np.arange(at[1] + 0.08, at[1] + h, 0.09)
        ]
    return parts


def _door(x: float, wall: float, color: str, number: str, w: float = 0.95, h: float = 2.05) -> list[Mesh]:
    """A panelled door with a frame, a step, a knob and its number."""
    leaf, inset = material(color, 0.5), material(color, 0.75)
    parts = [moved(block((w, 0.05, h), leaf), (x, wall - 0.01, h / 2 + 0.1))]
    for dz, tall in ((0.28, 0.42), (0.85, 0.5), (1.5, 0.5)):
        parts += [
            moved(block((0.34 * w, 0.03, tall), inset, 0.008), (x + s * 0.22 * w, wall - 0.035, dz + 0.22 + 0.1)) for s in (-1, 1)
        ]
    parts += [moved(block((0.1, 0.12, h + 0.2), WHITE), (x + s * (w / 2 + 0.05), wall - 0.02, h / 2 + 0.1)) for s in (-1, 1)]
    parts.append(moved(block((w + 0.3, 0.16, 0.13), WHITE), (x, wall - 0.03, h + 0.16)))
    parts.append(moved(disc(0.03, 0.05, material("#c9a54a", 0.3, 0.8), 0.008, 12), (x + 0.38 * w, wall - 0.03, 1.1), "x", 90))
    plate = material(rough=0.5, image=label(64, 64, "#20405e", "#f3f0e4", [(number, 0.6, 0.5)]))
    parts.append(moved(moved(panel(0.18, 0.18, plate), (0, 0, 0), "x", 90), (x + w / 2 + 0.26, wall - 0.012, 1.75)))
    return [*parts, moved(block((w + 0.5, 0.3, 0.1), STONE), (x, wall - 0.15, 0.05))]


def _gable(width: float, depth: float, eaves: float, ridge: float, wall: Any, tiles: Any, over: float = 0.3) -> list[Mesh]:
    """The triangles of wall under a roof whose ridge runs along x, and its two slopes, which stand out by `over`."""
    y, x = depth / 2, width / 2
    corners = np.array([[-y, eaves], [y, eaves], [0, ridge]])
    parts = []
    for s in (-1, 1):
        v = np.c_[np.full(3, s * x), corners]
        parts.append(dressed(Mesh(v, [[0, 1, 2] if s > 0 else [0, 2, 1]], process=False), wall, corners / TILE))
    pitch = np.arctan2(ridge - eaves, y)
    long = y / np.cos(pitch) + over
    for s in (-1, 1):
        slab = moved(block((width + 2 * over, long, 0.09), tiles, tile=TILE), (0, 0, 0), "x", -s * np.degrees(pitch))
        half = long / 2
        parts.append(moved(slab, (0, s * half * np.cos(pitch), ridge + 0.05 - half * np.sin(pitch))))
        edge = s * long * np.cos(pitch), ridge + 0.0 - long * np.sin(pitch)
        parts.append(moved(block((width + 2 * over, 0.08, 0.08), METAL), (0, edge[0] - s * 0.04, edge[1] + 0.02)))
    return [*parts, moved(block((width + 2 * over, 0.16, 0.08), tiles, tile=TILE), (0, 0, ridge + 0.08))]


def _sides(
    width: float, depth: float, windows: list[tuple[float, float, float, float]], glass: Any, frame: Any = WHITE
) -> list[Mesh]:
    """Windows (along, sill, width, height) in both ends and in the back."""
    parts: list[Mesh] = []
    for along, sill, w, h in windows:
        for degrees, wall in ((90, -width / 2), (-90, -width / 2), (180, -depth / 2)):
            parts += [moved(m, (0, 0, 0), "z", degrees) for m in _window(w, h, (along, sill), wall, glass, frame)]
    return parts


def _body(width: float, depth: float, height: float, wall: Any) -> list[Mesh]:
    """Walls and a stone plinth."""
    plinth = moved(block((width + 0.06, depth + 0.06, 0.3), STONE), (0, 0, 0.15))
    return [moved(block((width, depth, height), wall, tile=TILE), (0, 0, height / 2)), plinth]


def brick_cottage() -> list[Mesh]:
    """One storey of brick with shutters, a tiled roof and a chimney."""
    w, d, eaves, ridge = 6.6, 3.8, 2.75, 4.35
    wall, tiles = material(rough=0.95, image=ground.bricks()), material(rough=0.9, image=ground.roof_tiles())
    glass, green = material(rough=0.1, image=_pane_picture((196, 186, 168), 4)), material("#3f5f4a", 0.6)
    parts = [*_body(w, d, eaves, wall), *_gable(w, d, eaves, ridge, wall, tiles), *_door(0.55, -d / 2, "#7a2a24", "12")]
    for x in (-2.2, -0.75, 2.3):
        wide = 0.75 if x == -0.75 else 1.05
        parts += _window(wide, 1.15, (x, 0.95), -d / 2, glass)
        parts += _shutters(wide, 1.15, (x, 0.95), -d / 2, green) if wide > 1 else []
    parts += _sides(w, d, [(0.0, 1.0, 0.9, 1.1)], glass)
    stack = [
        moved(block((0.55, 0.5, 1.3), wall, tile=TILE), (1.9, 0.4, 4.05)),
        moved(block((0.65, 0.6, 0.08), STONE), (1.9, 0.4, 4.72)),
    ]
    return [
        *parts,
        *stack,
        *(moved(disc(0.09, 0.2, material("#8d4a35", 0.9), 0.01, 12), (1.9 + s * 0.13, 0.4, 4.75)) for s in (-1, 1)),
    ]


def town_house(
    low: tuple[int, int, int] = (206, 180, 130), high: tuple[int, int, int] = (226, 204, 158), door: str = "#23496b"
) -> list[Mesh]:
    """Two storeys of coloured plaster with a flat roof, a cornice and a balcony."""
    w, d, top = 5.2, 3.4, 4.9
    wall, trim = material(rough=0.95, image=plaster(low, high, 121, 256)), material("#d8d2c4", 0.8)
    glass = material(rough=0.1, image=_pane_picture((222, 214, 200), 9))
    parts = [*_body(w, d, top, wall), *_door(-1.45, -d / 2, door, "7")]
    parts += [
        moved(block((w + 0.1, d + 0.1, 0.12), trim), (0, 0, 2.5)),
        moved(block((w + 0.36, d + 0.36, 0.16), trim), (0, 0, top)),
    ]
    parts.append(moved(block((w + 0.2, d + 0.2, 0.14), trim), (0, 0, top - 0.14)))
    for x in (0.3, 1.75):
        parts += _window(0.95, 1.3, (x, 0.85), -d / 2, glass)
    for x in (-1.6, 1.6):
        parts += _window(0.9, 1.35, (x, 3.05), -d / 2, glass)
    parts += _window(1.0, 1.9, (0.0, 2.62), -d / 2, glass)
    rail = [
        moved(block((1.7, 0.03, 0.04), METAL), (0, -d / 2 - 0.16, 3.45)),
        moved(block((1.8, 0.22, 0.08), trim), (0, -d / 2 - 0.07, 2.6)),
    ]
    rail += [moved(block((0.018, 0.018, 0.82), METAL), (x, -d / 2 - 0.16, 3.03)) for x in np.linspace(-0.84, 0.84, 15)]
    pipe = tube([(2.5, -d / 2 - 0.06, 0.1), (2.5, -d / 2 - 0.06, 2.0), (2.5, -d / 2 - 0.06, top - 0.1)], 0.045, METAL, 10)
    return [*parts, *rail, pipe, *_sides(w, d, [(-0.0, 0.95, 0.8, 1.2), (0.0, 3.1, 0.8, 1.2)], glass)]


def corner_shop(sign: str = "BAKERY", cloth: str = "#b5382c") -> list[Mesh]:
    """A shop with large panes, a striped awning 80 cm deep, and its name above."""
    w, d, top = 6.4, 3.4, 3.5
    wall, front = (
        material(rough=0.95, image=ground.bricks((92, 84, 78), (150, 140, 128), (178, 172, 162), 131)),
        material("#2d4038", 0.5),
    )
    inside = material(rough=0.1, image=_shop_picture())
    parts = [*_body(w, d, top, wall), moved(block((w + 0.24, d + 0.24, 0.2), STONE), (0, 0, top))]
    parts.append(moved(block((w - 0.3, 0.1, 2.35), front), (0, -d / 2 - 0.02, 1.2)))
    for x, wide in ((-1.85, 2.1), (1.85, 2.1)):
        parts.append(moved(moved(panel(wide, 1.5, inside), (0, 0, 0), "x", 90), (x, -d / 2 - 0.076, 1.35)))
        parts += [moved(block((0.05, 0.05, 1.5), front), (x + s * wide / 2, -d / 2 - 0.08, 1.35)) for s in (-1, 0, 1)]
        parts.append(moved(block((wide + 0.2, 0.16, 0.06), STONE), (x, -d / 2 - 0.1, 0.58)))
    parts += _door(0.0, -d / 2 - 0.07, "#2d4038", "3")
    name = material(rough=0.6, image=label(512, 64, "#efe4c8", "#33271c", [(sign, 0.72, 0.5)]))
    parts.append(moved(block((w - 0.3, 0.08, 0.52), front), (0, -d / 2 - 0.04, 2.95)))
    parts.append(moved(moved(panel(3.6, 0.44, name), (0, 0, 0), "x", 90), (0, -d / 2 - 0.085, 2.95)))
    for k in range(16):
        stripe = material(cloth if k % 2 else "#ece6d8", 0.9)
        x = -2.95 + 5.9 * (k + 0.5) / 16
        parts.append(moved(block((5.9 / 16, 0.86, 0.015), stripe), (x, -d / 2 - 0.42, 2.48), "x", 22))
        parts.append(moved(block((5.9 / 16, 0.012, 0.16), stripe), (x, -d / 2 - 0.815, 2.245)))
    return [*parts, *_sides(w, d, [(0.6, 1.0, 0.9, 1.2)], material(rough=0.1, image=_pane_picture((180, 170, 150), 12)))]


def _shop_picture() -> Image.Image:
    """A lit shop behind glass: shelves with goods."""
    rng = np.random.default_rng(133)
    out = np.tile(np.linspace(70, 40, 128)[:, None, None] * np.array((1.0, 0.86, 0.66)), (1, 192, 1))
    for row in (40, 72, 104):
        x = 6
        while x < 182:
            wide, tall = rng.integers(8, 20), rng.integers(8, 18)
            out[row - tall : row, x : x + wide] = np.array((196, 142, 82)) * rng.uniform(0.6, 1.1) * rng.uniform(0.9, 1.1, 3)
            x += wide + rng.integers(1, 6)
        out[row : row + 3] = (96, 68, 46)
    y, x = np.mgrid[0:128, 0:192]
    shine = np.clip(1 - np.abs((x + 1.2 * y) % 190 - 60) / 26, 0, 1)[..., None] * 0.22
    return picture(out * (1 - shine) + 220 * shine)


def porch_house() -> list[Mesh]:
    """Painted weatherboards, a grey roof, and a porch on posts in front of the door."""
    w, d, eaves, ridge = 7.0, 4.2, 2.8, 4.5
    wall = material(rough=0.9, image=ground.boards())
    tiles = material(rough=0.9, image=ground.roof_tiles((58, 62, 68), (104, 108, 114), 137))
    glass = material(rough=0.1, image=_pane_picture((150, 168, 186), 17))
    parts = [*_body(w, d, eaves, wall), *_gable(w, d, eaves, ridge, wall, tiles), *_door(-0.9, -d / 2, "#c28a2e", "24")]
    for x in (-2.55, 0.75, 2.3):
        parts += _window(1.0, 1.2, (x, 0.95), -d / 2, glass, bars=1)
    parts.append(moved(block((2.0, 1.0, 0.08), tiles, tile=TILE), (-0.9, -d / 2 - 0.42, 2.56), "x", 14))
    parts.append(moved(block((1.9, 0.9, 0.12), STONE), (-0.9, -d / 2 - 0.45, 0.06)))
    for s in (-1, 1):
        parts.append(moved(block((0.1, 0.1, 2.35), WHITE), (-0.9 + s * 0.85, -d / 2 - 0.82, 1.2)))
        parts.append(moved(block((0.05, 0.75, 0.05), WHITE), (-0.9 + s * 0.85, -d / 2 - 0.42, 0.95)))
        parts += [moved(block((0.03, 0.03, 0.8), WHITE), (-0.9 + s * 0.85, -d / 2 - y, 0.53)) for y in np.arange(0.12, 0.8, 0.13)]
    for s in (-1, 1):
        parts.append(moved(block((0.12, d + 0.02, 0.12), WHITE), (s * w / 2, 0, eaves - 0.06)))
        parts += [moved(block((0.13, 0.13, eaves), WHITE), (s * w / 2, t * d / 2, eaves / 2)) for t in (-1, 1)]
    return [*parts, *_sides(w, d, [(0.0, 1.0, 0.9, 1.1)], glass)]


MAKERS = {f.__name__: f for f in (brick_cottage, town_house, corner_shop, porch_house)}
