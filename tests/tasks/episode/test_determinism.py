"""The same seed gives the same bits after other episodes, in new environments and processes; snapshots are exact."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

from tests.worlds.episodes import actions, episode, made

SEEDS = list(range(3))
STEPS = 300


def start(
    seeds: list[int], hash_seed: str, physics: str = "paper", env_id: str = "HazardFire-v1", steps: int = STEPS
) -> subprocess.Popen[str]:
    options = ["--steps", str(steps), "--physics", physics, "--env-id", env_id]
    command = [sys.executable, "-m", "tests.worlds.episodes", *options, *map(str, seeds)]
    environ = {**os.environ, "PYTHONHASHSEED": hash_seed, "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3], env=environ)


def result(process: subprocess.Popen[str]) -> dict[str, str]:
    out, _ = process.communicate(timeout=280)
    assert process.returncode == 0
    return json.loads(out.strip().splitlines()[-1])


@pytest.mark.long  # the usual tests compare other processes' episodes: tests/env/test_episode_hashes.py
def test_same_bits_after_other_episodes_and_in_a_new_process() -> None:
    """Three seeds forwards in one process and backwards in another, so that every episode comes after other ones."""
    forwards, backwards = start(SEEDS, "1"), start(SEEDS[::-1], "2")
    first, second = result(forwards), result(backwards)
    assert first == second
    assert len(set(first.values())) == len(SEEDS), "different seeds must give different episodes"


@pytest.mark.long
@pytest.mark.parametrize("physics", ["paper", "realistic"])
@pytest.mark.parametrize("env_id", ["HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1"])
def test_same_bits_in_every_task(env_id: str, physics: str) -> None:
    """Sixty things float, or fifteen are blown along the ground, and hit each other: 300 frames in two processes."""
    forwards, backwards = start([0, 1], "1", physics, env_id), start([1, 0], "2", physics, env_id)
    first = result(forwards)
    assert first == result(backwards) and len(set(first.values())) == 2


@pytest.mark.long
def test_same_bits_in_a_new_environment_and_with_shipped_physics() -> None:
    process = start([3, 4], "3", "shipped")
    envs = [made("HazardFire-v1", physics="shipped") for _ in range(2)]
    here = [episode(envs[0], 4, STEPS), episode(envs[1], 4, STEPS)]
    assert here[0] == here[1] == result(process)["4"]


@pytest.fixture
def env(request: pytest.FixtureRequest) -> Any:
    one = made(getattr(request, "param", "HazardFire-v1"))
    yield one
    one.close()


@pytest.fixture(scope="module")
def kitchen() -> Any:
    one = made("HazardFire-v1")
    one.reset(seed=0)
    yield one
    one.close()


def hazards_of(env: Any) -> dict[str, torch.Tensor]:
    saved = env.unwrapped.get_state_dict()["hazard_ms"]
    return {f"{part}.{k}": v for part in ("fire", "damage", "rescue", "chance") for k, v in saved[part].items()}


@pytest.mark.parametrize("flat", [False, True])
def test_a_snapshot_branches_exactly(env: Any, flat: bool) -> None:
    """A replay after a restore has bitwise the same hazards, damage and random numbers in every frame."""
    env.reset(seed=5)
    base = env.unwrapped
    for _ in range(200):
        env.step(None)  # nothing touches anything, so bodies are restored exactly too
    saved = base.get_state() if flat else base.get_state_dict()
    told = [hazards_of(env) for _ in range(150) if env.step(None)]
    (base.set_state if flat else base.set_state_dict)(saved)
    for want in told:
        env.step(None)
        got = hazards_of(env)
        for name, value in want.items():
            assert torch.equal(got[name], value), name


def test_a_snapshot_keeps_bodies_within_the_limits_of_maniskill(env: Any) -> None:
    """With the robot driving into things, bodies agree as well as restored states do (docs/reliability.md M4)."""
    env.reset(seed=6)
    base = env.unwrapped
    drive = actions(env, 6, 120)
    for action in drive[:60]:
        env.step(action)
    saved = base.get_state_dict()

    def play() -> torch.Tensor:
        for action in drive[60:]:
            env.step(action)
        return base.world.position.clone()

    want = play()
    base.set_state_dict(saved)
    moved = (play() - want).norm(dim=-1)
    assert float(moved.median()) < 1e-4
    assert float(moved.max()) < 0.5


@pytest.mark.parametrize("env", ["HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1"], indirect=True)
def test_a_snapshot_of_moving_things_continues_nearly_the_same(env: Any) -> None:
    """After a restore, clocks and random numbers of hazards agree exactly, bodies nearly: contacts are not saved."""
    env.reset(seed=2)
    base = env.unwrapped
    for _ in range(260):
        env.step(None)
    saved = base.get_state_dict()
    moving = base.world.velocity.norm(dim=-1).max()

    def play() -> tuple[torch.Tensor, dict[str, torch.Tensor]]:
        for _ in range(40):
            env.step(None)
        states = {f"{n}.{k}": v.clone() for n, s in base.episode.states.items() for k, v in s.save().items()}
        return base.world.position.clone(), states

    want, told = play()
    base.set_state_dict(saved)
    assert torch.equal(base.world.frame, torch.full_like(base.world.frame, 260))
    place, got = play()
    assert float(moving) > 1e-3, "nothing moved, so the test shows nothing"
    assert float((place - want).norm(dim=-1).median()) < 1e-3
    for name in ("flood.level", "wind.speed", "wind.gust", "wind.sway"):
        assert name not in told or torch.equal(told[name], got[name]), name


def test_what_is_in_the_bag_is_there_again_after_a_restore(env: Any) -> None:
    env.reset(seed=0)
    base = env.unwrapped
    target = int(base.world.target[0].nonzero()[0, 0])
    base.episode.rescue.mark(base.world, torch.arange(base.world.num_bodies)[None] == target, base.episode.damage)
    base.world.away |= base.world.safe
    saved = base.get_state_dict()
    env.reset(seed=0)
    assert not base.world.away.any()
    base.set_state_dict(saved)
    assert base.world.away[0].nonzero().flatten().tolist() == [target]
    env.step(None)
    assert float(base.world.position[0, target, 2]) < -5.0, "it waits out of sight"


SPOILT = {
    ("fire", "temperature"): [torch.nan, torch.inf, 1e30],
    ("fire", "threshold"): [torch.nan, -torch.inf],
    ("fire", "status"): [0.5, 3, -1],
    ("fire", "flame_cell"): [10**7, -2],
    ("damage", "damaged"): [2, 0.5, torch.nan],
    ("damage", "frame"): [-2, 0.5],
    ("hand", "held"): [-2, 10**6],
    ("bodies", "asleep"): [2],
    ("chance", "seed"): [-1, 2**16, 0.5],
    ("chance", "frame"): [-1, 2**31],
}


@pytest.mark.parametrize(("part", "name"), SPOILT)
def test_states_that_no_sound_simulation_has_are_refused(kitchen: Any, part: str, name: str) -> None:
    base = kitchen.unwrapped
    saved = base.get_state_dict()
    for value in SPOILT[part, name]:
        state = copy.deepcopy(saved)
        entry = state["hazard_ms"][part][name].double()
        entry[0, -1] = value
        state["hazard_ms"][part][name] = entry
        with pytest.raises(ValueError, match=f"state.hazard_ms.{part}.{name} must hold"):
            base.set_state_dict(state)
        now = base.get_state_dict()
        for key in saved["hazard_ms"]:
            for k, v in saved["hazard_ms"][key].items():
                assert torch.equal(now["hazard_ms"][key][k], v), (key, k)


def test_bodies_and_robots_must_be_turned_by_something_and_be_somewhere(kitchen: Any) -> None:
    base = kitchen.unwrapped
    saved = base.get_state_dict()
    for kind in ("actors", "articulations"):
        name = next(iter(saved[kind]))
        for where, value in ((slice(3, 7), 0.0), (slice(3, 7), 2.0), (slice(0, 3), torch.nan), (slice(7, 9), 1e20)):
            state = copy.deepcopy(saved)
            state[kind][name][:, where] = value
            with pytest.raises(ValueError, match=f"state.{kind}.{name} must hold"):
                base.set_state_dict(state)
            assert torch.equal(base.get_state_dict()[kind][name], saved[kind][name])


def test_a_saved_state_is_a_copy_of_the_controllers_too() -> None:
    """ManiSkill hands out the very tensor in which a controller keeps its target."""
    env = gym.make("HazardFire-v1", obs_mode="none", render_backend="none", control_mode="pd_joint_target_delta_pos")
    env.reset(seed=0)
    saved = env.unwrapped.get_state_dict()
    before = copy.deepcopy(saved["controller"])
    env.unwrapped.agent.controller.controllers["arm"]._target_qpos += 1.0
    assert torch.equal(saved["controller"]["arm"]["target_qpos"], before["arm"]["target_qpos"])
    env.unwrapped.set_state_dict(saved)
    env.unwrapped.agent.controller.controllers["arm"]._target_qpos += 1.0
    assert torch.equal(saved["controller"]["arm"]["target_qpos"], before["arm"]["target_qpos"])
    env.close()


def test_a_state_of_another_environment_is_refused(env: Any) -> None:
    env.reset(seed=0)
    saved = env.unwrapped.get_state_dict()
    del saved["hazard_ms"]["damage"]
    with pytest.raises(ValueError, match="state.hazard_ms must have an entry 'damage'"):
        env.unwrapped.set_state_dict(saved)
    with pytest.raises(ValueError, match="the flat state must have .* numbers, got 7"):
        env.unwrapped.set_state(torch.zeros(1, 7))
