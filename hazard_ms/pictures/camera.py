"""One picture of a scene through one of three shaders, from wherever one likes; ray-traced ones are denoised."""

from __future__ import annotations

import importlib
import logging
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sapien
from mani_skill.render import PREBUILT_SHADER_CONFIGS
from numpy.typing import NDArray

from hazard_ms.effects import shader_config, shader_pack
from hazard_ms.effects.ray_geometry import dress, undress
from hazard_ms.effects.ray_pack import ray_pack

BOUNCES = {"rt-fast": 1, "rt": 3}  # of a path, where water costs none; further ones are ambient light [ours]
NEAR, FAR = 0.05, 120.0  # of what is seen [m]
KNEE = 0.75  # brightness from which highlights are compressed instead of cut off [ours]
TINY = 16  # of the picture that compiles [pixels]
DENOISER = "pyoidn"  # Intel Open Image Denoise on the CPU; optional

Image = NDArray[np.uint8]
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class View:
    """From where a picture is taken: pose of the eye (x forward, z up), vertical angle [rad], size [pixels]."""

    pose: sapien.Pose
    angle: float
    width: int
    height: int


class Photographer:
    """Takes pictures of one scene.

    SAPIEN compiles ray tracing anew when one of its cameras goes, so ray-tracing ones stay: one for each size and quality.
    """

    def __init__(self, scene: sapien.Scene) -> None:
        """Of `scene`, which must have a renderer."""
        self._scene = scene
        self._eyes: dict[tuple[int, int, int, int], Any] = {}  # by width, height, bounces and samples, which stay as a camera is made

    def prepare(self, view: View, shader: str) -> None:
        """Compile what ray-traced pictures need: a scene's first two do, be they as tiny as these."""
        if shader == "default" or self._eyes:
            return
        tiny = View(view.pose, view.angle, TINY, TINY)
        for _ in range(2):
            self._traced(tiny, 1, 1, 0.0)

    def photograph(self, view: View, shader: str = "default", samples: int = 4, time: float = 0.0) -> Image:
        """A picture of the scene as it is shown now, [H, W, 3], RGB.

        `shader`: default (raster, with effects), rt-fast or rt; `samples` per pixel of the latter; `time` [s] of flames and waves.
        """
        if shader == "default":
            return _raster(self._scene, view)
        self.prepare(view, shader)
        light, albedo, normal = self._traced(view, BOUNCES[shader], samples, time)
        return developed(denoised(np.nan_to_num(light, nan=0.0, posinf=0.0), albedo, normal))

    def _traced(self, view: View, bounces: int, samples: int, time: float) -> tuple[NDArray[np.float32], ...]:
        """Linear light, albedo and normals, [H, W, 3] each."""
        added = dress(self._scene, view.pose, time)
        try:
            camera = self._eye(view, bounces, samples)
            camera.take_picture()
            return tuple(camera.get_picture(name)[..., :3].astype(np.float32) for name in ("HdrColor", "Albedo", "Normal"))
        finally:
            undress(self._scene, added)

    def _eye(self, view: View, bounces: int, samples: int) -> Any:
        key = view.width, view.height, bounces, samples
        if key not in self._eyes:
            _settings(bounces, samples)
            self._eyes[key] = _camera(self._scene, view, ray_pack())
        camera = self._eyes[key]
        camera.set_fovy(view.angle, compute_x=True)
        camera.entity.set_pose(view.pose)
        self._scene.update_render()
        return camera


def _raster(scene: sapien.Scene, view: View) -> Image:
    pack = PREBUILT_SHADER_CONFIGS[shader_config("full")].shader_pack
    camera = _camera(scene, view, str(shader_pack._stock() / pack))
    camera.take_picture()
    shown = camera.get_picture("Color")[..., :3]
    scene.remove_entity(camera.entity)
    return np.ascontiguousarray(shown) if shown.dtype == np.uint8 else (np.clip(shown, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def _settings(bounces: int, samples: int) -> None:
    """Of cameras that are made from now on."""
    sapien.render.set_ray_tracing_samples_per_pixel(samples)
    sapien.render.set_ray_tracing_path_depth(bounces)
    sapien.render.set_ray_tracing_denoiser("none")


def _camera(scene: sapien.Scene, view: View, pack: str) -> Any:
    """A camera at `view` in `scene`, which shows the present."""
    camera = sapien.render.RenderCameraComponent(view.width, view.height, pack)
    camera.set_fovy(view.angle, compute_x=True)
    camera.near, camera.far = NEAR, FAR
    entity = sapien.Entity()
    entity.name = "picture"
    entity.add_component(camera)
    entity.set_pose(view.pose)
    scene.add_entity(entity)
    scene.update_render()
    return camera


def denoised(light: NDArray[np.float32], albedo: NDArray[np.float32], normal: NDArray[np.float32]) -> NDArray[np.float32]:
    """Linear light [H, W, 3] without the noise of few samples, guided by albedo and normals; as it is where no denoiser is installed."""
    module = denoiser()
    if module is None:
        return light
    guides = {"albedo": np.clip(albedo, 0.0, 1.0), "normal": np.clip(np.nan_to_num(normal), -1.0, 1.0)}
    result: NDArray[np.float32] = module.denoise(np.ascontiguousarray(light), **guides, hdr=True)
    return result


@cache
def denoiser() -> Any:
    """The module that denoises, or None where it is not installed: then says once how to get it."""
    try:
        return importlib.import_module(DENOISER)
    except (ImportError, OSError) as fault:  # OSError: its library is for another machine
        _log.warning("ray-traced pictures stay noisy (%s): pip install %s cffi", fault, DENOISER)
        return None


def developed(light: NDArray[np.float32]) -> Image:
    """Linear light as a picture: as raster pictures show it, but highlights keep their colour a while longer."""
    shown = np.maximum(light, 0.0)
    over = np.maximum(shown - KNEE, 0.0)
    shown = np.minimum(shown, KNEE) + (1.0 - KNEE) * (1.0 - np.exp(-over / (2.0 * (1.0 - KNEE))))
    return (np.power(shown, 1.0 / 2.2) * 255.0 + 0.5).astype(np.uint8)
