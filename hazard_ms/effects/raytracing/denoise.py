"""The three steps of a ray-traced picture: exposed by SAPIEN, denoised, developed."""

from __future__ import annotations

import importlib
import logging
from functools import cache
from typing import Any

import numpy as np
import sapien
from numpy.typing import NDArray

MOST_BOUNCES = 3  # of a path, where water costs none; further ones are ambient light [ours]
KNEE = 0.75  # brightness from which highlights are compressed instead of cut off [ours]
DENOISER = "pyoidn"  # Intel Open Image Denoise on the CPU; optional

Image = NDArray[np.uint8]
_log = logging.getLogger(__name__)


def exposed(scene: sapien.Scene, camera: Any, bounces: int, samples: int) -> tuple[NDArray[np.float32], ...]:
    """Linear light, albedo and normals, [H, W, 3] each, of a camera with our ray-tracing pack.

    With 0 samples it only compiles the shaders.
    """
    camera.set_property("spp", samples)
    camera.set_property("maxDepth", bounces)
    scene.update_render()  # else SAPIEN adds to the picture that it has
    camera.take_picture()
    light, albedo, normal = (
        camera.get_picture(name)[..., :3].astype(np.float32) for name in ("HdrColor", "Albedo", "Normal")
    )
    return np.nan_to_num(light, nan=0.0, posinf=0.0), albedo, normal


def denoised(
    light: NDArray[np.float32], albedo: NDArray[np.float32], normal: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Linear light, [H, W, 3], without the noise of few samples, guided by albedo and normals, [H, W, 3] each.

    Without an installed denoiser it stays as it is.
    """
    module = denoiser()
    if module is None:
        return light
    guides = {"albedo": np.clip(albedo, 0.0, 1.0), "normal": np.clip(np.nan_to_num(normal), -1.0, 1.0)}
    result: NDArray[np.float32] = module.denoise(np.ascontiguousarray(light), **guides, hdr=True)
    return result


@cache
def denoiser() -> Any:
    """The module that denoises, or None if it is not installed; a warning then says once how to get it."""
    try:
        return importlib.import_module(DENOISER)
    except (ImportError, OSError) as fault:  # OSError: its library is for another machine
        _log.warning("ray-traced pictures stay noisy (%s): pip install %s cffi", fault, DENOISER)
        return None


def developed(light: NDArray[np.float32]) -> Image:
    """The picture of linear light, [H, W, 3]: like raster pictures, but bright lights keep their colour longer."""
    shown = np.maximum(light, 0.0)
    over = np.maximum(shown - KNEE, 0.0)
    shown = np.minimum(shown, KNEE) + (1.0 - KNEE) * (1.0 - np.exp(-over / (2.0 * (1.0 - KNEE))))
    return (np.power(shown, 1.0 / 2.2) * 255.0 + 0.5).astype(np.uint8)
