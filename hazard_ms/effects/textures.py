"""Procedural noise as a texture: one look-up instead of dozens of operations per pixel in the flame shader."""

from __future__ import annotations

import numpy as np
import sapien

NOISE_SIDE = 128  # [pixels]
OCTAVES = 5  # of the noise
FIRST_CELLS = 4  # of the coarsest octave, per side
FALL = 0.55  # amplitude of an octave relative to the one before


def noise(side: int = NOISE_SIDE, seed: int = 0) -> np.ndarray:
    """Tileable fractal value noise in 0..1 with a mean of about 0.5, [side, side], float32."""
    draw = np.random.default_rng(seed)
    total, weight, cells, amplitude = np.zeros((side, side), np.float32), 0.0, FIRST_CELLS, 1.0
    for _ in range(OCTAVES):
        grid = draw.random((cells, cells), dtype=np.float32)
        at = np.arange(side) * cells / side
        low = at.astype(int)
        t = (at - low).astype(np.float32)
        t = t * t * (3.0 - 2.0 * t)
        high = (low + 1) % cells
        top = grid[low][:, low] * (1 - t) + grid[low][:, high] * t
        bottom = grid[high][:, low] * (1 - t) + grid[high][:, high] * t
        total += amplitude * (top * (1 - t)[:, None] + bottom * t[:, None])
        weight, cells, amplitude = weight + amplitude, cells * 2, amplitude * FALL
    flat = total / weight
    low_value, high_value = np.quantile(flat, [0.02, 0.98])  # use the whole range
    return np.clip((flat - low_value) / (high_value - low_value), 0.0, 1.0)


def noise_texture() -> sapien.render.RenderTexture2D:
    """The noise as a texture on the renderer, in all four channels."""
    grey = (noise() * 255 + 0.5).astype(np.uint8)
    return sapien.render.RenderTexture2D(np.repeat(grey[..., None], 4, -1), "R8G8B8A8Unorm", mipmap_levels=5)


def ripples(side: int = NOISE_SIDE) -> np.ndarray:
    """Tileable ripples of water, [side, side, 4], float32, each channel in 0..1.

    The channels are the slopes along x and along y, about 0.5, the height, and another noise.
    """
    height = noise(side, seed=1)
    slopes = [(np.roll(height, -1, axis) - np.roll(height, 1, axis)) * (side / 16.0) for axis in (1, 0)]
    return np.stack([*(np.clip(0.5 + 0.5 * s, 0.0, 1.0) for s in slopes), height, noise(side, seed=2)], -1)


def ripple_texture() -> sapien.render.RenderTexture2D:
    """The ripples as a texture on the renderer."""
    return sapien.render.RenderTexture2D((ripples() * 255 + 0.5).astype(np.uint8), "R8G8B8A8Unorm", mipmap_levels=5)
