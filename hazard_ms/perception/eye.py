"""A camera that can be put anywhere in an environment: colours with hazards, and depth and labels of what is behind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sapien
import torch
from numpy.typing import NDArray
from sapien.render import RenderBodyComponent

from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.effects.raytracing.still import Image, Photographer, Viewpoint
from hazard_ms.effects.shaders.pack import LABELS, pack_folder
from hazard_ms.sensing.camera import NOTHING
from hazard_ms.sensing.senses.senses import Frame

NEAR_PLANE, FAR_PLANE = 0.05, 60.0  # of what is seen [m]; depth in 16 bits ends at 65.5 m
DEEPEST = 65535  # [mm]
TO_GL = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # x right, y up, z back, from SAPIEN's axes


@dataclass(frozen=True)
class Shot:
    """One picture: `labels` as in `sensing.camera`, depth along the optical axis, and the camera's matrices."""

    rgb: Image  # [H, W, 3]
    depth: NDArray[np.uint16]  # [H, W] [mm]; 0 where there is nothing
    labels: NDArray[np.int64]  # [H, W]
    intrinsic: NDArray[np.float64]  # [3, 3] [pixels]
    cam2world: NDArray[np.float64]  # [4, 4], of a camera that looks along its -z axis with y up


@dataclass(frozen=True)
class Sensed:
    """A picture as sensors give it: the colours and depth of a shot, or what murk leaves of them, and warmth."""

    rgb: Image  # [H, W, 3]
    depth: NDArray[np.uint16]  # [H, W] [mm]; 0 where there is nothing
    thermal: NDArray[np.float32] | None = None  # [H, W] [C]
    told: Mapping[str, Any] = field(default_factory=dict)  # fields of its row in the COCO file

    @classmethod
    def of(cls, env: Any, shot: Shot, rgb: Image, name: str, thermal: bool, degraded: bool) -> Sensed:
        """The picture of `shot`, with colours `rgb`, in the first environment of `env`; noise depends on its `name`."""
        if not thermal and not degraded:
            return cls(rgb, shot.depth)
        given = (shot.depth.astype(np.float32) * 1e-3, shot.labels, shot.intrinsic, shot.cam2world)
        depth, labels, *camera = (torch.from_numpy(np.ascontiguousarray(a))[None].to(env.device) for a in given)
        frame = Frame(depth, labels, camera[0].float(), camera[1].float(), name)
        senses = env.observer.senses
        warmth = senses.thermal(frame)[0].cpu().numpy() if thermal else None
        if not degraded:
            return cls(rgb, shot.depth, warmth)
        colours = torch.from_numpy(np.ascontiguousarray(rgb))[None].to(env.device)
        colour, left, kept = senses.degraded(colours, depth, frame)
        millimetres = np.clip(np.rint(left[0].cpu().numpy() * 1000.0), 0, DEEPEST).astype(np.uint16)
        told = {"degraded": True, "transmission": round(float(kept.mean()), 4)}
        return cls(colour[0].cpu().numpy(), millimetres, warmth, told)


class Eye:
    """The camera in the first environment of a `HazardEnv`, whose robot is hidden from now on."""

    def __init__(self, env: Any, size: int, angle: float) -> None:
        """Pictures have sides of `size` pixels and show `angle` [rad]. Raises ValueError where nothing can draw."""
        if not env.observer.renders:
            raise ValueError("render_backend must be a renderer, got none: see `hazard-ms doctor`")
        self._env, self._size, self._angle = env, size, angle
        self._scene: sapien.Scene = env.scene.sub_scenes[0]
        self._label_of = env.observer.labels[0].cpu().numpy()
        self._cameras: dict[str, Any] = {}  # by effects mode
        self._photographer: Photographer | None = None
        hide(env)

    def show(self) -> None:
        """Show the hazards and the light as they are now; call it once before the pictures of a frame."""
        self._env.observer.show()

    def shot(self, pose: sapien.Pose, mode: str) -> Shot:
        """The raster picture from `pose` (x forward, z up) with effects of `mode` (full, fast, off)."""
        camera = self._camera(mode)
        camera.entity.set_pose(pose)
        self._scene.update_render()
        camera.take_picture()
        colour = camera.get_picture("Color")[..., :3]
        rgb = colour if colour.dtype == np.uint8 else (np.clip(colour, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
        if mode == "fast":
            packed = camera.get_picture(LABELS)
            depth, ids = -packed[..., 2].astype(np.int64), packed[..., 3]
        else:
            # towards zero, as the fast pack and ManiSkill round
            depth = (-1000.0 * camera.get_picture("Position")[..., 2]).astype(np.int64)
            ids = camera.get_picture("Segmentation")[..., 1]
        labels = self._label_of[ids.astype(np.int64)]
        millimetres = np.where(labels == NOTHING, 0, np.clip(depth, 0, DEEPEST)).astype(np.uint16)
        intrinsic = np.asarray(camera.get_intrinsic_matrix(), np.float64)
        return Shot(np.ascontiguousarray(rgb), millimetres, labels, intrinsic, cam2world(pose))

    def ray_traced(self, pose: sapien.Pose, shader: str, samples: int) -> Image:
        """The colours of `shot`, [H, W, 3], through `shader` (rt-fast, rt), with so many `samples` a pixel."""
        if self._photographer is None:
            self._photographer = Photographer(self._scene)
        view = Viewpoint(pose, self._angle, self._size, self._size)
        time = int(self._env.world.frame[0]) / FRAMES_PER_SECOND
        with self._photographer.ready(view, shader, time) as take:
            return take(samples)

    def alone(self, pose: sapien.Pose, things: list[int]) -> dict[int, NDArray[np.bool_]]:
        """The pixels, [H, W], that each of `things`, indices along B, would fill if nothing were in front of it."""
        bodies = [
            (entity.per_scene_id, body)
            for entity in self._scene.entities
            for body in entity.components
            if isinstance(body, RenderBodyComponent) and body.is_enabled
        ]
        made = {}
        for thing in things:
            others = [body for number, body in bodies if self._label_of[min(number, len(self._label_of) - 1)] != thing]
            for body in others:
                body.disable()
            try:
                made[thing] = self.shot(pose, "off").labels == thing
            finally:
                for body in others:
                    body.enable()
        return made

    def _camera(self, mode: str) -> Any:
        if mode not in self._cameras:
            camera = sapien.render.RenderCameraComponent(self._size, self._size, pack_folder(mode))
            camera.set_fovy(self._angle, compute_x=True)
            camera.near, camera.far = NEAR_PLANE, FAR_PLANE
            entity = sapien.Entity()
            entity.name = "picture"
            entity.add_component(camera)
            self._scene.add_entity(entity)
            self._cameras[mode] = camera
        return self._cameras[mode]


def cam2world(pose: sapien.Pose) -> NDArray[np.float64]:
    """The matrix, [4, 4] [m], of a camera at `pose` (x forward, z up), for axes x right, y up, z back."""
    matrix = pose.to_transformation_matrix().astype(np.float64)
    matrix[:3, :3] = matrix[:3, :3] @ TO_GL
    return matrix


def hide(env: Any) -> None:
    """Let nobody see the robots of `env` and their bags, nor their shadows."""
    links = [part.entity for link in env.agent.robot.links for part in link._objs]
    for entity in [*links, *(bag._objs[0] for row in env.bags for bag in row)]:
        body = entity.find_component_by_type(RenderBodyComponent)
        if body is not None:
            body.disable()
