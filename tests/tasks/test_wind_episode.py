"""Wind in the whole environment, an open street: things are blown away, stay in the world, and repeat bit for bit."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401
from hazard_ms.hazards.presets import wind
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec, Task
from hazard_ms.tasks.rescue import rescue
from tests.worlds.registering import registered_task

TASK = "HazardStreet-v1"
BEYOND = 1.5  # [m]
MODELS = ("bottle_1", "bag_1", "soda_can_1", "basket_1", "backpack_1", "camera_1")
CART = (2.0, 4.3)  # [m]
STREET = SceneSpec(
    name="test/street",
    room=Room((6.0, 5.0), height=4.0, floor="wood", open_air=True, beyond=BEYOND),
    fixtures=(
        Fixture("table_1", "table", "table_1", (3.0, 2.4, 0.0)),
        Fixture("cart_1", "cart", "cart_1", (*CART, 0.0)),
    ),
    bodies=(
        *(
            Body(f"{m}_{k}", m[:-2], m, (1.0 + 0.8 * i, 1.0 + 1.0 * k, 0.0))
            for k in range(3)
            for i, m in enumerate(MODELS)
        ),
        Body("can_in_cart", "soda_can", "soda_can_2", (*CART, 0.55)),
    ),
    target_categories=("bottle",),
    fires=(),
    agent_start=AgentStart((0.5, 4.5)),
    wind=(4.5, 1.5),
)


def in_the_street(physics: str) -> Task:
    # a storm: within seconds everything is at the far end
    blows = dataclasses.replace(wind(physics), scale=2.0 * wind(physics).scale)
    return dataclasses.replace(rescue([blows]), scenes=lambda split: (STREET.name,), build=lambda name: STREET)


@pytest.fixture(scope="module", params=["paper", "shipped"])
def street(request: pytest.FixtureRequest) -> Iterator[Any]:
    with registered_task(TASK, in_the_street):
        made = gym.make(TASK, obs_mode="state", render_backend="none", physics=request.param, affects_agent=True)
        yield made
        made.close()


def blown(env: Any, seed: int, frames: int) -> torch.Tensor:
    """Positions [m] and velocities [m/s] of the bodies after `frames`, [B, 6]; all must stay inside the street."""
    env.reset(seed=seed)
    world, (x, y) = env.unwrapped.world, STREET.room.size
    moving, end = len(STREET.bodies), BEYOND + 0.05  # what a storm holds against a wall sinks into it a little
    for _ in range(frames):
        *_, info = env.step(None)
        at = world.position[0, :moving]
        assert bool(torch.isfinite(at).all()) and not bool(info["sim_error"])
        assert float(at[:, :2].min()) > -end and float(at[:, 2].min()) > -0.05
        assert float(at[:, 0].max()) < x + end and float(at[:, 1].max()) < y + end and float(at[:, 2].max()) < 4.0
    assert float(info["agent_wind"]) == pytest.approx(
        float(world.position.new_tensor(math.hypot(4.5, 1.5))) * env.unwrapped.task.hazards[0].scale
    )
    return torch.cat([at, world.velocity[0, :moving]], 1)


def test_a_storm_blows_everything_to_the_far_end_and_not_out_of_the_world(street: Any) -> None:
    frames = 80
    first = blown(street, 1, frames)
    start = torch.tensor([b.position for b in STREET.bodies])
    bottles = torch.tensor([b.category == "bottle" for b in STREET.bodies])
    assert ((first[:, 0] - start[:, 0])[bottles] > 0.3).all()
    assert torch.equal(first, blown(street, 1, frames))
    assert not torch.equal(first, blown(street, 2, frames))


def test_a_restored_storm_goes_on_with_the_same_gusts_and_turbulence(street: Any) -> None:
    street.reset(seed=4)
    base = street.unwrapped
    for _ in range(10):
        street.step(None)
    saved = base.get_state_dict()
    states = []
    for _ in range(2):
        base.set_state_dict(saved)
        for _ in range(5):
            street.step(None)
        states.append(base.episode.states["wind"].save())
    assert torch.equal(states[0]["sway"], states[1]["sway"]) and float(states[0]["sway"].abs().max()) > 0


def test_what_falls_into_a_cart_settles_and_stays(street: Any) -> None:
    street.reset(seed=6)
    base = street.unwrapped
    world, can = base.world, base.world.index(0, "can_in_cart")
    for _ in range(60):
        street.step(None)
    state = base.episode.states["wind"]
    assert bool(state.settled[0, can]) and not bool(state.settled[0, world.index(0, "cart_1")])
    push = base.task.hazards[0].force(state, world, 0.01)
    assert float(push.force[0, can].abs().max()) == 0.0 == float(push.torque[0, can].abs().max())
    offset = (world.position[0, can, :2] - torch.tensor(CART)).abs()
    assert float(offset[0]) < 0.24 and float(offset[1]) < 0.4 and float(world.position[0, can, 2]) > 0.46


def test_what_is_put_into_a_hand_feels_no_wind(street: Any) -> None:
    street.reset(seed=5)
    world = street.unwrapped.world
    for _ in range(5):
        street.step(None)
    hazard, state = street.unwrapped.task.hazards[0], street.unwrapped.episode.states["wind"]
    world.held[0, 0] = True
    push = hazard.force(state, world, 0.01)
    world.held[0, 0] = False
    assert float(push.force[0, 0].abs().max()) == 0.0 and float(push.force[0, 1].norm()) > 0.0
