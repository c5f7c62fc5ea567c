"""The town around a scene in the open, built once with it. It has no collision, no labels and no depth.

Firm pieces and pieces that the wind moves are one entity each, clouds a third one. The wind reaches a vertex shader by
an entity's pose alone (shaders/dressing.py), so one pose per frame moves all flags and trees.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from hazard_ms.effects.entities import materials
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.shaders.dressing import SKY_LAYER
from hazard_ms.effects.streets import painting
from hazard_ms.effects.streets.mesh import Frame, Mesh
from hazard_ms.effects.streets.plan import town_of
from hazard_ms.scenes.shell import shell
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.names import plain_name

FIRM, LOOSE, CLOUDS = "town_firm", "town_loose", "town_clouds"  # names of the entities
CLOUD_HEIGHT, CLOUD_REACH, CLOUD_SPAN = 13.0, 58.0, 34.0  # height, extent and size of the texture of clouds [m] [ours]
WARM = (1.0, 0.78, 0.5)  # colour of the light in windows, linear [ours]
MOST_GLOW = 1.3  # of a lit window at night; 1 is white [ours]
WET, DAMP = (0.03, 0.5), (0.38, 0.45)  # roughness and specular of puddles, and of asphalt after rain [ours]
AWAY = sapien.Pose([0.0, 0.0, -1000.0])


def build(scene: sapien.Scene, spec: SceneSpec) -> list[RenderMaterial]:
    """Build the town around `spec` into `scene`. Returns the materials that shine at night."""
    town = town_of(spec)
    solid, cut = painting.solid(), painting.cut_out()
    colours = [_texture(a.colour) for a in (solid, cut)]
    light = _texture(solid.glow)
    coats = [_material(colours[k % 2], light if k % 2 == 0 else None) for k in range(4)]
    water = _material(_texture(painting.puddle()), None)
    water.roughness, water.specular = WET
    _entity(scene, FIRM, [(town.firm, coats[0]), (town.firm_cut, coats[1]), (town.wet, water)])
    _wet_asphalt(scene, spec)
    _entity(scene, LOOSE, [(town.loose, coats[2]), (town.loose_cut, coats[3])])
    _clouds(scene, spec)
    return coats[::2]


def shine(coats: list[RenderMaterial], air: tuple[float, float, float]) -> None:
    """Light the windows in an air that is `air` bright, 1 by day."""
    glow = MOST_GLOW * max(1.0 - air[1], 0.0)
    for material in coats:
        material.emission = [*(c * glow for c in WARM), 1.0]


class Breeze:
    """The part of a scene's town that the wind moves, if there is any."""

    def __init__(self, scene: sapien.Scene) -> None:
        self._parts = [e for e in scene.entities if e.name in (LOOSE, CLOUDS)]

    def show(self, pose: sapien.Pose) -> None:
        """Show the wind that `pose` tells, see shaders/dressing.py."""
        for part in self._parts:
            part.set_pose(pose)


@contextmanager
def at_rest(scene: sapien.Scene) -> Iterator[None]:
    """Keep still all that the wind moves, for ray tracing, which knows no vertex shader; clouds are left to the sky."""
    moved = [(e, e.pose) for e in scene.entities if e.name in (LOOSE, CLOUDS)]
    for entity, _ in moved:
        entity.set_pose(AWAY if entity.name == CLOUDS else sapien.Pose())
    try:
        yield
    finally:
        for entity, pose in moved:
            entity.set_pose(pose)


def _wet_asphalt(scene: sapien.Scene, spec: SceneSpec) -> None:
    """Let the asphalt of `spec` shine as it does after rain."""
    wet = {f"shell_{i}_{box.name}" for i, box in enumerate(shell(spec.room)) if box.material == "asphalt"}
    for entity in scene.entities:
        if plain_name(entity.name) in wet:
            for material in materials(entity):
                material.roughness, material.specular = DAMP


def _clouds(scene: sapien.Scene, spec: SceneSpec) -> None:
    """A ceiling of clouds that drift; it fades before its rim."""
    mesh, (x, y) = Mesh(), spec.room.size
    reach, span = CLOUD_REACH, 2 * CLOUD_REACH / CLOUD_SPAN
    for high, first in ((CLOUD_HEIGHT, 0.0), (1.7 * CLOUD_HEIGHT, 0.4)):
        corners = [(-reach, -reach, high), (-reach, reach, high), (reach, reach, high), (reach, -reach, high)]
        mesh.quad(Frame(x / 2, y / 2), corners, (first, first, first + span, first + span), (SKY_LAYER,) * 4)
    _entity(scene, CLOUDS, [(mesh, _material(_texture(painting.clouds()), None))])


def _texture(image: np.ndarray) -> RenderTexture2D:
    return RenderTexture2D(image, "R8G8B8A8Unorm", mipmap_levels=6, srgb=True)


def _material(colour: RenderTexture2D, light: RenderTexture2D | None) -> RenderMaterial:
    material = RenderMaterial(base_color=[1.0, 1.0, 1.0, 1.0], roughness=0.8, specular=0.2)
    material.base_color_texture = colour
    if light is not None:
        material.emission_texture = light
    material.emission = [0.0, 0.0, 0.0, 1.0]
    material.base_color = [1.0, 1.0, 1.0, 1.0]  # a texture is only seen after a scalar has been set (SAPIEN 3.0.3)
    return material


def _entity(scene: sapien.Scene, name: str, parts: list[tuple[Mesh, RenderMaterial]]) -> None:
    body = RenderBodyComponent()
    for mesh, material in parts:
        if len(mesh):
            vertices, faces, normals, places = mesh.arrays()
            body.attach(RenderShapeTriangleMesh(vertices, faces, normals, places, material))
    body.disable_render_id()
    entity = sapien.Entity()
    entity.name = name
    entity.add_component(body)
    scene.add_entity(entity)
    body.shading_mode = pack.DRESS_PASS
    for node in body._internal_node.children:
        node.cast_shadow = False  # outside of the shadow map, or moved by the wind
