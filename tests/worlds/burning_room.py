"""A small room in SAPIEN, without physics, in which two things can burn.

`python -m tests.worlds.burning_room` prints a hash of its picture.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np
import sapien
import torch
from mani_skill.render import PREBUILT_SHADER_CONFIGS
from sapien.render import RenderBodyComponent, RenderMaterial, RenderShapeBox, RenderShapeTriangleMesh, RenderTexture2D

from hazard_ms.effects.fire import FireEffects
from hazard_ms.effects.shaders.pack import shader_config
from hazard_ms.hazards.fire.fire import BURNING, Fire, FireState
from hazard_ms.machine.render_backend import DEVICES, backend
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec

SIDE = 96  # pixels
TABLE, BOX = 0, 1  # along B
EXTENTS = [(0.8, 0.8, 0.5), (0.4, 0.4, 0.4)]  # [m]
SPEC = SceneSpec(
    name="test/burning_room",
    room=Room((4.0, 4.0)),
    fixtures=(),
    bodies=(Body("table_0", "book", "none", (1.5, 2.6, 0.0)), Body("box_0", "book", "none", (2.4, 1.5, 0.0))),
    target_categories=("book",),
    fires=((2.9, 2.6),),
    agent_start=AgentStart((0.5, 0.5)),
)


@dataclass
class BurningRoom:
    """One room seen through the shader pack of `mode`, or through `pack`."""

    mode: str
    pack: str | None = None
    world: World = field(init=False)
    fire: FireState = field(init=False)

    def __post_init__(self) -> None:
        device = sapien.Device(DEVICES[backend()])
        self.scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(device)])
        self.scene.set_ambient_light([0.4, 0.4, 0.4])
        self.scene.add_directional_light([0.3, 0.4, -1.0], [1.0, 1.0, 1.0], shadow=True)
        _add(
            self.scene,
            "floor",
            RenderShapeBox([2.0, 2.0, 0.05], RenderMaterial(base_color=[0.5, 0.4, 0.3, 1.0])),
            (2.0, 2.0, -0.05),
        )
        _add(
            self.scene,
            "env-0_table_0",
            _box(EXTENTS[TABLE], RenderMaterial(base_color=[0.7, 0.7, 0.6, 1.0])),
            SPEC.bodies[TABLE].position,
        )
        _add(self.scene, "env-0_box_0", _box(EXTENTS[BOX], _textured()), SPEC.bodies[BOX].position)
        self.world = World.of((SPEC,), [EXTENTS], [[1.0, 1.0]])
        fire = Fire()
        self.fire = FireState.allocate({"E": 1, "B": 2} | fire.sizes(self.world), "cpu")
        fire.reset(self.fire, self.world, torch.arange(1))
        self.effects = FireEffects.build([self.scene], (SPEC,), self.world, self.mode)
        chosen = PREBUILT_SHADER_CONFIGS[self.pack or shader_config(self.mode)]
        self.transforms = chosen.texture_transforms
        self.camera = sapien.render.RenderCameraComponent(SIDE, SIDE, _folder(chosen.shader_pack))
        self.camera.set_fovy(1.3)
        entity = sapien.Entity()
        entity.add_component(self.camera)
        entity.set_pose(_looking((0.2, 0.2, 1.6), (2.4, 2.2, 0.3)))
        self.scene.add_entity(entity)

    def ignite(self, thing: int, updates: int = 60, status: int = BURNING) -> None:
        """Let `thing` have burned for `updates` heat updates, its flame grown."""
        self.fire.status[0, thing] = status
        self.fire.temperature[0, thing] = 600.0
        self.fire.burn_updates[0, thing] = updates

    def picture(self, frame: int) -> dict[str, np.ndarray]:
        """Modalities (rgb, depth, segmentation, ...) at `frame`, as ManiSkill gives them, [H, W, C]."""
        self.world.chance.frame[:] = frame
        self.effects.update(self.world, self.fire, self.world.frame)
        self.scene.update_render()
        self.camera.take_picture()
        made: dict[str, torch.Tensor] = {}
        for name, transform in self.transforms.items():
            made |= transform(torch.from_numpy(self.camera.get_picture(name)))
        return {k: v.numpy() for k, v in made.items()}


def _add(scene: sapien.Scene, name: str, shape: sapien.render.RenderShape, place: tuple[float, float, float]) -> None:
    body = RenderBodyComponent()
    body.attach(shape)
    entity = sapien.Entity()
    entity.name = name
    entity.add_component(body)
    entity.set_pose(sapien.Pose(list(place)))
    scene.add_entity(entity)


def _box(extent: tuple[float, float, float], material: RenderMaterial) -> RenderShapeTriangleMesh:
    """A box with its base at z = 0, as assets have, with texture coordinates."""
    unit = RenderShapeBox([0.5, 0.5, 0.5], material)
    vertices = (np.asarray(unit.vertices) * 0.5 + [0.0, 0.0, 0.5]) * extent
    return RenderShapeTriangleMesh(
        vertices.astype(np.float32), unit.triangles, unit.vertex_normal, np.asarray(unit.vertex_uv), material
    )


def _textured() -> RenderMaterial:
    """A material with a chequered texture, which hides its base colour."""
    cells = 200 + 40 * (np.add.outer(np.arange(16), np.arange(16)) % 2)
    image = np.stack([cells] * 3 + [np.full((16, 16), 255)], -1).astype(np.uint8)
    material = RenderMaterial()
    material.base_color_texture = RenderTexture2D(image, "R8G8B8A8Unorm", srgb=True)
    material.base_color = [1.0, 1.0, 1.0, 1.0]
    return material


def _looking(eye: tuple[float, float, float], at: tuple[float, float, float]) -> sapien.Pose:
    forward = np.subtract(at, eye) / np.linalg.norm(np.subtract(at, eye))
    left = np.cross([0.0, 0.0, 1.0], forward)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([forward, left, np.cross(forward, left)])
    matrix[:3, 3] = eye
    return sapien.Pose(matrix)


def _folder(pack: str) -> str:
    from pathlib import Path

    return pack if Path(pack).is_absolute() else str(Path(sapien.__file__).parent / "vulkan_shader" / pack)


def picture_hash() -> str:
    """Hashes of a picture in which everything that effects can do is seen."""
    room = BurningRoom("full")
    room.ignite(TABLE, 20)
    room.ignite(BOX, 60)
    return hashlib.sha256(room.picture(230)["rgb"].tobytes()).hexdigest()


if __name__ == "__main__":
    print(picture_hash())
