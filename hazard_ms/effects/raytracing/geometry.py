"""Effects as real geometry, for a ray-traced picture: the quads that raster pictures spread out in a vertex shader.

It reads the effect entities of a scene as they are shown, whatever hazard they belong to, and adds one mesh of quads
that face the camera and one of the water's surface with its waves. Take the picture, then `undress` the scene.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import PREFIX
from hazard_ms.effects.raytracing import hits
from hazard_ms.effects.raytracing.pack import shows_effects
from hazard_ms.effects.raytracing.wind_spread import carried
from hazard_ms.effects.shaders.common import EMBER, FLAME, LEAF, SCORCH, SMOKE, WATER
from hazard_ms.effects.textures import noise_texture

NEAR_LIMIT = 0.15  # quads nearer to the camera than this are left out [m] [ours]
TRANSPARENT, REFRACTION, SMOOTH = 0.97, 1.33, 0.02  # water's transmission, index of refraction, roughness
WATER_TINT = (0.86, 0.94, 0.93)  # linear, of water at its surface [ours]
WAVE_CELL = 0.06  # of the water's mesh [m] [ours]
MOST_CELLS = 160  # of it along one side of a piece of water
WAVES = 7  # sines that make up the surface [ours]
WAVE_SLOPE = 0.022  # of each sine [ours]

Array = np.ndarray


@dataclass
class Quads:
    """Quads: their corners [m], [Q, 4, 3], the corners' x and y in the quad, [Q, 4, 2], and their lives, [Q, 3].

    A life is (kind + seed, light, strength).
    """

    corners: Array
    places: Array
    lives: Array


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
    for entity, shape in _shown(scene):
        part, pose, air = (
            shape.parts[0],
            entity.pose.to_transformation_matrix(),
            np.asarray(shape.parts[0].material.base_color)[:3],
        )
        if np.floor(part.get_vertex_normal()[0, 2]) == WATER:
            added.append(
                _entity(scene, _water(part.vertices, part.get_vertex_normal(), part.get_vertex_uv(), pose, time))
            )
        else:
            quads = _spread(part.vertices, part.get_vertex_normal(), pose, view, part.material.transmission)
            # entities.py: each has a clock of its own, here a seed
            own = (part.material.transmission_roughness - time) / 10.0
            code = quads.lives[:, 0]
            quads.lives[:, 0] = np.where(code < SCORCH, (code + own) % 1.0 * 0.999, code)
            found.append(quads)
    if found:
        quads = Quads(*(np.concatenate([getattr(q, name) for q in found]) for name in ("corners", "places", "lives")))
        near = np.linalg.norm(quads.corners.mean(1) - view[:3, 3], axis=-1) < NEAR_LIMIT
        near |= quads.corners[:, 0, 2] < meshes.NOWHERE  # what does not fly
        kept = Quads(quads.corners[~near], quads.places[~near], quads.lives[~near])
        if len(kept.corners):
            added.append(_entity(scene, _mesh(kept, time, air)))
    return added


def undress(scene: sapien.Scene, added: list[sapien.Entity]) -> None:
    """Remove the entities that `dress` has added."""
    for entity in added:
        scene.remove_entity(entity)


def _shown(scene: sapien.Scene) -> list[tuple[sapien.Entity, RenderShapeTriangleMesh]]:
    """The effect entities that can be seen, with their meshes."""
    shown = [e for e in scene.entities if e.name.startswith(PREFIX) and e.pose.p[2] > meshes.NOWHERE / 2]
    return [(e, e.find_component_by_type(RenderBodyComponent).render_shapes[0]) for e in shown]


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
    return _shape(
        quads.corners.reshape(-1, 3), faces, np.repeat(quads.lives, 4, 0), quads.places.reshape(-1, 2), material
    )


def _shape(
    vertices: Array, faces: Array, normals: Array, places: Array, material: RenderMaterial
) -> RenderShapeTriangleMesh:
    """A mesh with its faces side by side, in which rays find them many times faster."""
    faces = faces[side_by_side(vertices[faces].mean(1))]
    data = (
        np.ascontiguousarray(a, t)
        for a, t in ((vertices, np.float32), (faces, np.uint32), (normals, np.float32), (places, np.float32))
    )
    return RenderShapeTriangleMesh(*data, material)


def side_by_side(points: Array) -> Array:
    """The order, [P] indices, of points, [P, 3], in which each half, half of a half, and so on, is beside the other.

    Mesa's lavapipe puts triangles into its tree as they come; graphics cards sort them anyway.
    """
    order, place = np.arange(len(points)), np.arange(len(points))
    size = 1 << max(len(points) - 1, 0).bit_length()
    while size > 1:
        here, group, first = points[order], place // size, np.arange(0, len(points), size)
        extent = np.maximum.reduceat(here, first) - np.minimum.reduceat(here, first)
        order = order[np.lexsort((here[place, extent.argmax(1)[group]], group))]
        size //= 2
    return order


def _spread(vertices: Array, data: Array, pose: Array, view: Array, strength: float) -> Quads:
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
    lean = _unit(aloft + 0.45 * upward)
    flame = (kind == FLAME)[:, None]
    turned = np.stack([np.cos(6.28 * seed), np.sin(6.28 * seed), np.zeros_like(seed)], -1)
    across = np.where(flame, _unit(np.cross(lean, toward)), turned)
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


def _water(vertices: Array, data: Array, place: Array, pose: Array, time: float) -> RenderShapeTriangleMesh:
    """The surface: the hazard's level at its corners, then finer cells with waves."""
    level = pose[2, 3] - pose[1, 0] / max(pose[0, 0], 1e-3) * data[:, 0]
    corners = np.column_stack([place, level]).reshape(-1, 4, 3)
    points, faces, first = [], [], 0
    for a, b, c, d in corners:
        if max(a[2], b[2], c[2], d[2]) <= 0.0:
            continue
        wide, deep = (int(np.clip(np.ceil(np.linalg.norm(e[:2] - a[:2]) / WAVE_CELL), 1, MOST_CELLS)) for e in (b, d))
        u, v = np.meshgrid(np.linspace(0, 1, wide + 1), np.linspace(0, 1, deep + 1))
        weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], -1).reshape(-1, 4)
        points.append(weights @ np.stack([a, b, c, d]))
        corner = (np.arange(deep)[:, None] * (wide + 1) + np.arange(wide)[None]).reshape(-1, 1)
        faces.append(first + (corner + np.array([[0, 1, wide + 2, 0, wide + 2, wide + 1]])).reshape(-1, 3))
        first += len(points[-1])
    grid = np.concatenate(points)
    normal = _waves(grid, time)
    material = RenderMaterial(base_color=[*WATER_TINT, 1.0], roughness=SMOOTH, specular=0.5)
    material.transmission, material.ior, material.transmission_roughness = TRANSPARENT, REFRACTION, hits.WATER
    return _shape(grid, np.concatenate(faces), normal, np.zeros((len(grid), 2)), material)


def _waves(grid: Array, time: float) -> Array:
    """Normals of waves on the surface at the points `grid` [m], [P, 3]; the heights are moved in place."""
    slope = np.zeros((len(grid), 2))
    for k in range(WAVES):
        turn, number = 1.3 * k + 0.4, 5.0 * 1.5**k  # direction [rad], waves per 2 pi metres
        way = np.array([np.cos(turn), np.sin(turn)])
        phase = (
            grid[:, :2] @ way * number
            + time * np.sqrt(9.81 * number) * 0.5
            + 2.0 * np.sin(0.7 * grid[:, (k + 1) % 2] * (k + 1))
        )
        grid[:, 2] += WAVE_SLOPE / number * np.sin(phase)
        slope += WAVE_SLOPE * way * np.cos(phase)[:, None]
    return _unit(np.column_stack([-slope, np.ones(len(grid))])).astype(np.float32)


def _unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
