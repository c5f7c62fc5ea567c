"""One place seen through all three shaders, as linear light."""

from __future__ import annotations

import numpy as np
import sapien

from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.effects.raytracing.denoise import exposed
from hazard_ms.effects.raytracing.geometry import dress, undress
from hazard_ms.effects.raytracing.pack import ray_pack
from hazard_ms.effects.raytracing.still import BOUNCES, Viewpoint, _camera
from tests.worlds.looking import Place

SHADERS = ("default", "rt-fast", "rt")
ANGLE, SIDE = 1.3, 96  # of the cameras [rad], [pixels]


class Views:
    """`place` as raster pictures and rays see it."""

    def __init__(self, place: Place, samples: int = 16) -> None:
        self.place, self._samples = place, samples
        self._pose: sapien.Pose = place.camera.entity.pose
        self._eyes: dict[str, sapien.render.RenderCameraComponent] = {}

    def light(self, shader: str, frame: int) -> np.ndarray:
        """Linear light, [SIDE, SIDE, 3], at `frame`; raster pictures end at 1."""
        raster = self.place.picture(frame)["rgb"]
        if shader == "default":
            return np.power(raster / 255.0, 2.2)
        if shader not in self._eyes:
            view = Viewpoint(self._pose, ANGLE, SIDE, SIDE)
            self._eyes[shader] = _camera(self.place.scene, view, ray_pack())
        added = dress(self.place.scene, self._pose, frame / FRAMES_PER_SECOND)
        try:
            return exposed(self.place.scene, self._eyes[shader], BOUNCES[shader], self._samples)[0]
        finally:
            undress(self.place.scene, added)
