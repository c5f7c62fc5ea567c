"""Trees and hedges of our own: bark, twigs, and leaves painted on cards. Metres."""

from __future__ import annotations

from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from patterns import Rgb, blend, noise, picture
from shapes import Mesh, block, dressed, lathe, material, moved, tube

GREENS: dict[str, tuple[Rgb, Rgb]] = {  # darkest and lightest leaf
    "maple": ((44, 74, 24), (122, 158, 62)),
    "cypress": ((26, 52, 30), (70, 104, 52)),
    "box": ((36, 64, 26), (98, 134, 56)),
    "autumn": ((110, 62, 20), (196, 132, 48)),
    "laurel": ((30, 66, 34), (110, 150, 80)),
}


def bark(low: Rgb, high: Rgb, size: int = 128, seed: int = 61) -> Image.Image:
    """Rough grain that runs upwards."""
    return picture(blend(low, high, 0.7 * noise(size, seed, 4, 8, 0.7, stretch=8).T + 0.3 * noise(size, seed + 1, 4, 8)))


def leaves(kind: str, count: int, long: float, wide: float, size: int = 256, seed: int = 5, full: bool = False) -> Image.Image:
    """A cluster of leaves, `long` and `wide` as shares of the picture; around them nothing, or (`full`) darker leaves."""
    rng = np.random.default_rng(seed)
    low, high = (np.array(c) for c in GREENS[kind])
    image = Image.new("RGBA", (2 * size, 2 * size), (*(int(v) for v in low), 255 if full else 0))
    draw = ImageDraw.Draw(image)
    reach = 1.0 if full else 0.42
    for k in range(count):
        if full:
            at = rng.random(2) * 2 * size
        else:
            r, a = reach * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
            at = size + 2 * size * r * np.array([np.cos(a), np.sin(a)])
        tone = np.clip(rng.normal(0.25 + 0.6 * k / count, 0.15), 0, 1)  # those painted last lie on top and are lit
        color = tuple(int(v) for v in low * (1 - tone) + high * tone)
        angle, half = rng.uniform(0, 2 * np.pi), 2 * size * np.array([long, wide]) / 2 * rng.uniform(0.7, 1.15)
        t = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        shape = np.stack([half[0] * np.cos(t), half[1] * np.sin(t) * (1 - 0.35 * np.cos(t))], 1)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        for shift in [(0, 0)] if not full else [(i * 2 * size, j * 2 * size) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
            draw.polygon([tuple(p) for p in shape @ turn + at + shift], fill=(*color, 255))
    small = image.resize((size, size), Image.Resampling.LANCZOS)
    if full:
        return small.convert("RGB")
    pixels = np.array(small)
    pixels[..., 3] = np.where(pixels[..., 3] > 110, 255, 0)
    pixels[pixels[..., 3] == 0, :3] = low
    return Image.fromarray(pixels)


def cards(places: Any, normals: Any, size: Any, of: Any, middle: Any, seed: int = 3) -> Mesh:
    """Square cards seen from both sides, [N, 3] at `places`, about square to `normals`; lit as if they were a ball around `middle`."""
    rng = np.random.default_rng(seed)
    p, n = np.asarray(places, float), np.asarray(normals, float) + rng.normal(0, 0.35, np.shape(places))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    u = np.cross(n, rng.normal(size=n.shape))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(n, u)
    half = np.broadcast_to(size, len(p))[:, None] / 2 * rng.uniform(0.8, 1.2, (len(p), 1))
    corners = np.stack([p + half * (a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis=1)
    out = corners - np.asarray(middle, float)
    out /= np.linalg.norm(out, axis=2, keepdims=True)
    out = out + [0, 0, 0.25]
    out /= np.linalg.norm(out, axis=2, keepdims=True)
    vertices = np.concatenate([corners, corners], axis=1).reshape(-1, 3)
    one = np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]])
    faces = (np.arange(len(p))[:, None, None] * 8 + one).reshape(-1, 3)
    uv = np.tile([[0, 0], [1, 0], [1, 1], [0, 1]], (2 * len(p), 1)).astype(float)
    lit = np.concatenate([out, out], axis=1).reshape(-1, 3)
    return dressed(Mesh(vertices, faces, vertex_normals=lit, process=False), of, uv)


