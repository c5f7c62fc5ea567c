"""Trees and hedges that sway in the wind; see shaders/sway.py. Only the mode `full` has them, and labels never do."""

from __future__ import annotations

import numpy as np
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeBox, RenderShapeTriangleMesh

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import Effect, entities_of, make_effect
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.textures import noise_texture
from hazard_ms.spec import SceneSpec

NAME = "sway"  # of the entity: not entities.PREFIX, since in ray tracing nothing sways
FOLIAGE = ("tree", "hedge")  # categories of fixtures
MOST_PLANTS = 8  # that sway in one scene: the largest ones


def foliage(scene: sapien.Scene, spec: SceneSpec) -> Effect | None:
    """The trees and hedges of a scene as one hidden effect; None if there are none.

    Its pose tells the wind, see shaders/sway.py.
    """
    names = tuple(f.name for f in spec.fixtures if f.category in FOLIAGE)
    plants = [_Plant(entity) for entity in entities_of(scene, names)]
    largest = sorted((p for p in plants if p.height > 0.0), key=lambda p: -p.size)[:MOST_PLANTS]
    effect = make_effect(scene, noise_texture(), lambda material: _mesh(largest, material), 0) if largest else None
    if effect is not None:
        effect.entity.name = NAME
        effect.entity.find_component_by_type(RenderBodyComponent).shading_mode = pack.SWAY_PASS
    return effect


class _Plant:
    """A tree or hedge as it is drawn: `vertices` from its foot [m], world frame, [V, 3]; `faces` [T, 3]."""

    def __init__(self, entity: sapien.Entity) -> None:
        vertices, self.faces = meshes.surface(entity)
        pose = entity.pose.to_transformation_matrix()
        self.foot, self.label = pose[:3, 3], entity.per_scene_id
        self.vertices = vertices @ pose[:3, :3].T
        self.height = float(self.vertices[:, 2].max(initial=0.0))
        self.size = self.height * float(np.linalg.norm(np.ptp(self.vertices[:, :2], axis=0))) if self.height else 0.0

    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """The vertices [m], [V, 3], and faces, [T, 3], of the box around it."""
        unit = RenderShapeBox([0.5, 0.5, 0.5], RenderMaterial())
        low, high = self.vertices.min(0), self.vertices.max(0)
        return (low + high) / 2 + np.asarray(unit.vertices) * (high - low) / 2, np.asarray(unit.triangles)


def _mesh(plants: list[_Plant], material: RenderMaterial) -> RenderShapeTriangleMesh:
    """One mesh of all `plants` and of the boxes around them; see shaders/sway.py."""
    feet, places, marks, faces, count = [], [], [], [], 0
    for plant in plants:
        for sign, (vertices, triangles) in ((1, (plant.vertices, plant.faces)), (-1, plant.box())):
            feet.append(np.broadcast_to(plant.foot, vertices.shape))
            places.append(vertices)
            marks.append(np.broadcast_to([plant.height, sign * plant.label], (len(vertices), 2)))
            faces.append(triangles + count)
            count += len(vertices)
    corners = [np.concatenate(a).astype(np.float32) for a in (feet, places, marks)]
    return RenderShapeTriangleMesh(
        corners[0], np.concatenate(faces).astype(np.uint32), corners[1], corners[2], material
    )
