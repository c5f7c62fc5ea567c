"""Cameras of the robot that are mounted elsewhere than in training, look elsewhere, and see wider or narrower."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import sapien
from torch import Tensor

from hazard_ms.simulation.chance import Chance
from hazard_ms.spec.perturbation import amount

# most by level, 0 to 3
ANGLES = (0.0, math.radians(5.0), math.radians(10.0), math.radians(20.0))  # about any axis [rad] [ours]
SHIFTS = (0.0, 0.01, 0.02, 0.04)  # in any direction but back, where the robot's head would hide the view [m] [ours]
ZOOMS = (0.0, 0.05, 0.10, 0.20)  # of the focal length, longer or shorter: log of the factor [-] [ours]
DRAWS = 8  # uniform numbers of a change: two directions of two each, a sign, and three amounts


class Change(NamedTuple):
    """The difference of a camera from that of training."""

    pose: sapien.Pose  # in the camera's own frame: ahead, left, up [m]
    angle: float  # by which it looks elsewhere [rad]
    zoom: float  # factor of the focal length [-]


def drawn(level: int, numbers: list[float]) -> Change:
    """The change of a `level`, from DRAWS uniform numbers between 0 and 1."""
    axis, way = _direction(*numbers[:2]), _direction(*numbers[2:4])
    way[0] = abs(way[0])
    angle, shift = amount(ANGLES[level], numbers[5]), amount(SHIFTS[level], numbers[6])
    turn = [math.cos(angle / 2), *(math.sin(angle / 2) * axis)]
    sign = 1.0 if numbers[4] < 0.5 else -1.0
    return Change(sapien.Pose(shift * way, turn), angle, math.exp(sign * amount(ZOOMS[level], numbers[7])))


def _direction(u: float, v: float) -> np.ndarray:
    """A unit vector, [3], all directions being equally likely for uniform numbers between 0 and 1."""
    z, angle = 2.0 * u - 1.0, 2.0 * math.pi * v
    flat = math.sqrt(1.0 - z * z)
    return np.array([flat * math.cos(angle), flat * math.sin(angle), z])


class MovedCameras:
    """The cameras of E robots, which are moved for each episode as its seed says."""

    def __init__(self, cameras: dict[str, Any], level: int) -> None:
        """Take ManiSkill's `cameras` by name where they are mounted; `level`: how far they are moved.

        Raises ValueError for a level above 0 where physics runs on a GPU.
        """
        if level and any(camera.camera.scene.gpu_sim_enabled for camera in cameras.values()):
            raise ValueError(f"camera in perturb must be 0 where physics runs on a GPU, got {level}")
        self._level, self._cameras = level, cameras
        self._mounted = {
            name: [(eye.local_pose, eye.fx, eye.fy) for eye in camera.camera._render_cameras]
            for name, camera in cameras.items()
        }
        self._seeds: list[int] = []

    def changes(self, name: str, seed: Tensor) -> list[Change]:
        """The difference of the camera called `name` from that of training in the episodes of `seed` [E]."""
        chance = Chance(len(seed))
        chance.seed = seed.cpu()
        return [drawn(self._level, row) for row in chance.uniform(f"perturbed camera {name}", DRAWS).tolist()]

    def show(self, seed: Tensor) -> None:
        """Mount the cameras as in the episodes of `seed` [E]; call it before a picture is taken."""
        if not self._level or self._seeds == (seeds := seed.tolist()):
            return
        self._seeds = seeds
        for name, camera in self._cameras.items():
            eyes = camera.camera._render_cameras
            for eye, (pose, fx, fy), change in zip(eyes, self._mounted[name], self.changes(name, seed), strict=True):
                eye.local_pose = pose * change.pose
                eye.set_focal_lengths(fx * change.zoom, fy * change.zoom)
            camera.camera._cached_local_pose = camera.camera._cached_intrinsic_matrix = None  # ManiSkill's copies
