"""Pictures of grounds, walls and roofs, out of doors and in. Deterministic; each covers 2 m x 2 m and tiles."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from patterns import Rgb, blend, noise, picture

SIZE = 512  # [pixels] of 2 m


def _grain(seed: int, size: int = SIZE) -> np.ndarray:
    return np.random.default_rng(seed).random((size, size))


def _soft(values: np.ndarray, times: int) -> np.ndarray:
    """Blurred across the edges, so that it still tiles."""
    for _ in range(times):
        values = sum(np.roll(values, s, axis) for axis in (0, 1) for s in (-1, 1)) / 8 + values / 2
    return (values - values.min()) / np.ptp(values)


def asphalt() -> Image.Image:
    """Dark binder with light stones, and soft patches."""
    stones = _soft(_grain(71), 1)
    out = blend((46, 47, 50), (112, 111, 109), stones**1.6 * 0.85 + 0.15 * noise(SIZE, 72, 4, 4))
    return picture(out * (0.96 + 0.08 * noise(SIZE, 73, 3, 3))[..., None])


def concrete(low: Rgb = (138, 136, 130), high: Rgb = (182, 179, 172), seed: int = 75) -> np.ndarray:
    return blend(low, high, 0.25 * _soft(_grain(seed), 1) + 0.4 * noise(SIZE, seed, 4, 32) + 0.35 * noise(SIZE, seed + 1, 4, 3))


def pavement(count: int = 4) -> Image.Image:
    """Concrete slabs of 50 cm with dark joints, each a little different."""
    edge = SIZE // count
    at = np.arange(SIZE)
    tone = np.random.default_rng(76).uniform(0.88, 1.07, (count, count))[at // edge][:, at // edge]
    out = concrete() * tone[..., None]
    joint = np.minimum(at % edge, edge - 1 - at % edge)
    shade = np.interp(joint, [0, 1, 3, 6], [0.5, 0.62, 0.93, 1.0])
    return picture(out * np.minimum(shade[:, None], shade[None])[..., None])


def grass(blades: int = 26000) -> Image.Image:
    """Short blades in all directions, lighter ones on top, over patches."""
    rng = np.random.default_rng(77)
    image = Image.new("RGB", (SIZE, SIZE), (44, 62, 26))
    draw = ImageDraw.Draw(image)
    patch = noise(SIZE, 78, 4, 4)
    at, angle, long = rng.uniform(0, SIZE, (blades, 2)), rng.uniform(0, 2 * np.pi, blades), rng.uniform(4, 11, blades)
    for k, ((x, y), a, n) in enumerate(zip(at, angle, long, strict=True)):
        t = np.clip(0.45 * k / blades + 0.3 * patch[int(y), int(x)] + 0.08 + rng.normal(0, 0.12), 0, 1)
        color = tuple(int(v) for v in np.array((54, 76, 30)) * (1 - t) + np.array((152, 164, 92)) * t)
        for sx in {0, SIZE if x < 12 else 0, -SIZE if x > SIZE - 12 else 0}:
            for sy in {0, SIZE if y < 12 else 0, -SIZE if y > SIZE - 12 else 0}:
                draw.line([x + sx, y + sy, x + sx + n * np.cos(a), y + sy + n * np.sin(a)], fill=color)
    return image


def _stones(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Voronoi cells that tile: the number of each pixel's cell, and distances to the nearest two points [pixels]."""
    from scipy.spatial import cKDTree

    points = np.random.default_rng(seed).uniform(0, SIZE, (count, 2))
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    distance, cell = cKDTree(points, boxsize=SIZE).query(np.stack([x, y], -1).reshape(-1, 2) + 0.25, k=2)
    return cell[:, 0].reshape(SIZE, SIZE), distance[:, 0].reshape(SIZE, SIZE), distance[:, 1].reshape(SIZE, SIZE)


def gravel(count: int = 5200) -> Image.Image:
    """Pebbles of 2 to 4 cm, rounded by shade."""
    cell, near, far = _stones(count, 81)
    rng = np.random.default_rng(82)
    tint = np.array((150, 142, 130)) * rng.uniform(0.62, 1.2, (count, 1)) * rng.uniform(0.95, 1.05, (count, 3))
    edge = np.clip((far - near) / 3.2, 0, 1)
    return picture(tint[cell] * (0.42 + 0.58 * edge)[..., None] * (0.92 + 0.16 * _soft(_grain(83), 1))[..., None])


