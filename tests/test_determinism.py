"""The same seed gives the same bits: after other episodes, in a new environment, in a new process; and snapshots branch exactly."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401
from tests.episodes import actions, episode

SEEDS = list(range(10))
STEPS = 300


def start(seeds: list[int], hash_seed: str, physics: str = "paper") -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.episodes", "--steps", str(STEPS), "--physics", physics, *map(str, seeds)]
    environ = {**os.environ, "PYTHONHASHSEED": hash_seed, "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[1], env=environ)


def result(process: subprocess.Popen[str]) -> dict[str, str]:
    out, _ = process.communicate(timeout=280)
    assert process.returncode == 0
    return json.loads(out.strip().splitlines()[-1])


def test_same_bits_after_other_episodes_and_in_a_new_process() -> None:
    """Ten seeds forwards in one process, backwards in another: every episode comes after other ones, with other hash seeds."""
    forwards, backwards = start(SEEDS, "1"), start(SEEDS[::-1], "2")
    first, second = result(forwards), result(backwards)
    assert first == second
    assert len(set(first.values())) == len(SEEDS), "different seeds must give different episodes"


def test_same_bits_in_a_new_environment_and_with_shipped_physics() -> None:
    process = start([3, 4], "3", "shipped")
    envs = [gym.make("HazardFire-v1", obs_mode="state", render_backend="none", physics="shipped") for _ in range(2)]
    here = [episode(envs[0], 4, STEPS), episode(envs[1], 4, STEPS)]
    assert here[0] == here[1] == result(process)["4"]


@pytest.fixture
def env() -> Any:
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none")
    yield made
    made.close()


def hazards_of(env: Any) -> dict[str, torch.Tensor]:
    saved = env.unwrapped.get_state_dict()["hazard_ms"]
    return {f"{part}.{k}": v for part in ("fire", "damage", "rescue", "chance") for k, v in saved[part].items()}


@pytest.mark.parametrize("flat", [False, True])
def test_a_snapshot_branches_exactly(env: Any, flat: bool) -> None:
    """Restore and replay: hazard, damage and chance are the same to the bit at every frame."""
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
    """With the robot driving into things, bodies agree within what reliability.md M4 measured for restored states (1e-2 m here)."""
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


def test_a_state_of_another_make_is_refused(env: Any) -> None:
    env.reset(seed=0)
    saved = env.unwrapped.get_state_dict()
    del saved["hazard_ms"]["damage"]
    with pytest.raises(ValueError, match="damage"):
        env.unwrapped.set_state_dict(saved)
    with pytest.raises(ValueError, match="numbers"):
        env.unwrapped.set_state(torch.zeros(1, 7))
