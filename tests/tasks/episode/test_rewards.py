"""Rewards of situations that are made by hand, against the documented formula (docs/benchmark.md 5).

dense = 20 per target rescued in this frame (half if damaged) + 0.1 while holding + 0.05 (1 - tanh(distance in metres))
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec, Task
from hazard_ms.tasks.episode.safe_places import CART
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.registering import registered_task

FAR = 100.0  # [m]; from there tanh is 1 to the last bit
LARGEST = 20.15  # 20 + 0.1 + 0.05
AT_HALF_A_METRE = 0.05 * (1.0 - 0.46211716)  # tanh(0.5), from a table
YARD = SceneSpec(
    name="test/yard",
    room=Room((5.0, 5.0), height=3.0, open_air=True, beyond=1.0),
    fixtures=(Fixture("cart_1", "cart", "cart_1", (3.5, 3.5, 0.0)),),
    bodies=(Body("can_1", "soda_can", "soda_can_2", (3.5, 3.5, 0.55)),),
    target_categories=("soda_can",),
    fires=(),
    agent_start=AgentStart((1.0, 1.0)),
)


class Scene:
    """A kitchen whose targets are all far away until a test puts them somewhere."""

    def __init__(self, env: Any) -> None:
        env.reset(seed=0)
        self.env, self.base = env, env.unwrapped
        self.world, self.rescue = self.base.world, self.base.episode.rescue
        self.targets = self.world.target[0].nonzero()[:, 0].tolist()
        for index in self.targets:
            self.put(index, FAR)

    def put(self, index: int, distance: float) -> None:
        """Put a thing beside the gripper, the near face of its box at `distance` [m] from it."""
        gripper = self.base.agent.gripper_pose()[0][0]
        half = self.world.extent[0, index, 0] / 2
        self.world.rotation[0, index] = torch.tensor([1.0, 0.0, 0.0, 0.0])
        self.world.position[0, index] = gripper + torch.tensor([float(half) + distance, 0.0, 0.0])

    def save(self, index: int, damaged: bool = False, ago: int = 0) -> None:
        """Let a target be rescued, this many frames ago."""
        self.rescue.safe[0, index] = self.world.safe[0, index] = True
        self.rescue.damaged[0, index] = damaged
        self.rescue.frame[0, index] = self.world.frame[0] - ago

    def rewards(self) -> tuple[float, float, float]:
        """Dense, normalised and sparse."""
        base = self.base
        made = (base.compute_dense_reward, base.compute_normalized_dense_reward, base.compute_sparse_reward)
        return tuple(float(of(None, None, {})[0]) for of in made)  # type: ignore[return-value]


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make("HazardFire-v1", obs_mode="none", render_backend="none", scene_every=0)
    yield made
    made.close()


@pytest.fixture
def scene(env: Any) -> Scene:
    return Scene(env)


def expect(scene: Scene, dense: float, sparse: float) -> None:
    assert scene.rewards() == pytest.approx((dense, dense / LARGEST, sparse), rel=1e-5, abs=1e-7)


def test_nothing_near(scene: Scene) -> None:
    expect(scene, 0.0, 0.0)


def test_near_a_target(scene: Scene) -> None:
    """The nearest one counts alone."""
    scene.put(scene.targets[0], 0.5)
    scene.put(scene.targets[1], 2.0)
    expect(scene, AT_HALF_A_METRE, 0.0)


def test_the_hand_in_the_box_of_a_target(scene: Scene) -> None:
    scene.put(scene.targets[0], -0.01)
    expect(scene, 0.05, 0.0)


def test_near_a_thing_that_is_no_target(scene: Scene) -> None:
    other = int((scene.world.movable[0] & ~scene.world.target[0]).nonzero()[0, 0])
    scene.put(other, 0.0)
    expect(scene, 0.0, 0.0)


def test_holding_a_target(scene: Scene) -> None:
    """0.1 for holding, 0.05 because what is held is in reach."""
    scene.put(scene.targets[0], 0.0)
    scene.world.held[0, scene.targets[0]] = True
    expect(scene, 0.15, 0.0)


@pytest.mark.parametrize(("damaged", "dense", "sparse"), [(False, 20.0, 1.0), (True, 10.0, 0.5)])
def test_one_rescue(scene: Scene, damaged: bool, dense: float, sparse: float) -> None:
    scene.save(scene.targets[0], damaged)
    expect(scene, dense, sparse)


def test_what_a_target_is_worth_does_not_count(scene: Scene) -> None:
    """Objects are counted; their values are for the score."""
    values = scene.world.value[0]
    dear = next(i for i in scene.targets if values[i] == 5)
    cheap = next(i for i in scene.targets if values[i] == 1)
    for index in (dear, cheap):
        scene.save(index)
        expect(scene, 20.0, 1.0)
        scene.rescue.frame[0, index] -= 1


def test_two_rescues_at_once_while_another_target_is_near(scene: Scene) -> None:
    scene.save(scene.targets[0])
    scene.save(scene.targets[1], damaged=True)
    scene.put(scene.targets[2], 0.5)
    expect(scene, 30.0 + AT_HALF_A_METRE, 1.5)


def test_a_rescue_counts_in_its_own_frame_only(scene: Scene) -> None:
    scene.save(scene.targets[0], ago=1)
    scene.put(scene.targets[0], 0.0)  # being near what is rescued is worth nothing
    expect(scene, 0.0, 0.0)


def test_when_nothing_is_left_to_rescue(scene: Scene) -> None:
    """The last rescue counts as any other; afterwards there is no reward, and no target to be near to."""
    for index in scene.targets:
        scene.save(index, ago=5)
        scene.put(index, 0.0)
    expect(scene, 0.0, 0.0)
    scene.save(scene.targets[0])
    expect(scene, 20.0, 1.0)


def test_a_scene_without_targets(scene: Scene) -> None:
    scene.world.target[0] = False
    expect(scene, 0.0, 0.0)
    assert not bool(scene.base.evaluate()["success"])
    scene.world.target[0, scene.targets] = True


def test_a_broken_simulation_gives_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The frame in which it breaks would otherwise be rewarded: a rescue happens in it."""
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path))
    made = gym.make("HazardFire-v1", obs_mode="none", render_backend="none", reward_mode="sparse")
    made.reset(seed=0)
    base = made.unwrapped
    first = int(base.world.target[0].nonzero()[0, 0])

    def rescued(frame: int) -> None:
        base.episode.rescue.safe[0, first] = True
        base.episode.rescue.frame[0, first] = frame

    rescued(1)
    assert float(made.step(None)[1]) == 1.0
    rescued(2)
    base.world.handles.bodies[0].linear_velocity = [0.0, 0.0, 900.0]
    _, reward, _, truncated, info = made.step(None)
    assert bool(info["sim_error"]) and bool(truncated) and float(reward) == 0.0
    made.close()


def in_the_yard(physics: str) -> Task:
    return dataclasses.replace(
        hazard_fire(physics), scenes=lambda split: (YARD.name,), build=lambda name: YARD, hazards=(), safe_place=CART
    )


@pytest.mark.parametrize("mode", ["dense", "sparse"])
def test_what_falls_into_a_cart_is_one_rescue(mode: str) -> None:
    """The only target drops into the basket: one frame has the whole reward, and the episode ends with it."""
    with registered_task("HazardYard-v1", in_the_yard):
        made = gym.make("HazardYard-v1", obs_mode="none", render_backend="none", reward_mode=mode)
        made.reset(seed=0)
        taken = []
        for _ in range(60):
            _, reward, terminated, _, _ = made.step(None)
            taken.append(float(reward))
            if bool(terminated):
                break
        made.close()
    assert bool(terminated) and taken[-1] == {"dense": 20.0, "sparse": 1.0}[mode]
    assert all(r < 0.05 for r in taken[:-1])