def _branch(points: list[Any], radius: float, of: Any) -> Mesh:
    """A bent, tapering limb."""
    return tube(points, np.linspace(radius, 0.35 * radius, len(points)), of, 7)


def _limbs(
    rng: Any, start: Any, ahead: Any, long: float, radius: float, depth: int, of: Any
) -> tuple[list[Mesh], list[np.ndarray]]:
    """A limb that forks `depth` times; returns its meshes and the ends of its twigs."""
    ahead = ahead / np.linalg.norm(ahead)
    bend = rng.normal(0, 0.12 * long, 3)
    points = [start, start + ahead * long * 0.5 + bend, start + ahead * long + 1.3 * bend + [0, 0, 0.08 * long]]
    sides = 7 if depth > 1 else 4
    parts, ends = [tube(points, np.linspace(radius, 0.5 * radius, 3), of, sides)], [points[2]]
    for _ in range(3 if depth > 0 else 0):
        away = ahead + rng.normal(0, 0.45, 3) + [0, 0, 0.15]
        away[2] = max(away[2], 0.15)
        at = points[1] + (points[2] - points[1]) * rng.uniform(0.2, 1.0)
        more, tips = _limbs(rng, at, away, long * rng.uniform(0.55, 0.75), 0.5 * radius, depth - 1, of)
        parts, ends = parts + more, ends + tips
    return parts, ends


def _upright(parts: list[Mesh]) -> list[Mesh]:
    """Drawn in on the wider sides, so that the stem, at x = y = 0, is the middle of the whole."""
    low = np.min([p.bounds[0] for p in parts], axis=0)
    high = np.max([p.bounds[1] for p in parts], axis=0)
    for part in parts:
        normals = part.vertex_normals.copy()
        half = np.minimum(-low, high)[:2]
        flat = part.vertices[:, :2]
        part.vertices = np.c_[np.where(flat < 0, flat * half / -low[:2], flat * half / high[:2]), part.vertices[:, 2]]
        part.vertex_normals = normals
    return parts


