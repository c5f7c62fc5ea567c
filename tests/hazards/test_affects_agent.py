"""affects_agent=True in the whole environment: the robot heats up beside a fire, is kept from burning floor, and info
says so.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.registering import registered_task

TASK = "HazardHall-v1"
FIRE = (10.0, 10.0)  # [m]
CELL = 0.22  # edge of a burning cell (docs/physics.md 1.1) [m]
RADIUS = 0.28  # of Fetch's base (its maker's data sheet: 0.559 m across) [m]
TOLD = ("agent_temperature", "agent_overheated", "agent_in_fire")
HALL = SceneSpec(  # a hall with one fire in its middle and a pan, which cannot burn, far away
    name="test/hall",
    room=Room((20.0, 20.0)),
    fixtures=(),
    bodies=(Body("pan_1", "pan", "pan_1", (1.0, 1.0, 0.0)),),
    target_categories=("pan",),
    fires=(FIRE,),
    agent_start=AgentStart((5.0, 5.0)),
)


def in_the_hall(physics: str) -> Task:
    return dataclasses.replace(hazard_fire(physics), scenes=lambda split: (HALL.name,), build=lambda name: HALL)


def hall(affects_agent: bool, physics: str = "paper") -> Any:
    keywords = dict(affects_agent=affects_agent, physics=physics, reconfiguration_freq=0, control_mode="pd_joint_pos")
    made = gym.make(TASK, obs_mode="state", render_backend="none", **keywords)
    made.reset(seed=0)
    return made


@pytest.fixture(scope="module", autouse=True)
def task_in_the_hall() -> Iterator[None]:
    with registered_task(TASK, in_the_hall):
        yield


@pytest.fixture(scope="module", params=["paper", "shipped"])
def affected(request: pytest.FixtureRequest) -> Iterator[Any]:
    made = hall(True, request.param)
    yield made
    made.close()


@pytest.fixture(scope="module")
def paper() -> Iterator[Any]:
    made = hall(True)
    yield made
    made.close()


@pytest.fixture(scope="module")
def unaffected() -> Iterator[Any]:
    made = hall(False)
    yield made
    made.close()


def stand(env: Any, x: float, y: float, heading: float = 0.0, spreads: bool = False) -> None:
    """Begin anew with the robot at (x, y) [m], relative to the fire."""
    env.reset(seed=0)
    base = env.unwrapped
    base.agent.place(torch.tensor([0]), torch.tensor([[FIRE[0] + x, FIRE[1] + y]]), torch.tensor([heading]))
    base.episode.see(base.agent)
    if not spreads:
        base.episode.states["fire"].flame_used[:] = 15


def drive(env: Any, frames: int, way: float = 1.0) -> Iterator[dict[str, Any]]:
    """Full speed ahead, or back for a `way` of -1; info of every frame."""
    agent = env.unwrapped.agent
    for _ in range(frames):
        yield env.step(agent.action(way * agent.build.forward_step, 0.0, agent.tucked, True))[4]


def overlap(env: Any) -> float:
    """How far the round base reaches into a cell that has burned since the start [m]; negative: how far it is
    from all.
    """
    x, y = env.unwrapped.world.agent_position[0, :2].tolist()
    out = [max(abs(at - middle) - CELL / 2, 0.0) for at, middle in zip((x, y), FIRE, strict=True)]
    return RADIUS - float(np.hypot(*out))


@pytest.mark.parametrize(("distance", "updates"), [(0.5, 5), (1.0, 14), (1.5, 39)])
def test_it_overheats_beside_a_fire_after_so_many_updates(affected: Any, distance: float, updates: int) -> None:
    """F-18: Updates come every 5 frames. The pan, 13 m off, weighs 0.0015 of the room: too little to change a count."""
    stand(affected, -distance, 0.0)
    told = [affected.step(None)[4] for _ in range(5 * updates)]
    hot = [bool(info["agent_overheated"]) for info in told]
    assert hot.index(True) == 5 * updates - 1
    around = (20.0 + 600.0 * (0.5 / distance) ** 2) / (1.0 + (0.5 / distance) ** 2)
    want = around + (20.0 - around) * 0.97**updates
    assert float(told[-1]["agent_temperature"]) == pytest.approx(want, abs=0.1)
    assert not any(bool(info["agent_in_fire"]) for info in told)


def test_it_never_overheats_two_metres_from_a_fire(affected: Any) -> None:
    """F-18: it ends at 54.12 C. 1,000 updates of the heat alone, without the frames between them."""
    stand(affected, 0.0, 2.0)
    base = affected.unwrapped
    for _ in range(1000):
        base.world.chance.frame += 5
        base.task.hazards[0].advance(base.episode.states["fire"], base.world, 1 / 30)
    told = affected.step(None)[4]
    assert float(told["agent_temperature"]) == pytest.approx(54.12, abs=0.05) and not bool(told["agent_overheated"])


def test_it_cools_down_when_it_has_left(paper: Any) -> None:
    stand(paper, -1.0, 0.0)
    warm = [float(paper.step(None)[4]["agent_temperature"]) for _ in range(50)]
    paper.unwrapped.agent.place(torch.tensor([0]), torch.tensor([[18.0, 18.0]]), torch.tensor([0.0]))
    cool = [float(paper.step(None)[4]["agent_temperature"]) for _ in range(50)]
    assert warm == sorted(warm) and cool == sorted(cool, reverse=True) and 20.0 < cool[-1] < warm[-1] - 5.0


@pytest.mark.parametrize(("heading", "aside"), [(0.0, 0.0), (2.0, 0.0), (0.0, -0.25), (2.0, 0.35), (-2.4, 0.15)])
def test_its_base_never_gets_onto_burning_floor(paper: Any, heading: float, aside: float) -> None:
    """200 frames at full speed would carry it 3.2 m; it starts 1 m before the flame, aiming `aside` of its
    middle [m].
    """
    x = -np.cos(heading) - aside * np.sin(heading)
    y = -np.sin(heading) + aside * np.cos(heading)
    stand(paper, float(x), float(y), heading)
    deepest = -1.0
    for info in drive(paper, 200):
        deepest = max(deepest, overlap(paper))
        assert not bool(info["agent_in_fire"])
    assert -0.1 < deepest <= 0.0  # it came near, so it was the fire that stopped it


def test_it_may_turn_round_and_leave(paper: Any) -> None:
    stand(paper, -1.0, 0.0)
    list(drive(paper, 100))
    agent = paper.unwrapped.agent
    for _ in range(30):
        paper.step(agent.action(0.0, agent.build.turn_step, agent.tucked, True))
    list(drive(paper, 60))
    assert float(paper.unwrapped.world.agent_position[0, 0]) < FIRE[0] - 1.0


def test_it_may_leave_a_fire_that_was_lit_under_it(paper: Any) -> None:
    """The flame is 0.25 m ahead, so the base covers its cell: not over it, but back from it."""
    stand(paper, -0.25, 0.0)
    assert not any(bool(info["agent_in_fire"]) for info in drive(paper, 60))
    list(drive(paper, 60, -1.0))
    assert float(paper.unwrapped.world.agent_position[0, 0]) < FIRE[0] - 0.9


def test_it_stays_out_of_a_fire_that_spreads(paper: Any) -> None:
    """Flames are born where they like, but the middle of a base that drives at them stays off every cell that burned
    before.
    """
    stand(paper, -1.2, 0.0, spreads=True)
    for _ in range(400):
        paper.unwrapped.advance(None)
    fire, world = paper.unwrapped.episode.states["fire"], paper.unwrapped.world
    assert int((fire.flame_cell >= 0).sum()) > 1
    for info in drive(paper, 120):
        burning = fire.flame_place[0, (fire.flame_cell[0] >= 0) & (fire.flame_birth[0] <= 400), :2]
        assert ((burning - world.agent_position[0, :2]).abs().amax(1) > CELL / 2).all()
        assert bool(info["agent_overheated"]) == (float(info["agent_temperature"]) > 60.0)


def test_unaffected_it_passes_and_is_not_told(unaffected: Any) -> None:
    stand(unaffected, -1.0, 0.0)
    deepest = -1.0
    for info in drive(unaffected, 200):
        deepest = max(deepest, overlap(unaffected))
        assert not set(TOLD) & set(info)
    assert deepest == pytest.approx(RADIUS, abs=0.02)  # its middle was on the burning cell
    assert float(unaffected.unwrapped.world.agent_position[0, 0]) > FIRE[0] + 1.5


def test_info_tells_of_the_agent_as_batches(paper: Any) -> None:
    stand(paper, -1.0, 0.0)
    _, info = paper.reset(seed=1)
    for told in (info, paper.step(None)[4]):
        assert {k: (tuple(told[k].shape), told[k].dtype) for k in TOLD if k in told} == {
            "agent_temperature": ((1,), torch.float32),
            "agent_overheated": ((1,), torch.bool),
            "agent_in_fire": ((1,), torch.bool),
        }
    assert float(paper.step(None)[4]["agent_temperature"]) == 20.0
