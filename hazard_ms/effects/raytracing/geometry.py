"""Effects as real geometry, for a ray-traced picture: the quads that raster pictures spread out in a vertex shader.

It reads the effect entities of a scene as they are shown, whatever hazard they belong to, and adds one mesh of quads
that face the camera, one of the water's surface with its waves, and sheets of soot. Take the picture,
then `undress` the scene.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import PREFIX
from hazard_ms.effects.raytracing import hits, surfaces
from hazard_ms.effects.raytracing.pack import shows_effects
from hazard_ms.effects.raytracing.wind_spread import carried
from hazard_ms.effects.shaders.common import EMBER, FLAME, LEAF, SCORCH, SMOKE, SOOT, WATER
from hazard_ms.effects.textures import noise_texture

NEAR_LIMIT = 0.15  # quads nearer to the camera than this are left out [m] [ours]

Array = np.ndarray


@dataclass
class Quads:
    """Quads: their corners [m], [Q, 4, 3], the corners' x and y in the quad, [Q, 4, 2], and their lives, [Q, 3].

    A life is (kind + seed, light, strength).
    """

    corners: Array
    places: Array
    lives: Array

    def of(self, which: Array) -> Quads:
        """The quads for which `which`, [Q], holds."""
        return Quads(self.corners[which], self.places[which], self.lives[which])


def dress(scene: sapien.Scene, eye: sapien.Pose, time: float) -> list[sapien.Entity]:
    """Add the effects of `scene` as geometry that faces a camera at `eye` (x forward) at `time` [s].

    Returns the entities that were added; none if there is only SAPIEN's own pack, which would show panes of glass.
    """
    if not shows_effects():
        return []
    view = eye.to_transformation_matrix()
    found: list[Quads] = []
    added: list[sapien.Entity] = []
    air = np.ones(3)
    for entity, shape in shown_effects(scene):
        part, pose, air = (
            shape.parts[0],
            entity.pose.to_transformation_matrix(),
            np.asarray(shape.parts[0].material.base_color)[:3],
        )
        data, places = part.get_vertex_normal(), part.get_vertex_uv()
        kind = np.floor(data[0, 2])
        if kind == WATER:
            added.append(_entity(scene, surfaces.water(part.vertices, data, places, pose, time)))
        elif kind == SOOT:
            added.append(_entity(scene, surfaces.soot(data, places, part.material, time)))
        else:
            quads = spread(part.vertices, data, pose, view, part.material.transmission)
            # entities.py: each has a clock of its own, here a seed
            own = (part.material.transmission_roughness - time) / 10.0
            code = quads.lives[:, 0]
            quads.lives[:, 0] = np.where(code < SCORCH, (code + own) % 1.0 * 0.999, code)
            found.append(quads.of(np.floor(code) != EMBER))  # see sparks.py
    if found:
        quads = Quads(*(np.concatenate([getattr(q, name) for q in found]) for name in ("corners", "places", "lives")))
        near = np.linalg.norm(quads.corners.mean(1) - view[:3, 3], axis=-1) < NEAR_LIMIT
        near |= quads.corners[:, 0, 2] < meshes.NOWHERE  # what does not fly
        kept = quads.of(~near)
        if len(kept.corners):
            added.append(_entity(scene, _mesh(kept, time, air)))
    return added


def undress(scene: sapien.Scene, added: list[sapien.Entity]) -> None:
    """Remove the entities that `dress` has added."""
    for entity in added:
        scene.remove_entity(entity)


def shown_effects(scene: sapien.Scene) -> list[tuple[sapien.Entity, RenderShapeTriangleMesh]]:
    """The effect entities that can be seen, with their meshes."""
    shown = [e for e in scene.entities if e.name.startswith(PREFIX) and e.pose.p[2] > meshes.NOWHERE / 2]
    bodies = [(e, e.find_component_by_type(RenderBodyComponent)) for e in shown]
    return [(e, body.render_shapes[0]) for e, body in bodies if body.visibility > 0.0]


def _entity(scene: sapien.Scene, shape: RenderShapeTriangleMesh) -> sapien.Entity:
    body = RenderBodyComponent()
    body.attach(shape)
    body.disable_render_id()
    entity = sapien.Entity()
    entity.name = "picture"
    entity.add_component(body)
    scene.add_entity(entity)
    return entity


def _mesh(quads: Quads, time: float, air: Array) -> RenderShapeTriangleMesh:
    """The quads as one mesh; both sides are seen, since its material lets light through."""
    material = RenderMaterial(base_color=[*air, 1.0])
    material.base_color_texture = noise_texture()
    material.base_color = [*air, 1.0]  # a texture is only seen after a scalar has been set (SAPIEN 3.0.3)
    material.transmission = 1.0
    material.transmission_roughness = hits.EFFECT + time
    count = len(quads.corners)
    faces = (meshes.FACES[None] + 4 * np.arange(count, dtype=np.uint32)[:, None, None]).reshape(-1, 3)
    return surfaces.shape(
        quads.corners.reshape(-1, 3), faces, np.repeat(quads.lives, 4, 0), quads.places.reshape(-1, 2), material
    )


def spread(vertices: Array, data: Array, pose: Array, view: Array, strength: float) -> Quads:
    """The quads of one entity; EFFECT_VERT in shaders/common.py does the same per corner."""
    home, size, code = vertices[::4], data[::4, :2].copy(), data[::4, 2]
    kind, seed = np.floor(code), code % 1.0
    eye, right, upward = view[:3, 3], -view[:3, 1], view[:3, 2]
    anchor = home @ pose[:3, :3].T + pose[:3, 3]
    age = np.zeros(len(home))
    if kind[0] >= LEAF:
        anchor, across, up, age = carried(kind, seed, home, pose, eye)
    elif kind[0] >= SMOKE:
        anchor, size, age = _risen(kind, seed, home, size, pose)
        across, up = np.broadcast_to(right, anchor.shape), np.broadcast_to(upward, anchor.shape)
    else:
        across, up = _standing(kind, seed, anchor, size, eye, upward)
    low = np.where(kind == FLAME, 0.0, -1.0)[:, None]
    x, y = np.tile(meshes.CORNERS[:, 0], (len(home), 1)), np.where(meshes.CORNERS[:, 1] > 0, 1.0, low)
    # a weak flame fills only a part of its quad: nothing needs to be traced through the rest
    weak = (kind == FLAME)[:, None]
    x = x * np.where(weak, 0.5 + 0.5 * strength, 1.0)
    y = y * np.where(weak, max(strength, 0.02), 1.0)
    corners = (
        anchor[:, None] + across[:, None] * (x * size[:, :1])[..., None] + up[:, None] * (y * size[:, 1:])[..., None]
    )
    return Quads(corners, np.stack([x, y], -1), np.stack([code, age, np.full(len(home), strength)], -1))


def _standing(kind: Array, seed: Array, anchor: Array, size: Array, eye: Array, upward: Array) -> tuple[Array, Array]:
    """Edges of flames, which stand upright, and of scorch marks, which lie on the floor.

    They move `anchor` and `size` in place.
    """
    aloft = np.array([0.0, 0.0, 1.0])
    toward = eye - anchor
    far = np.linalg.norm(toward, axis=-1, keepdims=True)
    lean = meshes.unit(aloft + 0.45 * upward)
    flame = (kind == FLAME)[:, None]
    turned = np.stack([np.cos(6.28 * seed), np.sin(6.28 * seed), np.zeros_like(seed)], -1)
    across = np.where(flame, meshes.unit(np.cross(lean, toward)), turned)
    up = np.where(flame, lean, np.cross(aloft, turned))
    # not cut by the thing that burns
    anchor += np.where(flame, toward / far * np.minimum(0.6 * size[:, :1], 0.3 * far), 0.0)
    size[kind == SCORCH, 1] = size[kind == SCORCH, 0]
    return across, up


def _risen(kind: Array, seed: Array, home: Array, size: Array, pose: Array) -> tuple[Array, Array, Array]:
    """Places [m], sizes [m] and ages of smoke and embers: the entity's turn tells the phase."""
    ember = kind == EMBER
    phase = np.arctan2(pose[1, 0], pose[0, 0]) / (2 * np.pi)
    age = (phase * np.where(ember, 1.0 + np.floor(seed * 3.0), 1.0) + seed * 7.0) % 1.0
    rise = np.maximum(size[:, 1] - pose[2, 3], 0.3)
    sway = 2 * np.pi * (seed * 5.0 + age)
    drift = 0.10 * age[:, None] * np.stack([np.cos(sway), np.sin(sway)], -1)
    spread = np.where(ember, 0.35 * age, 0.0)[:, None] * np.stack([np.cos(seed * 40.0), np.sin(seed * 57.0)], -1)
    height = rise * np.where(ember, 0.8 * age, np.sqrt(age))
    anchor = pose[:3, 3] + home + np.column_stack([drift + spread, height])
    half = size[:, 0] * np.where(ember, 1.0 - 0.6 * age, 0.35 + 1.3 * age)
    return anchor, np.stack([half, half], -1), age
