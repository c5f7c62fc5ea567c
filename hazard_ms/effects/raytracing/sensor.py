"""ManiSkill's cameras with its ray-tracing shaders, `shader_pack="rt"`, `"rt-med"` or `"rt-fast"`, for our tasks.

SAPIEN's own pack knows no flames or water, and its denoisers need a card of NVIDIA. Ours draws and denoises everywhere,
with as many samples per pixel as ManiSkill's shader of that name. Depth, positions, normals, albedo and labels are
those of raster pictures, pixel for pixel: a second camera in the same place sees them. Each picture takes seconds,
since SAPIEN compiles anew for a scene with other effects in it: for pictures of an episode now and then, not for
training.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import sapien
from mani_skill.render import ShaderConfig
from mani_skill.sensors.camera import Camera
from mani_skill.utils.common import to_tensor
from torch import Tensor

from hazard_ms.effects.raytracing.cutouts import mark_cutouts
from hazard_ms.effects.raytracing.denoise import MOST_BOUNCES, denoised, developed, exposed
from hazard_ms.effects.raytracing.geometry import dress, undress
from hazard_ms.effects.raytracing.pack import STOCK, ray_pack
from hazard_ms.effects.raytracing.sparks import lit_by, sparks
from hazard_ms.effects.shaders.pack import colour, pack_folder
from hazard_ms.effects.streets.street import at_rest
from hazard_ms.spec.undocumented import PREBUILT_SHADER_CONFIGS

SAMPLES, DEPTH = "ray_tracing_samples_per_pixel", "ray_tracing_path_depth"


def with_our_shaders(configs: dict[str, Any], num_envs: int, sim_backend: str = "auto") -> dict[str, Any]:
    """The settings of cameras, as ManiSkill takes them, with our ray tracing where `configs` asks for its own.

    Raises ValueError if more than one environment would be ray-traced, or one whose physics runs on a GPU.
    """
    made = {k: with_our_shaders(v, num_envs, sim_backend) if isinstance(v, dict) else v for k, v in configs.items()}
    for key in ("shader_pack", "shader_config"):
        asked = made.get(key)
        config = PREBUILT_SHADER_CONFIGS.get(asked) if isinstance(asked, str) else asked
        if isinstance(config, ShaderConfig) and config.shader_pack == STOCK:
            if num_envs > 1:
                raise ValueError(f"num_envs must be 1 for ray-traced pictures ({key}={_name(asked)}), got {num_envs}")
            if sim_backend not in ("auto", "cpu", "physx_cpu"):
                raise ValueError(
                    f"sim_backend must be 'cpu' for ray-traced pictures ({key}={_name(asked)}), got {sim_backend!r}"
                )
            made.pop("shader_pack", None)
            made["shader_config"] = replace(
                config, shader_pack=ray_pack(), texture_transforms={**config.texture_transforms, "Color": colour}
            )
            sapien.render.set_ray_tracing_denoiser("none")  # of cameras made from now on: pictures are denoised here
    return made


def _name(asked: str | ShaderConfig) -> str:
    return repr(asked if isinstance(asked, str) else asked.shader_pack)


class RayCamera(Camera):
    """A camera of one environment that ManiSkill has made with a shader of ours."""

    def __init__(self, made: Camera, clock: Callable[[], float]) -> None:
        """Take over the camera `made`; `clock` tells the time [s] of flames and waves."""
        self.__dict__.update(vars(made))
        self._clock = clock
        mark_cutouts(self.camera.scene.sub_scenes[0])
        self._twin = self._rasterising()
        self._textures: dict[str, Tensor] = {}

    def capture(self) -> None:
        """Take a picture. Effects are in the scene only while it is taken."""
        (scene,), (eye,) = self.camera.scene.sub_scenes, self.camera._render_cameras
        config = self.config.shader_config
        settings = config.shader_pack_config
        self._twin.entity.set_pose(eye.global_pose)
        self._twin.set_perspective_parameters(eye.near, eye.far, eye.fx, eye.fy, eye.cx, eye.cy, eye.skew)
        scene.update_render()
        self._twin.take_picture()
        taken = {name: self._twin.get_picture(name) for name in config.texture_names if name != "Color"}
        with at_rest(scene):
            embers = sparks(scene, eye.global_pose)
            added = dress(scene, eye.global_pose, self._clock())
            try:
                light = denoised(*exposed(scene, eye, min(settings[DEPTH], MOST_BOUNCES), settings[SAMPLES]))
                taken["Color"] = developed(lit_by(light, embers, eye))
            finally:
                undress(scene, added)
        scene.update_render()
        self._textures = {name: to_tensor(image)[None].to(self.camera.scene.device) for name, image in taken.items()}

    def _rasterising(self) -> Any:
        """A camera that sees what this one does, but rasterised."""
        (scene,), (eye,) = self.camera.scene.sub_scenes, self.camera._render_cameras
        twin = sapien.render.RenderCameraComponent(eye.width, eye.height, pack_folder("full"))
        entity = sapien.Entity()
        entity.name = "labels"
        entity.add_component(twin)
        scene.add_entity(entity)
        return twin

    def get_obs(
        self,
        rgb: bool = True,
        depth: bool = True,
        position: bool = True,
        segmentation: bool = True,
        normal: bool = False,
        albedo: bool = False,
        apply_texture_transforms: bool = True,
    ) -> dict[str, Tensor]:
        """The images of the last picture, [1, H, W, 3] or [1, H, W, 1] each, as ManiSkill's cameras give them.

        The texture "Color" is in bytes, depth and positions are in [mm].
        """
        asked = {
            "rgb": rgb,
            "depth": depth,
            "position": position,
            "segmentation": segmentation,
            "normal": normal,
            "albedo": albedo,
        }
        wanted = {k for k, yes in asked.items() if yes}
        config, seen = self.config.shader_config, dict[str, Tensor]()
        for name, given in config.texture_names.items():
            if wanted.intersection(given):
                data = self._textures[name]
                seen |= config.texture_transforms[name](data) if apply_texture_transforms else {name: data}
        return {k: v for k, v in seen.items() if k in wanted or not apply_texture_transforms}


def take_over(cameras: dict[str, Camera], clock: Callable[[], float]) -> None:
    """Replace those of `cameras` that have our shader by cameras that take pictures with it.

    Raises ValueError for a camera with SAPIEN's own ray tracing.
    """
    for name, camera in cameras.items():
        pack = camera.config.shader_config.shader_pack
        if pack == ray_pack():
            cameras[name] = RayCamera(camera, clock)
        elif pack == STOCK:
            raise ValueError(
                f"shader_pack of the camera {name!r} must be 'rt', 'rt-med' or 'rt-fast' for ray tracing with effects, "
                "got SAPIEN's own; set it in sensor_configs or human_render_camera_configs, not by shader_dir"
            )
