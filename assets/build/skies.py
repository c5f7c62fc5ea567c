"""Skies of our own around the whole sphere: day, storm, evening, night, as cubes with all their blurred levels (KTX).

SAPIEN would blur a panorama anew in every process, for a minute without a graphics card; from these files it reads what it needs.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from patterns import noise

SIDE = 192  # [pixels] of a face of the cube
CLOUDS = 1024  # [pixels] of the square of cloud overhead

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Sky:
    """Light of a sky: linear red, green, blue; 1 is a white wall in the sun."""

    zenith: Rgb
    horizon: Rgb
    cloud: Rgb  # where light falls on it
    shade: Rgb  # of its thick middle
    cover: float  # share of the sky behind clouds, 0 to 1
    soft: float  # of the clouds' edges
    sun: tuple[float, float]  # azimuth from +x to +y, height [degrees]
    glow: Rgb  # around the sun
    disc: float  # brightness of the sun itself; 0: hidden
    ground: Rgb
    seed: int


SKIES = {
    "sky_day": Sky(
        (0.10, 0.24, 0.58), (0.52, 0.68, 0.86), (1.0, 0.99, 0.96), (0.58, 0.62, 0.68), 0.34, 0.16, (235, 48), (0.5, 0.45, 0.35), 30.0,
        (0.16, 0.16, 0.14), 3,
    ),
    "sky_storm": Sky(
        (0.18, 0.20, 0.23), (0.38, 0.40, 0.42), (0.46, 0.48, 0.50), (0.13, 0.145, 0.165), 0.93, 0.75, (235, 40), (0.05, 0.05, 0.05), 0.0,
        (0.10, 0.10, 0.095), 11,
    ),
    "sky_evening": Sky(
        (0.09, 0.13, 0.30), (0.86, 0.46, 0.24), (0.95, 0.52, 0.34), (0.22, 0.19, 0.26), 0.42, 0.22, (170, 7), (0.9, 0.42, 0.12), 16.0,
        (0.10, 0.08, 0.07), 7,
    ),
    "sky_night": Sky(
        (0.006, 0.010, 0.022), (0.026, 0.030, 0.042), (0.050, 0.056, 0.072), (0.010, 0.012, 0.018), 0.40, 0.30, (130, 44),
        (0.02, 0.02, 0.025), 0.9, (0.006, 0.006, 0.007), 5,
    ),
}  # fmt: skip


def _directions() -> np.ndarray:
    """Where SAPIEN 3.0.3 shows each pixel of the faces +x, -x, +y, -y, +z, -z of a cube whose y is up: [6, SIDE, SIDE, 3], world frame."""
    steps = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    u, v = np.meshgrid(steps, steps)
    one = np.ones_like(u)
    faces = [(one, -v, -u), (-one, -v, u), (u, one, v), (u, -one, -v), (u, -v, one), (-u, -v, -one)]
    way = np.stack([np.stack([x, z, y], -1) for x, y, z in faces])
    return way / np.linalg.norm(way, axis=-1, keepdims=True)


def _overhead(field: np.ndarray, way: np.ndarray, scale: float) -> np.ndarray:
    """`field` spread out on a layer above the viewer, seen along `way`; the layer curves down to the horizon."""
    reach = 1.0 / (np.maximum(way[..., 2], 0.0) + 0.11)
    u, v = ((way[..., k] * reach * scale) % 1.0 * CLOUDS for k in (0, 1))
    i, j = u.astype(int), v.astype(int)
    s, t = u - i, v - j
    a, b = field[i % CLOUDS, j % CLOUDS], field[(i + 1) % CLOUDS, j % CLOUDS]
    c, d = field[i % CLOUDS, (j + 1) % CLOUDS], field[(i + 1) % CLOUDS, (j + 1) % CLOUDS]
    return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t


def cube(sky: Sky) -> np.ndarray:
    """Linear light on the faces of a cube, [6, SIDE, SIDE, 3]."""
    way = _directions()
    up = np.clip(way[..., 2], 0.0, 1.0)[..., None]
    azimuth, height = np.radians(sky.sun)
    sun = np.array([np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)])
    toward = np.clip(way @ sun, -1.0, 1.0)[..., None]
    light = np.array(sky.horizon) + (np.array(sky.zenith) - np.array(sky.horizon)) * (1 - (1 - up) ** 3.2)
    away = 0.5 - 0.5 * toward
    light = light * (1 - 0.45 * away * (np.array(sky.glow).max() > 0.6)) + np.array(sky.glow) * np.clip(toward, 0, 1) ** 6
    light = light + sky.disc * np.clip((toward - 0.9994) / 0.0003, 0, 1)
    field = noise(CLOUDS, sky.seed, 8, 3, 0.56)
    body, lit = _overhead(field, way, 0.22), _overhead(np.roll(field, (int(18 * sun[0]), int(18 * sun[1])), (0, 1)), way, 0.22)
    edge = np.quantile(field, 1 - sky.cover)
    thick = np.clip((body - edge) / sky.soft / np.ptp(field), 0, 1)[..., None]
    thick = thick * thick * (3 - 2 * thick)
    bright = np.clip(0.62 + 5.0 * (body - lit)[..., None] - 0.55 * thick * (body[..., None] - edge) / (1 - edge), 0, 1)
    cloud = (
        np.array(sky.shade)
        + (np.array(sky.cloud) - np.array(sky.shade)) * bright
        + 0.5 * np.array(sky.glow) * np.clip(toward, 0, 1) ** 10
    )
    shown = thick * np.clip(up * 9 - 0.15, 0, 1)
    light = light * (1 - shown) + cloud * shown
    below = np.clip(-way[..., 2] * 14, 0, 1)[..., None]
    return light * (1 - below) + np.array(sky.ground) * below


def write(name: str, path: Path) -> None:
    """Write the sky `name` as KTX; SAPIEN blurs it."""
    import sapien

    with tempfile.TemporaryDirectory() as folder:
        files = [f"{folder}/{face}.png" for face in range(6)]
        for file, light in zip(files, cube(SKIES[name]), strict=True):
            shown = (np.clip(light, 0.0, 1.0) ** (1 / 2.2) * 255 + 0.5).astype(np.uint8)
            Image.fromarray(shown).convert("RGBA").save(file)
        sapien.render.RenderCubemap(*files).export(str(path))
