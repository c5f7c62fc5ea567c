"""I-1 to I-3 of docs/physics.md, through the handles that every hazard's force goes through."""

from __future__ import annotations

import numpy as np
import pytest
import sapien
import torch
from sapien.physx import PhysxCpuSystem, PhysxRigidDynamicComponent

from hazard_ms.scenes.splits import scene, scene_names
from hazard_ms.simulation.physx import CpuHandles
from hazard_ms.simulation.world import World

STEP = 0.01  # [s] the step for which docs/physics.md 2.0 gives its numbers
GRAVITY = 9.81  # [m/s^2]


class Fall:
    """One box in free space, in a World of one body."""

    def __init__(self, mass: float = 2.0, gravity: bool = True) -> None:
        before = sapien.physx.get_scene_config()
        sapien.physx.set_scene_config(gravity=[0, 0, -GRAVITY if gravity else 0.0])
        self.system = PhysxCpuSystem()  # takes the settings of this moment
        sapien.physx.set_scene_config(before)
        self.scene = sapien.Scene([self.system])
        self.scene.set_timestep(STEP)
        builder = self.scene.create_actor_builder()
        builder.add_box_collision(half_size=[0.1, 0.1, 0.1])
        builder.initial_pose = sapien.Pose([0, 0, 50.0])
        self.body = builder.build("box").find_component_by_type(PhysxRigidDynamicComponent)
        self.body.set_mass(mass)
        self.body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, 0.1]))
        self.body.set_inertia([mass / 12 * 0.08] * 3)
        self.body.linear_damping = 0.0
        spec = scene(scene_names("train")[0])
        one = type(spec)(**{**vars(spec), "bodies": spec.bodies[:1], "fixtures": ()})
        self.world = World.of((one,), [[(0.2, 0.2, 0.2)]], [[mass]])
        self.world.handles = CpuHandles([self.body.entity])
        self.world.read()

    def step(
        self, force: tuple[float, float, float] = (0, 0, 0), torque: tuple[float, float, float] | None = None
    ) -> None:
        push = torch.tensor([[force]], dtype=torch.float32)
        self.world.push(push, None if torque is None else torch.tensor([[torque]], dtype=torch.float32))
        self.scene.step()
        self.world.read()


def test_i1_free_fall_is_semi_implicit_euler() -> None:
    """z = z0 - g dt^2 n (n + 1) / 2 after n steps: 4.95405 m in a second of 0.01 s steps."""
    fall = Fall()
    start = float(fall.world.position[0, 0, 2])
    for _ in range(100):
        fall.step()
    assert start - float(fall.world.position[0, 0, 2]) == pytest.approx(GRAVITY * STEP**2 * 100 * 101 / 2, abs=5e-5)
    assert GRAVITY * STEP**2 * 100 * 101 / 2 == pytest.approx(4.95405)


def test_i2_a_force_acts_for_one_step() -> None:
    """v = F dt / m after the step it was pushed in, and constant from then on."""
    fall = Fall(mass=2.0, gravity=False)
    fall.step(force=(3.0, -1.0, 2.0))
    want = np.array([3.0, -1.0, 2.0]) * STEP / 2.0
    for _ in range(5):
        assert fall.world.velocity[0, 0].numpy() == pytest.approx(want, rel=1e-5)
        fall.step()


def test_i2_a_force_acts_at_the_centre_of_mass_and_a_torque_turns() -> None:
    fall = Fall(mass=2.0, gravity=False)
    fall.step(force=(5.0, 0.0, 0.0))
    assert fall.world.angular_velocity[0, 0].abs().max() < 1e-6
    fall.step(torque=(0.0, 0.0, 0.3))
    assert float(fall.world.angular_velocity[0, 0, 2]) == pytest.approx(0.3 * STEP / (2.0 / 12 * 0.08), rel=2e-3)


def test_i3_damping_is_explicit() -> None:
    """v *= 1 - c dt in each step; the angular default of PhysX is 0.05."""
    fall = Fall(gravity=False)
    assert fall.body.angular_damping == pytest.approx(0.05)
    assert fall.body.sleep_threshold == pytest.approx(0.005)
    fall.body.linear_damping = 0.8
    fall.body.linear_velocity = [2.0, 0.0, 0.0]
    for _ in range(50):
        fall.step()
    assert float(fall.world.velocity[0, 0, 0]) == pytest.approx(2.0 * (1 - 0.8 * STEP) ** 50, rel=1e-4)


def test_frozen_bodies_stay_where_they_are_put_and_feel_nothing() -> None:
    fall = Fall()
    base, turn = torch.tensor([[[1.0, 2.0, 3.0]]]), torch.tensor([[[1.0, 0, 0, 0]]])
    mask = torch.tensor([[True]])
    fall.world.freeze(mask, base, turn)
    for _ in range(20):
        fall.step(force=(100.0, 0.0, 0.0))
    assert torch.allclose(fall.world.position[0, 0], torch.tensor([1.0, 2.0, 3.1]))
    fall.world.freeze(~mask, base, turn)
    fall.step()
    assert float(fall.world.velocity[0, 0, 2]) == pytest.approx(-GRAVITY * STEP, rel=1e-4)
