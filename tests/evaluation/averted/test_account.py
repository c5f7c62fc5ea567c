"""What is lost at the end of real episodes, and the loads on a robot in real physics."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.evaluation.attempts import Recorded
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.averted.contacts import Collisions
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import play
from hazard_ms.hazards.places import SETTLING, follow, strayed
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire
from hazard_ms.tasks.flood import hazard_flood
from tests.worlds.registering import registered_task

TASKS = {"HazardYard-v1": hazard_fire, "HazardPool-v1": hazard_flood}
FRAMES = 150
ROOM = SceneSpec(  # a table 1 m ahead of the robot, a pan beside it, a fire at its back
    name="test/room",
    room=Room((8.0, 8.0)),
    fixtures=(Fixture("table_1", "table", "plain_box", (4.0, 4.0, 0.0), scale=(0.6, 0.6, 0.7)),),
    bodies=(Body("pan_1", "pan", "pan_1", (1.0, 1.0, 0.0)),),
    target_categories=("pan",),
    fires=((1.6, 4.0),),
    agent_start=AgentStart((2.4, 4.0)),
)


@pytest.fixture(scope="module", autouse=True)
def rooms() -> Iterator[None]:
    def made(of: Any) -> Any:
        def task(physics: str) -> Task:
            return dataclasses.replace(of(physics), scenes=lambda split: (ROOM.name,), build=lambda name: ROOM)

        return task

    with registered_task("HazardYard-v1", made(hazard_fire)), registered_task("HazardPool-v1", made(hazard_flood)):
        yield


def environment(task: str = "HazardYard-v1", **keywords: Any) -> Any:
    env = gym.make(task, obs_mode="none", render_backend="none", control_mode="pd_joint_pos", **keywords)
    env.reset(seed=0)
    return env


def drive(env: Any, forward: float, frames: int) -> Iterator[None]:
    """Let frames pass while the robot drives `forward` [m] in each."""
    agent = env.unwrapped.agent
    for _ in range(frames):
        env.unwrapped.advance(agent.action(forward, 0.0, agent.tucked, True))
        yield


def test_collisions_are_counted_when_they_begin() -> None:
    """Into the table and on against it: 1; away and again: 2. The free floor and the air are none."""
    env = environment()
    counter, seen = Collisions(env.unwrapped, env.unwrapped.agent), []
    for forward, frames in ((1 / 62, 40), (1 / 62, 80), (-1 / 62, 40), (1 / 62, 80)):
        for _ in drive(env, forward, frames):
            counter.count()
        seen.append(counter.number)
    env.close()
    assert seen == [0, 1, 1, 2]


def watched(env: Any) -> tuple[Account, Any]:
    """An account of an environment without skills."""
    stage = SimpleNamespace(base=env.unwrapped, frame=0)
    account = Account()
    account.begin(stage, None)  # type: ignore[arg-type]
    return account, stage


def test_heat_is_the_dose_of_the_agent_s_temperature() -> None:
    """ISO 13571: T^3.61 / 4.1e8 a minute, here summed frame by frame."""
    env = environment(affects_agent=True)
    account, stage = watched(env)
    dose = 0.0
    for _ in drive(env, 0.0, 300):
        stage.frame += 1
        account.frame(np.zeros(1, np.float32))
        dose += float(env.unwrapped.get_info()["agent_temperature"][0]) ** 3.61 / 4.1e8 / 60.0 / 30.0
    (loads,) = account.loads().values()
    env.close()
    assert dose > 0.0 and loads.heat == pytest.approx(dose, rel=0.02)
    assert loads.wading is None and loads.water is None


def test_water_is_its_depth_over_time() -> None:
    env = environment("HazardPool-v1", affects_agent=True)
    account, stage = watched(env)
    depths = []
    for _ in drive(env, 0.0, 900):
        stage.frame += 1
        account.frame(np.zeros(1, np.float32))
        depths.append(float(env.unwrapped.get_info()["water_depth"][0]))
    (loads,) = account.loads().values()
    env.close()
    assert loads.water == pytest.approx(sum(depths) / 30.0, rel=0.02) and loads.water > 0.1
    assert loads.wading == pytest.approx(sum(d > 0.01 for d in depths) / 30.0, abs=0.4) and loads.heat is None


def test_without_effects_on_the_robot_only_collisions_are_told() -> None:
    env = environment()
    account, stage = watched(env)
    for _ in drive(env, 0.0, 10):
        stage.frame += 1
        account.frame(np.zeros(1, np.float32))
    (loads,) = account.loads().values()
    assert loads.collisions == 0 and loads.heat is None and loads.wading is None
    env.close()


def world() -> World:
    """A world with one body, 1 m above the origin."""
    spec = dataclasses.replace(ROOM, fixtures=())
    return World.of((spec,), [[(0.1, 0.1, 0.1)]], [[1.0]])


def test_a_thing_s_place_is_where_a_hand_last_put_it() -> None:
    one = world()
    place, rested = one.position.clone(), torch.full_like(one.value, SETTLING)
    one.position[..., 0] += 0.2
    follow(place, rested, one, 0.1)
    assert not strayed(place, one).any()
    one.position[..., 0] += 0.1  # 0.3 m by itself
    assert strayed(place, one).all()
    one.held[:] = True
    follow(place, rested, one, 0.1)
    one.held[:] = False
    one.position[..., 0] += 2.0
    follow(place, rested, one, 0.1)  # it falls and rolls a little
    assert not strayed(place, one).any()
    for _ in range(10):
        follow(place, rested, one, 0.1)
    one.position[..., 1] += 0.3
    follow(place, rested, one, 0.1)
    assert strayed(place, one).all()


def played(actions: tuple[tuple[str, str | None], ...]) -> EpisodeResult:
    options = EpisodeOptions("HazardWind-v1", agent="random", split="test", seed=1)
    return play(options, [Account()], Recorded(actions, "random"), max_episode_steps=FRAMES)


@pytest.mark.render
def test_what_happens_after_an_agent_stops_counts() -> None:
    """The loss of one that stops at once is that of one that stays, and what a robot that stands still sees."""
    first, last = played(()), played((("explore", None),) * 5)
    assert first.frames == 0 and last.frames == FRAMES and first.lost == last.lost
    env = environment("HazardWind-v1", split="test")
    env.reset(seed=1)
    base = env.unwrapped
    start, spec = base.world.position[0].clone(), base.specs[0]
    for _ in drive(env, 0.0, FRAMES):
        pass
    moved = (base.world.position[0] - start).norm(dim=-1) > 0.25
    values = [base.world.value[0, k] * float(moved[k]) for k in range(len(spec.bodies)) if base.world.target[0, k]]
    env.close()
    assert first.lost is not None and 0.0 < float(sum(values)) == first.lost.targets < first.lost.targets_total
