"""Hot air above a fire, through which the picture wavers; see shaders/shimmer.py. Only the mode `full` has it."""

from __future__ import annotations

import numpy as np
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import Effect, make_effect, seed
from hazard_ms.effects.shaders import pack

NAME = "shimmer_"  # of its entities: not entities.PREFIX, since ray tracing shows no hot air
COLUMN_SIZE = (0.42, 1.80)  # half width and height of a column [m] [ours]
FOOT_HEIGHT = 0.05  # above the middle of what burns [m] [ours]
HEAT = 8  # kind of quad: the next after those of shaders/common.py


def hot_air(scene: sapien.Scene, texture: RenderTexture2D, number: int) -> Effect:
    """A hidden column of hot air, to be shown above a fire with its strength 0..1 and the time [s]."""

    def column(material: RenderMaterial) -> RenderShapeTriangleMesh:
        one = np.ones(1)
        return meshes.quads(
            np.array([[0.0, 0.0, FOOT_HEIGHT]]), np.array([COLUMN_SIZE]), HEAT * one, seed(number) * one, material
        )

    effect = make_effect(scene, texture, column, number)
    assert effect is not None  # there always is a mesh
    effect.entity.name = f"{NAME}{number}"
    effect.entity.find_component_by_type(RenderBodyComponent).shading_mode = pack.AIR_PASS
    return effect
