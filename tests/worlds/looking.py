"""A plain place in SAPIEN, without physics, in which a hazard is looked at.

`python -m tests.worlds.looking` prints hashes of its pictures.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace

import numpy as np
import sapien
import torch
from mani_skill.render import PREBUILT_SHADER_CONFIGS
from sapien.render import RenderMaterial, RenderShapeBox

from hazard_ms.effects.looks import Looks
from hazard_ms.effects.shaders.pack import shader_config
from hazard_ms.hazards.base import Hazard, State
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.machine.render_backend import DEVICES, backend
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec
from tests.worlds.burning_room import _add, _box, _folder, _looking

SIDE = 96  # pixels
EDGE = 6.0  # of the floor [m]
BOX, BOX_EXTENT = 0, (0.5, 0.5, 0.4)  # along B, [m]
OVERHEAD = ((2.9, 2.95, 4.4), (3.0, 3.0, 0.0))  # eye, and where it looks [m]
STANDING = ((0.3, 0.5, 1.4), (3.5, 3.2, 0.2))
INSIDE = SceneSpec(
    name="test/plain",
    room=Room((EDGE, EDGE)),
    fixtures=(),
    bodies=(Body("box_0", "book", "none", (1.6, 2.2, 0.0)),),
    target_categories=("book",),
    fires=(),
    agent_start=AgentStart((0.5, 0.5)),
    flood_side="east",
    wind=(2.0, 0.0),
)
OUTSIDE = replace(INSIDE, room=Room((EDGE, EDGE), open_air=True))


@dataclass
class Place:
    """`spec` with a `hazard`, seen from `view` through the shader pack of `mode`, or through `pack`."""

    hazard: Hazard
    spec: SceneSpec
    mode: str = "full"
    pack: str | None = None
    view: tuple[tuple[float, float, float], tuple[float, float, float]] = STANDING
    world: World = field(init=False)
    state: State = field(init=False)

    def __post_init__(self) -> None:
        device = sapien.Device(DEVICES[backend()])
        self.scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(device)])
        self.scene.set_ambient_light([0.5, 0.5, 0.5])
        self.scene.add_directional_light([0.3, 0.4, -1.0], [0.8, 0.8, 0.8], shadow=True)
        half, middle = EDGE / 2, (EDGE / 2, EDGE / 2, -0.05)
        _add(
            self.scene,
            "floor",
            RenderShapeBox([half, half, 0.05], RenderMaterial(base_color=[0.55, 0.35, 0.2, 1.0])),
            middle,
        )
        things = _box(BOX_EXTENT, RenderMaterial(base_color=[0.7, 0.5, 0.4, 1.0]))
        _add(self.scene, "env-0_box_0", things, self.spec.bodies[BOX].position)
        self.world = World.of((self.spec,), [[BOX_EXTENT]], [[1.0]])
        self.state = self.hazard.state_type.allocate({"E": 1, "B": 1} | self.hazard.sizes(self.world), "cpu")
        self.hazard.reset(self.state, self.world, torch.arange(1))
        self.looks = Looks((self.hazard,), [self.scene], (self.spec,), self.world, self.mode)
        chosen = PREBUILT_SHADER_CONFIGS[self.pack or shader_config(self.mode)]
        self.transforms = chosen.texture_transforms
        self.camera = sapien.render.RenderCameraComponent(SIDE, SIDE, _folder(chosen.shader_pack))
        self.camera.set_fovy(1.3)
        entity = sapien.Entity()
        entity.name = "camera"
        entity.add_component(self.camera)
        entity.set_pose(_looking(*self.view))
        self.scene.add_entity(entity)

    def picture(self, frame: int) -> dict[str, np.ndarray]:
        """Modalities (rgb, depth, segmentation, ...) at `frame`, as ManiSkill gives them, [H, W, C]."""
        self.world.chance.frame[:] = frame
        self.looks.update(self.world, {self.hazard.name: self.state}, self.world.frame)
        self.scene.update_render()
        self.camera.take_picture()
        made: dict[str, torch.Tensor] = {}
        for name, transform in self.transforms.items():
            made |= transform(torch.from_numpy(self.camera.get_picture(name)))
        return {k: v.numpy() for k, v in made.items()}

    def points(self) -> np.ndarray:
        """Places in the world of the pixels of the last picture [m], [H, W, 3]."""
        seen = self.camera.get_picture("Position")[..., :3]
        model = self.camera.get_model_matrix()
        return seen @ model[:3, :3].T + model[:3, 3]


def flooded(
    level: float, mode: str = "full", pack: str | None = None, view: tuple = STANDING, spec: SceneSpec = INSIDE
) -> Place:
    """A place with water of `level` [m] at the east wall."""
    place = Place(Flood(), spec, mode, pack, view)
    place.state.level[:] = level
    return place


def windy(
    wind: tuple[float, float] = (2.0, 0.0), mode: str = "full", pack: str | None = None, view: tuple = STANDING
) -> Place:
    """An open place with a `wind` [m/s]."""
    place = Place(Wind(scale=1.0), replace(OUTSIDE, wind=wind), mode, pack, view)
    return place


def picture_hashes() -> str:
    """Hashes of a picture of water and one of wind."""
    pictures = flooded(0.25).picture(75)["rgb"], windy().picture(75)["rgb"]
    return " ".join(hashlib.sha256(p.tobytes()).hexdigest() for p in pictures)


if __name__ == "__main__":
    print(picture_hashes())
