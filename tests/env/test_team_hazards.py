"""Hazards act on each robot of a team: what it bears is told by its name, and it alone is held back."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from tests.env.episode_hashes import feed
from tests.env.test_teams import PLAIN, still
from tests.hazards.test_affects_agent import FIRE, RADIUS, TASK, in_the_hall
from tests.worlds.registering import registered_task

PAIR = ("fetch", "fetch")


@pytest.fixture(scope="module")
def hall() -> Iterator[Any]:
    with registered_task(TASK, in_the_hall):
        made = gym.make(TASK, robot_uids=PAIR, affects_agent=True, reconfiguration_freq=0, **PLAIN)
        yield made
        made.close()


def stand(env: Any, *places: tuple[float, float]) -> Any:
    """Begin anew with robots at `places` [m] relative to the fire, facing east, and a fire that does not spread."""
    env.reset(seed=0)
    base = env.unwrapped
    for member, (x, y) in zip(base.members, places, strict=True):
        at = torch.tensor([[FIRE[0] + x, FIRE[1] + y]])
        member.agent.place(torch.tensor([0]), at, torch.tensor([0.0]))
    base.members.see()
    base.episode.states["fire"].flame_used[:] = 15
    return base


@pytest.mark.parametrize("near", [0, 1])
def test_the_robot_beside_the_fire_overheats_and_the_other_does_not(hall: Any, near: int) -> None:
    """F-18: 1 m from a fire after 14 updates; the other robot, 10 m off, weighs 0.0025 of the room."""
    places = [(-7.0, -7.0), (-7.0, -7.0)]
    places[near], places[1 - near] = (-1.0, 0.0), (-7.0, -7.0)
    stand(hall, *places)
    told = [hall.step(still(hall))[4] for _ in range(70)]
    names = "fetch-0", "fetch-1"
    hot = [[bool(info[f"{name}-agent_overheated"]) for info in told] for name in names]
    assert hot[near].index(True) == 69 and not any(hot[1 - near])
    around = (20.0 + 600.0 * 0.25) / 1.25
    want = around + (20.0 - around) * 0.97**14
    assert float(told[-1][f"{names[near]}-agent_temperature"]) == pytest.approx(want, abs=0.2)
    assert "agent_temperature" not in told[-1]  # of whom it would be nobody knows


@pytest.mark.parametrize("mover", [0, 1])
def test_each_robot_is_kept_out_of_the_fire(hall: Any, mover: int) -> None:
    """Both drive east for 200 frames, 3.2 m: the one that comes to the fire stops before it."""
    places = [(-1.0, 5.0), (-1.0, 5.0)]
    places[mover] = (-1.0, 0.0)
    base = stand(hall, *places)
    for _ in range(200):
        going = {m.name: m.agent.action(m.agent.build.forward_step, 0.0, m.agent.tucked, True) for m in base.members}
        info = hall.step(going)[4]
        assert not bool(info[f"fetch-{mover}-agent_in_fire"])
    (held, _, _), (free, _, _) = (base.members[k].agent.base() for k in (mover, 1 - mover))
    assert FIRE[0] - RADIUS - 0.25 < held < FIRE[0] - RADIUS
    assert free > FIRE[0] + 1.0


def test_a_robot_that_lies_stays_where_it_is_and_the_other_drives() -> None:
    env: Any = gym.make("HazardWind-v1", robot_uids=("fetch", "g1"), physics="realistic", affects_agent=True, **PLAIN)
    env.reset(seed=0)
    base = env.unwrapped
    state = base.episode.states["wind"]
    state.speed[:], state.gust[:] = 1.0, 0.0
    turning = {m.name: m.agent.action(0.0, m.agent.build.turn_step, m.agent.tucked, True) for m in base.members}
    for _ in range(5):
        env.step(turning)
    state.lies[0] = torch.tensor([False, True])
    state.lain[:] = 0.0
    before = [m.agent.base() for m in base.members]
    for _ in range(10):
        info = env.step(turning)[4]
    turned = [abs(m.agent.base()[2] - then[2]) for m, then in zip(base.members, before, strict=True)]
    assert turned[0] > 0.3 and turned[1] < 0.05
    assert not bool(info["fetch-0-agent_fallen"]) and bool(info["g1-1-agent_fallen"])
    env.close()


def played(env: Any, frames: int) -> bytes:
    """Everything in `frames` in which both robots drive on and turn, by draws from a fixed seed."""
    digest, draw, base = hashlib.sha256(), np.random.default_rng(5), env.unwrapped
    for _ in range(frames):
        actions = still(env)
        for name in actions:
            actions[name][-2:] = draw.uniform(-1.0, 1.0, 2)
        info = env.step(actions)[4]
        feed(digest, base.members.joints())
        for part in base.episode.parts.values():
            feed(digest, part.save())
        for name in sorted(info):
            feed(digest, info[name])
    return digest.digest()


@pytest.mark.parametrize("physics", ["paper", "realistic"])
def test_episodes_repeat_and_go_on_from_a_saved_state(physics: str) -> None:
    """Restored, bodies are where they were within 1e-5 (docs/reliability.md M4), so what robots bear is as near."""
    env: Any = gym.make("HazardFire-v1", robot_uids=PAIR, physics=physics, affects_agent=True, **PLAIN)
    base = env.unwrapped
    env.reset(seed=3)
    first, saved = played(env, 40), base.get_state_dict()
    rest, after = played(env, 30), base.get_state_dict()["hazard_ms"]
    env.reset(seed=3)
    assert played(env, 40) == first and played(env, 30) == rest
    base.set_state_dict(saved)
    for name, record in base.get_state_dict()["hazard_ms"].items():
        assert all(torch.equal(value, saved["hazard_ms"][name][key]) for key, value in record.items()), name
    played(env, 30)
    now = base.get_state_dict()["hazard_ms"]
    assert torch.equal(now["fire"]["flame_place"], after["fire"]["flame_place"])
    assert torch.allclose(now["fire"]["agent_temperature"], after["fire"]["agent_temperature"], atol=1e-3)
    assert after["fire"]["agent_temperature"].shape == (1, 2)
    env.close()


def test_homes_and_gales_act_on_teams_by_default() -> None:
    for task, acts in (("HazardHouseFlood-v1", True), ("HazardGale-v1", True), ("HazardFlood-v1", False)):
        env: Any = gym.make(task, robot_uids=PAIR, **PLAIN)
        _, info = env.reset(seed=0)
        told = {"fetch-0-water_depth", "fetch-1-agent_wind"} & info.keys()
        assert env.unwrapped.affects_agent == bool(told) == acts
        env.close()
