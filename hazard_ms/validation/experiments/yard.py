"""Streets for checks of wind: a World without a simulator, any number of copies, and one with boxes in real physics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sapien
import torch
from sapien.physx import PhysxCpuSystem, PhysxRigidDynamicComponent

from hazard_ms.hazards.base import Push, begin
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.hazards.wind.wind_state import WindState
from hazard_ms.simulation.physx import CpuHandles
from hazard_ms.simulation.world import World
from hazard_ms.spec import UPRIGHT, AgentStart, Body, Fixture, Quat, Room, SceneSpec, Vec2, Vec3
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.validation.experiments.fire_room import repeat

STILL: dict[str, Any] = {"turbulence": 0.0, "torque": 0.0}  # the main force alone
GRAVITY = 9.81  # acceleration of gravity [m/s^2]


@dataclass(frozen=True)
class Thing:
    """A box with its base's middle at `at`; `resistance` 0 unless told, None: its category's."""

    extent: Vec3 = (0.2, 0.3, 0.2)
    mass: float = 0.5
    at: Vec3 = (8.0, 8.0, 0.0)
    rotation: Quat = UPRIGHT
    resistance: float | None = 0.0
    category: str = "box"
    friction: float = 0.5


@dataclass(frozen=True)
class Block:
    """A fixture, such as a house or a hedge."""

    category: str
    at: Vec3
    extent: Vec3
    rotation: Quat = UPRIGHT


def street(
    things: Sequence[Thing], wind: Vec2 = (3.7, 0.0), blocks: Sequence[Block] = (), size: float = 16.0, copies: int = 1
) -> World:
    """A World without a simulator."""
    spec = SceneSpec(
        name="test/wind",
        room=Room(size=(size, size), open_air=True, beyond=4.0),
        fixtures=tuple(Fixture(f"block_{k}", b.category, "none", b.at, b.rotation) for k, b in enumerate(blocks)),
        bodies=tuple(
            Body(f"thing_{k}", t.category, "none", t.at, t.rotation, mass=t.mass, wind_resistance=t.resistance)
            for k, t in enumerate(things)
        ),
        target_categories=("box",),
        fires=(),
        agent_start=AgentStart((1.0, 1.0)),
        wind=wind,
    )
    extents = [[*(t.extent for t in things), *(b.extent for b in blocks)]]
    masses = [[*(t.mass for t in things), *(100.0 for _ in blocks)]]
    return repeat(World.of((spec,), extents, masses), copies)


def push(wind: Wind, world: World, dt: float = 0.01) -> Push:
    """Push of the wind in the first step, of `dt` [s], of an episode."""
    return wind.force(begin(wind, world), world, dt)


def run(wind: Wind, state: WindState, world: World, frames: int, dt: float = 1 / 30) -> None:
    """Advance the wind by this many frames of `dt` [s] in a world in which nothing moves."""
    for _ in range(frames):
        world.chance.tick()
        wind.advance(state, world, dt)


@dataclass
class Yard:
    """Things in the wind on level ground or, without gravity, in free space: the loop of the environment, no robot."""

    wind: Wind
    things: Sequence[Thing]
    blows: Vec2 = (3.7, 0.0)
    rates: tuple[int, int] = (100, 100)  # frames and physics steps per second
    gravity: bool = True
    walls: float = 0.0  # half the edge of a square of walls around (8, 8), 0 for none [m]
    seed: int = 0
    episode: Episode = field(init=False)

    def __post_init__(self) -> None:
        before = sapien.physx.get_scene_config()
        sapien.physx.set_scene_config(
            gravity=[0, 0, -GRAVITY if self.gravity else 0.0], enable_enhanced_determinism=True
        )
        self.scene = sapien.Scene([PhysxCpuSystem()])  # takes the settings of this moment
        sapien.physx.set_scene_config(before)
        self.scene.set_timestep(1 / self.rates[1])
        self._fixed()
        world = street(self.things, self.blows)
        world.handles = CpuHandles([self._box(t) for t in self.things])
        self.world = world
        self.episode = Episode(world, (self.wind,))
        rows = torch.arange(1)
        self.episode.begin(rows, torch.tensor([self.seed]))
        self.episode.begin_hazards(rows)
        world.read()

    def _fixed(self) -> None:
        builder = self.scene.create_actor_builder()
        if self.gravity:
            ground = sapien.physx.PhysxMaterial(self.things[0].friction, self.things[0].friction, 0.0)
            builder.add_box_collision(sapien.Pose([0, 0, -1.0]), half_size=[2000, 2000, 1.0], material=ground)
        for axis in (0, 1) if self.walls else ():
            for side in (-1.0, 1.0):
                centre, half = [8.0, 8.0, 2.0], [self.walls + 1.0, self.walls + 1.0, 3.0]
                centre[axis] += side * (self.walls + 0.5)
                half[axis] = 0.5
                builder.add_box_collision(sapien.Pose(centre), half_size=half)
        builder.build_static("fixed")

    def _box(self, thing: Thing) -> sapien.Entity:
        builder = self.scene.create_actor_builder()
        x, y, z = thing.extent
        material = sapien.physx.PhysxMaterial(thing.friction, thing.friction, 0.0)
        builder.add_box_collision(sapien.Pose([0, 0, z / 2]), half_size=[x / 2, y / 2, z / 2], material=material)
        entity = builder.build()
        body = entity.find_component_by_type(PhysxRigidDynamicComponent)
        body.set_mass(thing.mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_inertia([thing.mass / 12 * s for s in (y * y + z * z, x * x + z * z, x * x + y * y)])
        return entity

    def run(self, seconds: float) -> None:
        """Let `seconds` pass."""
        for _ in range(round(seconds * self.rates[0])):
            for _ in range(self.rates[1] // self.rates[0]):
                self.episode.push(1 / self.rates[1])
                self.scene.step()
            self.world.read()
            self.episode.advance(1 / self.rates[0])

    @property
    def speed(self) -> np.ndarray:
        """Speeds along +x [m/s], [B]."""
        return self.world.velocity[0, :, 0].numpy().copy()

    @property
    def path(self) -> np.ndarray:
        """Paths along +x from the start [m], [B]."""
        return self.world.position[0, :, 0].numpy() - np.array([t.at[0] for t in self.things])
