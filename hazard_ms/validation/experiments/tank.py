"""Rooms and tanks for checks of floods: Worlds of boxes of any size and mass, with or without SAPIEN."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sapien
import torch
from sapien.physx import PhysxCpuSystem, PhysxRigidDynamicComponent

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.flood.buoyancy import FILLS
from hazard_ms.hazards.flood.flood import Flood, FloodState
from hazard_ms.simulation.physx import CpuHandles
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec
from hazard_ms.validation.experiments.fire_room import repeat

GRAVITY = 9.81  # acceleration of gravity [m/s^2]
# Category whose density is so low that the box and the mass alone decide how a heavier thing floats
SAILS = "throw_pillow"


@dataclass(frozen=True)
class Thing:
    """A homogeneous body of edges `size` [m], its centre at `at` [m], turned by the rotation vector `turn` [rad]."""

    size: tuple[float, float, float]
    density: float = 500.0  # [kg/m^3] of its shape
    at: tuple[float, float, float] = (10.0, 10.0, 1.0)
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shape: int = 0
    category: str = SAILS
    mass: float | None = None  # [kg]

    @property
    def kilograms(self) -> float:
        """Mass of the thing [kg]."""
        return self.density * float(np.prod(self.size)) * FILLS[self.shape] if self.mass is None else self.mass

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Rotation of the thing, a unit quaternion w x y z."""
        angle = float(np.linalg.norm(self.turn))
        axis = np.array(self.turn) / max(angle, 1e-12) * np.sin(angle / 2)
        x, y, z = (float(a) for a in axis)
        return (float(np.cos(angle / 2)), x, y, z)


def room(
    things: Sequence[Thing],
    side: str = "east",
    size: tuple[float, float] = (20.0, 20.0),
    copies: int = 1,
    agent: tuple[float, float] = (1.0, 1.0),
    partitions: tuple[Partition, ...] = (),
    openings: tuple[Opening, ...] = (),
) -> World:
    """A World without a simulator."""
    spec = SceneSpec(
        name="test/flood",
        room=Room(size=size, partitions=partitions, openings=openings),
        fixtures=(),
        bodies=tuple(Body(f"thing_{k}", t.category, "none", t.at, t.quaternion) for k, t in enumerate(things)),
        target_categories=("book",),
        fires=(),
        agent_start=AgentStart(agent),
        flood_side=side,
    )
    world = World.of((spec,), [[t.size for t in things]], [[t.kilograms for t in things]])
    world.position[0] = torch.tensor([t.at for t in things])
    return repeat(world, copies)


def frames(flood: Flood, state: FloodState, world: World, count: int, dt: float = 0.01) -> None:
    """Advance the flood by `count` frames of `dt` [s] in a world in which nothing moves."""
    for _ in range(count):
        world.chance.tick()
        flood.advance(state, world, dt)


@dataclass
class Tank:
    """Things in still or flowing water of one level, moved by SAPIEN."""

    flood: Flood
    things: Sequence[Thing]
    level: float = 1.0  # [m]
    step: float = 0.01  # [s]
    floor: bool = False
    world: World = field(init=False)
    state: FloodState = field(init=False)

    def __post_init__(self) -> None:
        before = sapien.physx.get_scene_config()
        sapien.physx.set_scene_config(gravity=[0, 0, -GRAVITY])
        self.scene = sapien.Scene([PhysxCpuSystem()])  # takes the settings of this moment
        sapien.physx.set_scene_config(before)
        self.scene.set_timestep(self.step)
        self.world = room(self.things)
        self.world.handles = CpuHandles([self._build(t) for t in self.things])
        if self.floor:
            self._wall((10.0, 10.0, -0.5), (10.0, 10.0, 0.5))
            self._wall((7.0, 10.0, 2.0), (0.5, 10.0, 2.0))
        self.world.read()
        self.state = begin(self.flood, self.world)
        self.state.shape[0] = torch.tensor([t.shape for t in self.things])
        self.state.level[:], self.state.surface_slope[:] = self.level, 0.0
        fill = torch.tensor([np.prod(t.size) * FILLS[t.shape] for t in self.things])
        self.state.volume[0] = torch.minimum(self.state.volume[0], fill)

    def _build(self, thing: Thing) -> Any:
        builder = self.scene.create_actor_builder()
        rub = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
        builder.add_box_collision(
            sapien.Pose([0, 0, thing.size[2] / 2]), half_size=[s / 2 for s in thing.size], material=rub
        )
        actor = builder.build()
        body = actor.find_component_by_type(PhysxRigidDynamicComponent)
        (x, y, z), mass = thing.size, thing.kilograms
        body.set_mass(mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_inertia([mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)])
        body.linear_damping = 0.0
        turn = sapien.Pose(q=list(thing.quaternion))
        base = np.array(thing.at) - (turn * sapien.Pose([0, 0, z / 2])).p
        actor.set_pose(sapien.Pose(base, list(thing.quaternion)))
        return actor

    def _wall(self, centre: tuple[float, float, float], half: tuple[float, float, float]) -> None:
        builder = self.scene.create_actor_builder()
        builder.add_box_collision(half_size=list(half), material=sapien.physx.PhysxMaterial(0.5, 0.5, 0.0))
        builder.initial_pose = sapien.Pose(list(centre))
        builder.build_static()

    def run(self, seconds: float) -> list[np.ndarray]:
        """Let `seconds` pass: positions of the centres [m], [B, 3], world frame, after every step."""
        seen = []
        for _ in range(round(seconds / self.step)):
            made = self.flood.force(self.state, self.world, self.step)
            if made is not None:
                self.world.push(made.force, made.torque)
            self.scene.step()
            self.world.read()
            seen.append(self.world.position[0].numpy().copy())
        return seen

    def depth(self, thing: int = 0) -> float:
        """Depth of the lowest point under water, in units of the height of the box [-]."""
        size = self.things[thing].size[2]
        return float(self.level - self.world.position[0, thing, 2] + size / 2) / size
