"""Viewpoints of pictures: free places of a scene at the height of the robot's eyes, looking level or down."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import sapien
import torch
from numpy.typing import NDArray

from hazard_ms.simulation.clearance import in_the_way, in_walls

CLEARANCE = 0.3  # from the camera's upright axis to all things and walls, at least [m] [ours]
EYES, SWAY = 1.1, 0.1  # height of the head of Fetch, and how much higher or lower a camera may be [m] [ours]
DOWN = math.radians(35.0)  # by which a camera looks down, at most [ours]
AT_ONCE = 32  # places that are drawn at a time [ours]
MOST_DRAWS = 20  # times that places are drawn for one picture [ours]
NEAREST, FARTHEST = 0.5, 5.0  # distance of a thing that a picture is meant for [m] [ours]
CENTRAL = 0.8  # share of the field of view, about its middle, in which such a thing stands [ours]


def viewpoints(env: Any, rng: np.random.Generator, wanted: NDArray[np.bool_], angle: float) -> Iterator[sapien.Pose]:
    """Poses [m] of cameras (x forward, z up) in the first environment of `env`, drawn with `rng`, without end.

    One of the things that are `wanted`, [B], stands in the field of view, `angle` [rad], of every pose, as far as one
    is found; walls and other things may hide it. Raises ValueError where the floor has no free place.
    """
    goals = env.world.position[0][torch.from_numpy(wanted)].cpu().numpy()
    while True:
        spare = None
        for _ in range(MOST_DRAWS):
            poses = list(_drawn(env, rng))
            spare = poses[0] if poses else spare
            found = next((pose for pose in poses if not len(goals) or _in_view(pose, goals, angle)), None)
            if found is not None:
                break
        if found is None and spare is None:
            raise ValueError(f"scene must have free floor for a camera, got none in {env.specs[0].name}")
        yield spare if found is None else found


def _drawn(env: Any, rng: np.random.Generator) -> Iterator[sapien.Pose]:
    """Some poses at free places."""
    size = np.asarray(env.specs[0].room.size)
    places = torch.from_numpy(rng.uniform(0.0, size, (AT_ONCE, 2))).float().to(env.device)
    looks = rng.uniform((-SWAY, 0.0, -math.pi), (SWAY, DOWN, math.pi), (AT_ONCE, 3))  # height, pitch, yaw
    free = ~in_walls(env.world, 0, places, CLEARANCE)
    rows = torch.nonzero(free).flatten()
    free[rows] &= ~in_the_way(env.world, 0, places[rows], CLEARANCE).any(-1)
    for (x, y), (height, pitch, yaw) in zip(places[free].tolist(), looks[free.cpu().numpy()].tolist(), strict=True):
        yield sapien.Pose([x, y, EYES + height], _turned(pitch, yaw))


def _turned(pitch: float, yaw: float) -> list[float]:
    """The quaternion (w, x, y, z) of a camera that looks `pitch` [rad] down and `yaw` [rad] anticlockwise from +x."""
    (c, s), (a, b) = (math.cos(yaw / 2), math.sin(yaw / 2)), (math.cos(pitch / 2), math.sin(pitch / 2))
    return [c * a, -s * b, c * b, s * a]


def _in_view(pose: sapien.Pose, goals: NDArray[np.float32], angle: float) -> bool:
    """Whether one of the points `goals` [m], [P, 3], is in the middle part of the field of view, `angle` [rad]."""
    local = (goals - pose.p) @ pose.to_transformation_matrix()[:3, :3]
    ahead = local[:, 0]
    reach = math.tan(angle / 2) * CENTRAL * ahead
    inside = (np.abs(local[:, 1:]) < reach[:, None]).all(-1)
    return bool((inside & (ahead > NEAREST) & (ahead < FARTHEST)).any())
