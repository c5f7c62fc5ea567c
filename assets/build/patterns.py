"""Pictures that we draw ourselves: materials of rooms, fabrics, labels. Deterministic, and they tile where they should."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

Rgb = tuple[int, int, int]


def noise(size: int, seed: int, octaves: int = 5, first: int = 4, fade: float = 0.55, stretch: int = 1) -> np.ndarray:
    """Smooth noise in 0..1 that tiles, [size, size]; `stretch` makes it so many times longer along rows."""
    rng = np.random.default_rng(seed)
    total, weight = np.zeros((size, size)), 1.0
    for octave in range(octaves):
        ky = first * 2**octave
        kx = max(1, ky // stretch)
        grid = np.pad(rng.random((ky, kx)), ((0, 1), (0, 1)), mode="wrap")
        y, x = np.arange(size) * ky / size, np.arange(size) * kx / size
        i, j = y.astype(int), x.astype(int)
        s, t = (f * f * (3 - 2 * f) for f in (y - i, x - j))
        rows = grid[i] * (1 - s)[:, None] + grid[i + 1] * s[:, None]
        total += weight * (rows[:, j] * (1 - t) + rows[:, j + 1] * t)
        weight *= fade
    return (total - total.min()) / np.ptp(total)


def blend(low: Rgb, high: Rgb, amount: np.ndarray) -> np.ndarray:
    return np.array(low) * (1 - amount[..., None]) + np.array(high) * amount[..., None]


def picture(pixels: np.ndarray) -> Image.Image:
    return Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8))


def planks(size: int = 512, rows: int = 8) -> Image.Image:
    """A wooden floor: boards along x, 2 m square at 8 boards of 25 cm or less."""
    rng = np.random.default_rng(11)
    grain = 0.65 * noise(size, 1, 5, 16, 0.6, stretch=16) + 0.35 * noise(size, 2, 4, 8, 0.6, stretch=4)
    out, y = blend((104, 66, 36), (176, 124, 76), grain), np.arange(size)
    row, x = y * rows // size, np.arange(size)
    for r in range(rows):
        shift = rng.integers(0, size)
        board = ((x + shift) % size) * 2 // size
        tone = rng.uniform(0.82, 1.12, 2)[board]
        lines = row == r
        out[lines] = np.roll(out[lines], rng.integers(0, size), axis=1) * tone[None, :, None]
        seam = np.isin((x + shift) % (size // 2), (0, 1))
        out[np.ix_(lines, seam)] *= 0.55
    out[(y * rows % size) < rows] *= 0.5
    return picture(out)


def tiles(size: int = 512, count: int = 6) -> Image.Image:
    """Square tiles with grout: edge 33 cm at 6 tiles on 2 m."""
    rng = np.random.default_rng(5)
    edge = size / count
    row = (np.arange(size) / edge).astype(int)
    tone = rng.uniform(0.93, 1.05, (count, count))[row][:, row]
    out = blend((188, 182, 170), (222, 217, 206), noise(size, 21, 6, 6)) * tone[..., None]
    grout = np.arange(size) % edge < 3
    out[grout] = out[:, grout] = (138, 134, 127)
    return picture(out)


def carpet(size: int = 512) -> Image.Image:
    fibre = np.random.default_rng(3).random((size, size))
    return picture(blend((86, 82, 80), (142, 135, 128), 0.6 * fibre + 0.4 * noise(size, 31, 5, 8)))


def plaster(low: Rgb, high: Rgb, seed: int, size: int = 512) -> Image.Image:
    """Rolled paint: fine grain with soft large patches."""
    fine = np.random.default_rng(seed).random((size, size))
    return picture(blend(low, high, 0.25 * fine + 0.45 * noise(size, seed, 3, 64) + 0.3 * noise(size, seed + 1, 3, 4)))


def leaf_of_door(size: int = 512) -> Image.Image:
    grain = noise(size, 41, 5, 16, 0.6, stretch=12).T
    return picture(blend((122, 78, 44), (168, 116, 70), grain))


def wood(low: Rgb = (96, 58, 30), high: Rgb = (150, 98, 55), size: int = 256, seed: int = 1) -> Image.Image:
    """Grain along y."""
    rings = 0.5 + 0.5 * np.sin((np.arange(size) / size * 6 + 1.2 * noise(size, seed, 3, 4, stretch=4).T) * 2 * np.pi)
    return picture(blend(low, high, 0.3 * rings + 0.7 * noise(size, seed + 1, 5, 16, 0.6, stretch=16).T))


def fabric(ground: Rgb, thread: Rgb, stripes: int = 0, size: int = 256, seed: int = 7) -> Image.Image:
    """A weave, with `stripes` along y if any."""
    y, x = np.mgrid[0:size, 0:size]
    weave = 0.5 + 0.25 * np.sin(x * np.pi / 2) + 0.25 * np.sin(y * np.pi / 2)
    out = blend(tuple(int(0.85 * c) for c in ground), ground, 0.5 * weave + 0.5 * noise(size, seed))
    if stripes:
        out[(x * stripes * 2 // size) % 2 == 1] *= np.array(thread) / 255.0
    return picture(out)


def wicker(size: int = 256) -> Image.Image:
    y, x = np.mgrid[0:size, 0:size]
    strand = np.abs(np.sin(y * np.pi / 8 + np.pi / 2 * ((x // 16) % 2)))
    return picture(blend((120, 82, 44), (206, 160, 104), 0.75 * strand + 0.25 * noise(size, 17)))


def label(width: int, height: int, ground: str, ink: str, lines: list[tuple[str, float, float]], band: str = "") -> Image.Image:
    """Words on a coloured ground: (text, height of the letters, middle from above), both as fractions of `height`."""
    image = Image.new("RGB", (width, height), ground)
    draw = ImageDraw.Draw(image)
    if band:
        draw.rectangle([0, int(0.36 * height), width, int(0.64 * height)], fill=band)
    for text, tall, at in lines:
        font = ImageFont.load_default(size=max(8, int(tall * height)))
        draw.text((width / 2, at * height), text, fill=ink, font=font, anchor="mm")
    return image
