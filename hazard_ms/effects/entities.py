"""Effect entities: one mesh with its own material, drawn by the effect pass alone; and the entities of things."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import sapien
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from hazard_ms.effects import meshes
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.shaders.water import CUT_IOR, DRY_IOR, WET_IOR
from hazard_ms.spec.names import plain_name

FRAMES_PER_SECOND = 30.0  # of the animation, as videos play
PREFIX = "effect_"  # of the names of effect entities
HIDDEN = sapien.Pose([0.0, 0.0, meshes.NOWHERE])


@dataclass
class Effect:
    """One effect entity with its own material."""

    entity: sapien.Entity
    material: RenderMaterial
    seed: float
    shown: bool = False

    def show(self, pose: sapien.Pose, strength: float, time: float) -> None:
        """Show the effect at `pose`, with a strength 0..1 and a time [s], which the shaders read from its material."""
        self.entity.set_pose(pose)
        self.material.transmission = strength
        self.material.transmission_roughness = time + 10.0 * self.seed
        self.shown = True

    def hide(self) -> None:
        """Hide the effect far below the scene."""
        if self.shown:
            self.entity.set_pose(HIDDEN)
            self.shown = False


def make_effect(
    scene: sapien.Scene,
    texture: RenderTexture2D,
    make: Callable[[RenderMaterial], RenderShapeTriangleMesh | None],
    number: int,
) -> Effect | None:
    """A hidden effect with the mesh that `make(material)` gives, textured; None if it gives no mesh."""
    material = RenderMaterial(base_color=[1.0, 1.0, 1.0, 1.0])
    material.base_color_texture = texture
    material.base_color = [1.0, 1.0, 1.0, 1.0]  # a texture is only seen after a scalar has been set (SAPIEN 3.0.3)
    shape = make(material)
    if shape is None:
        return None
    body = RenderBodyComponent()
    body.attach(shape)
    body.disable_render_id()
    entity = sapien.Entity()
    entity.name = f"{PREFIX}{number}"
    entity.add_component(body)
    entity.set_pose(HIDDEN)
    scene.add_entity(entity)
    body.shading_mode = pack.EFFECT_PASS
    for node in body._internal_node.children:
        node.cast_shadow = False  # nothing to cast, but each would cost a draw in every shadow map
    return Effect(entity, material, seed(number))


def draws(scene: sapien.Scene) -> bool:
    """Whether the scene has a renderer."""
    try:
        return scene.render_system is not None
    except RuntimeError:  # SAPIEN's way of saying that there is none
        return False


def canvas(scenes: list[sapien.Scene], mode: str) -> tuple[sapien.Device | None, bool]:
    """The device that draws `scenes`, None if none does, and whether it can show effects of `mode` (full, fast, off).

    Raises ValueError for unknown modes.
    """
    pack.shader_config(mode)
    if not all(draws(s) for s in scenes):
        return None, False
    return scenes[0].render_system.device, pack.available(mode)


def entities_of(scene: sapien.Scene, names: tuple[str, ...]) -> list[sapien.Entity]:
    """The entities of the things `names`, whatever prefix the builder gives. Raises ValueError if one is missing."""
    found = {plain_name(e.name): e for e in scene.entities}
    missing = [n for n in names if n not in found]
    if missing:
        raise ValueError(f"entities of the scene must include {', '.join(missing)}, got {', '.join(sorted(found))}")
    return [found[n] for n in names]


def solid_materials(scene: sapien.Scene) -> Iterator[RenderMaterial]:
    """Materials of all that is drawn in `scene`, effects apart."""
    for entity in scene.entities:
        if not entity.name.startswith(PREFIX):
            yield from materials(entity)


def materials(entity: sapien.Entity) -> list[RenderMaterial]:
    """Materials of all that is drawn of `entity`."""
    body = entity.find_component_by_type(RenderBodyComponent)
    shapes = body.render_shapes if body else []
    return [
        m
        for s in shapes
        for m in ([p.material for p in s.parts] if isinstance(s, RenderShapeTriangleMesh) else [s.material])
    ]


def dry_ior(material: RenderMaterial) -> float:
    """The index of refraction that says that a thing of `material` is dry; how wet it is is what it has more."""
    return CUT_IOR if material.ior > CUT_IOR - WET_IOR else DRY_IOR


def seed(number: int) -> float:
    """A number from 0 up to 1 for the effect `number`; those of many effects are evenly spread."""
    return (number + 1) * meshes.GOLDEN % 1.0