def soil() -> Image.Image:
    """Brown earth with crumbs."""
    _, near, far = _stones(7000, 85)
    crumb = np.clip((far - near) / 4, 0, 1)
    out = blend((58, 42, 29), (120, 92, 66), 0.5 * noise(SIZE, 86, 6, 4) + 0.3 * crumb + 0.2 * _grain(87))
    return picture(out)


def bricks(low: Rgb = (112, 48, 36), high: Rgb = (172, 88, 66), mortar: Rgb = (172, 164, 152), seed: int = 91) -> Image.Image:
    """Running bond: bricks of 25 cm x 7.7 cm with their joints."""
    rows, columns = 26, 8
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    row = (y * rows).astype(int)
    along = (x * columns + 0.5 * (row % 2)) % columns
    tone = np.random.default_rng(seed).random((rows, columns))[row, along.astype(int)]
    out = blend(low, high, 0.65 * tone + 0.2 * noise(SIZE, seed, 5, 16) + 0.15 * _grain(seed))
    into = np.minimum(
        np.minimum(along % 1, 1 - along % 1) * SIZE / columns, np.minimum(y * rows % 1, 1 - y * rows % 1) * SIZE / rows
    )
    joint = np.clip(1.9 - into, 0, 1)[..., None]
    shade = np.clip(into / 3.0, 0, 1)[..., None] * 0.12 + 0.88
    lime = blend(tuple(int(0.85 * c) for c in mortar), mortar, _grain(seed + 1))
    return picture(out * shade * (1 - joint) + lime * joint)


def roof_tiles(low: Rgb = (96, 44, 32), high: Rgb = (160, 84, 60), seed: int = 95) -> Image.Image:
    """Rows of flat tiles, each row in the shade of the one above."""
    rows, columns = 12, 12
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    row = (y * rows).astype(int)
    along = (x * columns + 0.5 * (row % 2)) % columns
    tone = np.random.default_rng(seed).random((rows, columns))[row, along.astype(int)]
    side = np.clip(np.minimum(along % 1, 1 - along % 1) * 16, 0.35, 1)
    drop = np.interp(y * rows % 1, [0, 0.12, 0.3, 0.9, 1], [0.45, 0.75, 1, 1.06, 0.9])
    return picture(blend(low, high, 0.7 * tone + 0.3 * noise(SIZE, seed, 5, 8)) * (side * drop)[..., None])


def boards(low: Rgb = (150, 160, 164), high: Rgb = (206, 214, 214), rows: int = 14, seed: int = 97) -> Image.Image:
    """Weatherboards along x, painted."""
    y = np.arange(SIZE) * rows / SIZE % 1
    shade = np.interp(y, [0, 0.06, 0.12, 0.95, 1], [0.5, 0.62, 0.92, 1.05, 0.8])
    grain = 0.6 * noise(SIZE, seed, 5, 16, 0.6, stretch=16) + 0.4 * noise(SIZE, seed + 1, 3, 4)
    return picture(blend(low, high, grain) * shade[:, None, None])


def parquet(blocks: int = 4, staves: int = 4) -> Image.Image:
    """Light oak in a basket weave: squares of 25 cm, staves alternately along x and y."""
    rng = np.random.default_rng(101)
    count = 2 * blocks
    edge = SIZE // count
    grain = 0.7 * noise(SIZE, 102, 5, 24, 0.65, stretch=12) + 0.3 * noise(SIZE, 103, 4, 8, stretch=2)
    wood = blend((150, 108, 66), (214, 172, 120), grain)
    out = np.empty_like(wood)
    for i in range(count):
        for j in range(count):
            y, x = rng.integers(0, SIZE - edge, 2)
            piece = wood[y : y + edge, x : x + edge].copy()
            stave = np.arange(edge) * staves // edge
            piece *= rng.uniform(0.86, 1.1, staves)[stave][:, None, None]
            piece[np.arange(edge) * staves % edge < staves] *= 0.72
            piece[:, :1] *= 0.7
            out[i * edge : (i + 1) * edge, j * edge : (j + 1) * edge] = piece if (i + j) % 2 else piece.transpose(1, 0, 2)
    return picture(out)