def round_tree(kind: str = "maple", height: float = 4.6, clear: float = 2.0, crown: float = 2.9, seed: int = 8) -> list[Mesh]:
    """A street tree: a clear stem up to `clear` metres, a rounded crown of leaves `crown` metres wide."""
    rng = np.random.default_rng(seed)
    wood = material(rough=0.95, image=bark((62, 48, 36), (122, 102, 82)))
    stem = tube([(0, 0, 0), (0.02, 0.01, 0.25), (0.03, 0.03, clear), (0.0, 0.0, height * 0.75)], [0.16, 0.11, 0.09, 0.03], wood, 12)
    parts: list[Mesh] = [stem]
    for a in np.linspace(0, 2 * np.pi, 6)[:-1] + 0.4:
        tip = np.array([0.33 * crown * np.cos(a), 0.33 * crown * np.sin(a), clear + 0.45 * (height - clear) + rng.normal(0, 0.1)])
        parts.append(_branch([(0.03, 0.03, clear * 0.95), 0.5 * tip + [0, 0, 0.5 * clear - 0.1], tip], 0.05, wood))
    middle, half = np.array([0, 0, (height + clear) / 2]), np.array([crown / 2, crown / 2, (height - clear) / 2])
    way = rng.normal(size=(520, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    lumps = 0.86 + 0.14 * np.sin(5 * way[:, 0] + 2) * np.sin(4 * way[:, 1]) * np.cos(4 * way[:, 2] + 1)
    depth = np.r_[np.full(380, 0.88), rng.uniform(0.45, 0.75, 140)]
    places = middle + way * half * (lumps * depth)[:, None]
    leaf = material(rough=0.9, image=leaves(kind, 190, 0.15, 0.085, seed=seed))
    return _upright([*parts, cards(places, way, 0.62, leaf, middle - [0, 0, 0.3 * half[2]])])


def cypress(height: float = 4.2, width: float = 1.0) -> list[Mesh]:
    """A slender evergreen, leafy down to 25 cm."""
    rng = np.random.default_rng(14)
    wood = material(rough=0.95, image=bark((58, 44, 34), (104, 84, 66)))
    stem = tube([(0, 0, 0), (0, 0, 0.2), (0, 0, 0.6)], [0.09, 0.07, 0.06], wood, 10)
    t = np.linspace(0, 1, 12)
    profile = width / 2 * np.sin(np.pi * t**0.62) ** 0.7 * 0.78
    dark = material(rough=1.0, image=leaves("cypress", 900, 0.1, 0.03, 128, full=True))
    core = lathe(np.c_[np.maximum(profile, 1e-4), 0.3 + t * (height - 0.45)], dark, 14)
    core.visual.uv = core.visual.uv * [3, 9]
    s, a = rng.random(430) ** 0.85 * 0.97, rng.uniform(0, 2 * np.pi, 430)
    r = np.interp(s, t, profile) * 1.1
    places = np.c_[r * np.cos(a), r * np.sin(a), 0.3 + s * (height - 0.45)]
    spray = material(rough=0.95, image=leaves("cypress", 230, 0.19, 0.035, seed=15))
    skin = cards(places, np.c_[np.cos(a), np.sin(a), 0.3 + 0 * a], 0.34, spray, (0, 0, 0))
    out = np.repeat(np.c_[np.cos(a), np.sin(a), 0.45 + 0 * a], 8, axis=0)
    skin.vertex_normals = out / np.linalg.norm(out, axis=1, keepdims=True)
    return [stem, core, skin]


def bare_tree(height: float = 4.4, seed: int = 27) -> list[Mesh]:
    """A tree in late autumn: forked limbs with a few last leaves."""
    rng = np.random.default_rng(seed)
    wood = material(rough=0.95, image=bark((72, 62, 54), (138, 126, 112)))
    parts: list[Mesh] = [tube([(0, 0, 0), (0, 0.01, 0.3), (0.03, 0.0, 1.9), (0.0, 0.02, 2.4)], [0.17, 0.12, 0.1, 0.09], wood, 12)]
    ends: list[np.ndarray] = []
    for k in range(6):
        a = 2 * np.pi * k / 6 + rng.uniform(-0.3, 0.3)
        ahead = np.array([np.cos(a), np.sin(a), rng.uniform(1.1, 2.2)])
        more, tips = _limbs(rng, np.array([0.01, 0.01, 1.85 + 0.1 * k]), ahead, height * 0.23, 0.065, 3, wood)
        parts, ends = parts + more, ends + tips
    places = np.array(ends)[rng.random(len(ends)) < 0.4]
    rust = material(rough=0.9, image=leaves("autumn", 26, 0.16, 0.09, 128, seed=seed))
    return _upright([*parts, cards(places, rng.normal(size=places.shape), 0.3, rust, (0, 0, 2.4))])


def hedge(long: float = 1.6, deep: float = 0.6, high: float = 1.0, kind: str = "box", card: float = 0.2) -> list[Mesh]:
    """A clipped hedge along x: a dark body under a skin of leaves; its ends meet those of the next."""
    rng = np.random.default_rng(33)
    e = np.array([long, deep, high])
    inside = material(rough=1.0, image=leaves(kind, 1400, 0.07, 0.045, 256, full=True))
    body = moved(block(e - [0.06, 0.1, 0.05], inside, tile=0.6), (0, 0, (high - 0.05) / 2))
    places, normals = [], []
    for axis, side in ((0, -1), (0, 1), (1, -1), (1, 1), (2, 1)):
        other = [k for k in range(3) if k != axis]
        count = int(e[other[0]] * e[other[1]] * 150)
        p = rng.uniform(-0.47, 0.47, (count, 3)) * (e - [0.04, 0.1, 0.08]) + [0, 0, high / 2]
        p[:, axis] = side * (e[axis] - 0.09) / 2 + (high / 2 if axis == 2 else 0)
        places.append(p)
        normals.append(np.tile(np.eye(3)[axis] * side, (count, 1)))
    leaf = material(rough=0.9, image=leaves(kind, 120, 0.2, 0.12, seed=34))
    skin = cards(np.concatenate(places), np.concatenate(normals), card, leaf, (0, 0, 0))
    out = np.repeat(np.concatenate(normals) + [0, 0, 0.3], 8, axis=0) + rng.normal(0, 0.12, (8 * sum(map(len, normals)), 3))
    skin.vertex_normals = out / np.linalg.norm(out, axis=1, keepdims=True)
    skin.vertices = np.clip(skin.vertices, [-long / 2, -deep / 2, 0.0], [long / 2, deep / 2, high])
    return [body, skin]


MAKERS = {f.__name__: f for f in (round_tree, cypress, bare_tree, hedge)}
