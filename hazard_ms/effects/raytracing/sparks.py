"""Embers in a ray-traced picture: dots that are drawn into it after it has been denoised, as raster pictures have them.

An ember is smaller than a pixel, so that rays meet it now and then, and the denoiser takes that for noise. Here, as in
a raster picture, a pixel glows if its middle is on an ember that nothing solid hides.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import sapien
from numpy.typing import NDArray

from hazard_ms.effects.raytracing.geometry import shown_effects, spread
from hazard_ms.effects.raytracing.pack import shows_effects
from hazard_ms.effects.shaders.common import EMBER, SMOKE

GLOWING = (1.6, 0.55, 0.08)  # linear light of an ember, as in shaders/common.py
WEAKEST, OLDEST = 0.05, 0.95  # strength from which, and age up to which, embers glow, as there
NEAREST = 0.01  # distance along the camera's axis [m]


class Sparks(NamedTuple):
    """The embers of a scene, of which N can be seen: their middles in the world [m], [N, 3], and radii [m], [N]."""

    place: NDArray[np.float64]
    radius: NDArray[np.float64]


def sparks(scene: sapien.Scene, eye: sapien.Pose) -> Sparks:
    """The embers of `scene` as it is shown, for a camera at `eye` (x forward); none with SAPIEN's own pack."""
    view = eye.to_transformation_matrix()
    places, radii = [np.zeros((0, 3))], [np.zeros(0)]
    for entity, shape in shown_effects(scene) if shows_effects() else ():
        part = shape.parts[0]
        data, strength = part.get_vertex_normal(), part.material.transmission
        if np.floor(data[0, 2]) not in (SMOKE, EMBER) or strength < WEAKEST:
            continue
        quads = spread(part.vertices, data, entity.pose.to_transformation_matrix(), view, strength)
        seen = (np.floor(quads.lives[:, 0]) == EMBER) & (quads.lives[:, 1] < OLDEST)
        places.append(quads.corners[seen].mean(1))
        radii.append(0.5 * np.linalg.norm(quads.corners[seen, 1] - quads.corners[seen, 0], axis=-1))
    return Sparks(np.concatenate(places), np.concatenate(radii))


def lit_by(light: NDArray[np.float32], seen: Sparks, camera: Any) -> NDArray[np.float32]:
    """The linear `light`, [H, W, 3], of a picture that `camera` has just taken, with the embers `seen` in it."""
    if len(seen.radius) == 0:
        return light
    made, solid = light.copy(), -camera.get_picture("Position")[..., 2]  # [m] along the axis; 0: nothing is there
    world = np.column_stack([seen.place, np.ones(len(seen.place))])
    x, y, far = (world @ np.asarray(camera.get_extrinsic_matrix()).T).T[:3]
    height, width = solid.shape
    for k in np.flatnonzero(far > NEAREST):
        column, row = (camera.fx * x[k] / far[k] + camera.cx, camera.fy * y[k] / far[k] + camera.cy)
        wide, high = camera.fx * seen.radius[k] / far[k], camera.fy * seen.radius[k] / far[k]
        columns = np.arange(max(int(column - wide), 0), min(int(column + wide) + 1, width))
        rows = np.arange(max(int(row - high), 0), min(int(row + high) + 1, height))
        within = ((columns + 0.5 - column) / wide) ** 2 + ((rows[:, None] + 0.5 - row) / high) ** 2 <= 1.0
        there = solid[rows[:, None], columns]
        made[rows[:, None], columns] = np.where(
            (within & ((there <= 0.0) | (there > far[k])))[..., None], GLOWING, made[rows[:, None], columns]
        )
    return made
