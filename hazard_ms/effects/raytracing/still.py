"""Single pictures of a scene through one of three shaders, from any viewpoint; ray-traced ones are denoised."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien

from hazard_ms.effects.raytracing.cutouts import mark_cutouts
from hazard_ms.effects.raytracing.denoise import MOST_BOUNCES, Image, denoised, developed, exposed
from hazard_ms.effects.raytracing.geometry import dress, undress
from hazard_ms.effects.raytracing.pack import ray_pack
from hazard_ms.effects.raytracing.sparks import lit_by, sparks
from hazard_ms.effects.shaders.pack import pack_folder
from hazard_ms.effects.streets.street import at_rest

BOUNCES = {"rt-fast": 1, "rt": MOST_BOUNCES}  # by shader
NEAR_PLANE, FAR_PLANE = 0.05, 120.0  # of what is seen [m]


@dataclass(frozen=True)
class Viewpoint:
    """The viewpoint of a picture: pose of the eye (x forward, z up), vertical angle [rad], size [pixels]."""

    pose: sapien.Pose
    angle: float
    width: int
    height: int
    spectator: bool = True  # not the robot's own eyes
    open_home: bool = False  # whether a home is cut open for it (`hazard_ms.effects.cutaway`)


class Photographer:
    """Takes pictures of one scene.

    SAPIEN compiles ray tracing anew if a camera is removed or anything is added to the scene. So ray-tracing cameras
    stay, one for each size, and effects stay until the pictures of them are taken.
    """

    def __init__(self, scene: sapien.Scene) -> None:
        """Take pictures of `scene`, which must have a renderer."""
        self._scene = scene
        mark_cutouts(scene)
        self._eyes: dict[tuple[int, int], Any] = {}  # by width and height

    @contextmanager
    def ready(self, view: Viewpoint, shader: str = "default", time: float = 0.0) -> Iterator[Callable[[int], Image]]:
        """Compile the shaders for pictures of the scene as it is shown now.

        Yields a function that takes one, [H, W, 3], RGB, given the samples per pixel (of ray tracing). `shader`:
        default (raster, with effects), rt-fast or rt; `time` [s] of flames and waves.
        """
        if shader == "default":
            yield lambda _: _raster(self._scene, view)
            return
        with at_rest(self._scene):
            embers = sparks(self._scene, view.pose)
            added = dress(self._scene, view.pose, time)
            try:
                eye = self._eye(view)
                exposed(self._scene, eye, BOUNCES[shader], 0)
                yield lambda samples: developed(
                    lit_by(denoised(*exposed(self._scene, eye, BOUNCES[shader], samples)), embers, eye)
                )
            finally:
                undress(self._scene, added)

    def _eye(self, view: Viewpoint) -> Any:
        key = view.width, view.height
        if key not in self._eyes:
            sapien.render.set_ray_tracing_denoiser("none")  # SAPIEN's own are for NVIDIA's cards alone
            self._eyes[key] = _camera(self._scene, view, ray_pack())
        camera = self._eyes[key]
        camera.set_fovy(view.angle, compute_x=True)
        camera.entity.set_pose(view.pose)
        return camera


def _raster(scene: sapien.Scene, view: Viewpoint) -> Image:
    camera = _camera(scene, view, pack_folder("full"))
    camera.take_picture()
    shown = camera.get_picture("Color")[..., :3]
    scene.remove_entity(camera.entity)
    return (
        np.ascontiguousarray(shown)
        if shown.dtype == np.uint8
        else (np.clip(shown, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    )


def _camera(scene: sapien.Scene, view: Viewpoint, pack: str) -> Any:
    """A camera at `view` in `scene`, which is brought up to date."""
    camera = sapien.render.RenderCameraComponent(view.width, view.height, pack)
    camera.set_fovy(view.angle, compute_x=True)
    camera.near, camera.far = NEAR_PLANE, FAR_PLANE
    entity = sapien.Entity()
    entity.name = "picture"
    entity.add_component(camera)
    entity.set_pose(view.pose)
    scene.add_entity(entity)
    scene.update_render()
    return camera