def light_planks(rows: int = 12) -> Image.Image:
    """A floor of pale ash boards along x, 17 cm wide."""
    from patterns import planks

    dark = np.asarray(planks(SIZE, rows), dtype=float)
    lum = dark.mean(axis=2)
    t = np.clip((lum - 30) / 130, 0, 1)
    return picture(blend((148, 122, 92), (224, 202, 170), t))


def dark_tiles(count: int = 4) -> Image.Image:
    """Slate-coloured tiles of 50 cm."""
    rng = np.random.default_rng(105)
    at = np.arange(SIZE)
    edge = SIZE // count
    tone = rng.uniform(0.86, 1.12, (count, count))[at // edge][:, at // edge]
    vein = np.clip(1 - 9 * np.abs(noise(SIZE, 107, 5, 3) - 0.5), 0, 1) * 0.25
    out = blend((52, 55, 60), (92, 95, 100), 0.7 * noise(SIZE, 106, 6, 5) + vein) * tone[..., None]
    joint = at % edge < 3
    out[joint] = out[:, joint] = (118, 116, 112)
    return picture(out)


def wallpaper_stripes(ground: Rgb = (214, 206, 186), stripe: Rgb = (188, 176, 150), count: int = 16) -> Image.Image:
    """Upright stripes with a thin line at each edge; the paper's tooth."""
    x = np.arange(SIZE) * count / SIZE % 1
    mask = (
        np.where(x < 0.5, 0.0, 1.0) * 0.8
        + np.where(np.abs(x - 0.04) < 0.02, 1.0, 0.0)
        + np.where(np.abs(x - 0.46) < 0.02, 1.0, 0.0)
    )
    rows = np.tile(np.clip(mask, 0, 1), (SIZE, 1))
    return picture(blend(ground, stripe, rows) * (0.965 + 0.07 * _soft(_grain(111), 1))[..., None])


def wallpaper_flowers(ground: Rgb = (206, 214, 206), ink: Rgb = (132, 156, 146), petal: Rgb = (196, 150, 140)) -> Image.Image:
    """Sprigs in a half-drop repeat of 50 cm."""
    big = 2 * SIZE
    image = Image.new("RGB", (big, big), ground)
    draw = ImageDraw.Draw(image)
    step = big // 8
    for i in range(-1, 9):
        for j in range(-1, 5):
            cx, cy = (i + 0.5) * step, (2 * j + 0.5 + i % 2) * step
            draw.arc([cx - 34, cy - 6, cx + 8, cy + 58], 280, 80, fill=ink, width=5)
            for dx, dy, flip in ((-14, 40, 1), (12, 22, -1), (16, 48, -1)):
                draw.ellipse([cx + dx - 15, cy + dy - 6, cx + dx + 15, cy + dy + 6], fill=ink)
            for a in np.linspace(0, 2 * np.pi, 6)[:-1]:
                px, py = cx + 15 * np.cos(a), cy - 14 + 15 * np.sin(a)
                draw.ellipse([px - 12, py - 12, px + 12, py + 12], fill=petal)
            draw.ellipse([cx - 8, cy - 22, cx + 8, cy - 6], fill=(222, 196, 122))
    paper = np.asarray(image.resize((SIZE, SIZE), Image.Resampling.LANCZOS), dtype=float)
    return picture(paper * (0.965 + 0.07 * _soft(_grain(112), 1))[..., None])


def loop_carpet(low: Rgb = (36, 58, 74), high: Rgb = (84, 112, 126)) -> Image.Image:
    """A blue loop-pile carpet with flecks."""
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    loops = 0.5 + 0.25 * np.sin(x * np.pi / 4) + 0.25 * np.sin(y * np.pi / 4 + np.pi * ((x // 8) % 2))
    out = blend(low, high, 0.45 * loops + 0.35 * _grain(115) + 0.2 * noise(SIZE, 116, 4, 6))
    out[_grain(117) > 0.985] = (170, 160, 130)
    return picture(out)


TEXTURES = {  # names of materials in hazard_ms/scenes/shell.py
    "asphalt": asphalt,
    "pavement": pavement,
    "concrete": lambda: picture(concrete()),
    "grass": grass,
    "gravel": gravel,
    "soil": soil,
    "brick": bricks,
    "parquet": parquet,
    "light_wood": light_planks,
    "dark_tile": dark_tiles,
    "wallpaper_stripes": wallpaper_stripes,
    "wallpaper_flowers": wallpaper_flowers,
    "carpet_blue": loop_carpet,
}
