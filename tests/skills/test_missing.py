"""Things that the wind has carried off since they were seen, in real physics: the map says that they are missing."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import TOO_FAR
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec, Task
from hazard_ms.tasks.wind import hazard_wind
from tests.worlds.registering import registered_task

pytestmark = pytest.mark.render
LOT = SceneSpec(  # bottles 3 m ahead of the robot, and 1.2 m behind it; a shed hides what lies behind it
    name="test/open",
    room=Room((12.0, 12.0), 12.0, "asphalt", "plaster", open_air=True, beyond=4.0),
    fixtures=(
        Fixture("cart_1", "cart", "cart_1", (3.0, 10.5, 0.0)),
        Fixture("shed_1", "shed", "plain_box", (9.0, 2.0, 0.0), scale=(0.4, 4.0, 1.5)),
    ),
    bodies=(
        Body("bottle_1", "bottle", "plain_box", (6.0, 6.0, 0.0), scale=(0.1, 0.1, 0.2), mass=1.0),
        Body("bottle_2", "bottle", "plain_box", (1.8, 6.0, 0.0), scale=(0.1, 0.1, 0.2), mass=1.0),
    ),
    target_categories=("bottle",),
    fires=(),
    agent_start=AgentStart((3.0, 6.0)),
    wind=(0.001, 0.0),
)


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    def task(physics: str) -> Task:
        return dataclasses.replace(hazard_wind(physics), scenes=lambda split: (LOT.name,), build=lambda name: LOT)

    with registered_task("HazardOpen-v1", task):
        made = SkillEnv.make("HazardOpen-v1", reward_mode="none")
        yield made
        made.close()


def carry_off(env: SkillEnv, name: str) -> int:
    """Put a bottle behind the shed; its index."""
    world = env.base.world
    index = world.index(0, name)
    world.position[0, index] = world.position.new_tensor([10.5, 1.5, 0.1])
    world.place(torch.tensor([0]))
    return index


def is_missing(decision: Decision, index: int) -> bool:
    return decision.map.objects[index].missing


def test_a_look_at_its_place_shows_that_a_thing_is_gone_while_others_stay(env: SkillEnv) -> None:
    env.reset(seed=0)
    before = env.step(Action(EXPLORE))[0]
    first, second = (env.labeller.index(name) for name in ("bottle_1", "bottle_2"))
    assert not is_missing(before, first) and not is_missing(before, second)
    assert carry_off(env, "bottle_1") == first
    after, _, _, _, info = env.step(Action(WALK_TO, "bottle_1"))
    assert info["result"].frames > 0 and is_missing(after, first)
    assert not is_missing(after, second), "it is behind the robot, where it cannot be seen"
    assert not is_missing(before, first), "what an agent was told stays as it was"


def test_a_hand_that_finds_a_thing_too_far_tells_that_it_is_gone(env: SkillEnv) -> None:
    """It does not turn to it: nobody sees the place."""
    env.reset(seed=0)
    env.step(Action(EXPLORE))
    for _ in range(2):
        env.step(Action(WALK_TO, "cart_1"))
    for near in (False, True):
        if near:  # from the start the place is 1.2 m away, from near the cart 3.5 m
            env.reset(seed=0)
            env.step(Action(EXPLORE))
        index = carry_off(env, "bottle_2")
        after, _, _, _, info = env.step(Action(PICK_UP, "bottle_2"))
        assert info["result"].reason == TOO_FAR and info["result"].frames == 0
        assert is_missing(after, index) is near
