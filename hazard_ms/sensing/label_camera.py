"""A camera that sees depth and labels without colours, in a third of the time of a full picture."""

from __future__ import annotations

from typing import Any

import sapien
from mani_skill.sensors.camera import Camera
from mani_skill.utils.common import to_tensor
from torch import Tensor

from hazard_ms.effects.shaders.glance import TEXTURES, glance_pack
from hazard_ms.spec.undocumented import PREBUILT_SHADER_CONFIGS


class LabelCamera:
    """A camera in the place of another one, for one environment."""

    def __init__(self, eye: Any, pack: str) -> None:
        """Put a camera with the shaders `pack` where SAPIEN's camera `eye` is."""
        self._camera, self._eye = sapien.render.RenderCameraComponent(eye.width, eye.height, pack), eye
        eye.entity.add_component(self._camera)
        self.follow()

    @classmethod
    def beside(cls, camera: Camera, scene: Any) -> LabelCamera | None:
        """One in the place of ManiSkill's `camera` of its `scene`, while that stands.

        None for scenes whose poses are on a GPU, and for a SAPIEN with unknown shaders.
        """
        pack = glance_pack()
        if scene.gpu_sim_enabled or pack is None:
            return None
        return cls(camera.camera._render_cameras[0], pack)

    def follow(self) -> None:
        """Move to where the other camera is, and look as it does; call it before the scene's `update_render`."""
        eye = self._eye
        self._camera.local_pose = eye.local_pose
        self._camera.set_perspective_parameters(eye.near, eye.far, eye.fx, eye.fy, eye.cx, eye.cy, eye.skew)

    def take(self) -> dict[str, Tensor]:
        """A picture: "depth" in [mm] and "segmentation", [1, H, W, 1] each, as those of ManiSkill's cameras.

        Call it after the scene's `update_render`.
        """
        made, seen = PREBUILT_SHADER_CONFIGS["default"].texture_transforms, dict[str, Tensor]()
        self._camera.take_picture()
        for name in TEXTURES:
            seen |= made[name](to_tensor(self._camera.get_picture(name))[None])
        return {name: seen[name] for name in ("depth", "segmentation")}
