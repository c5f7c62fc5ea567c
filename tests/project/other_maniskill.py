"""Plays every task and drives every robot for a moment, with whatever ManiSkill is installed; prints what breaks.

It also hashes an episode of fire, of flood and of wind, and compares the hashes with those recorded for the lock.
"""

from __future__ import annotations

import json
import sys
import traceback
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.machine.diagnosis import installed_version
from hazard_ms.spec.registry import ROBOTS, TASKS
from tests.env.episode_hashes import RECORD, hashes, key, machine
from tests.env.episode_hashes import TASKS as HASHED

FRAMES = 10
PHYSICS = "paper"
ROOM = "HazardFire-v1"  # in which robots are tried


def play(env_id: str) -> None:
    """Reset a task and play some frames of it."""
    env = gym.make(env_id, obs_mode="state", render_backend="none")
    env.reset(seed=0)
    for _ in range(FRAMES):
        env.step(env.action_space.sample())
    env.close()


def drive(told: str) -> None:
    """Switch a robot to one of its control modes, told as "fetch pd_joint_pos", and play some frames."""
    robot, mode = told.split()
    env: Any = gym.make(ROOM, robot_uids=robot, obs_mode="state", render_backend="none")
    env.reset(seed=0)
    still = np.zeros(env.unwrapped.agent.action_size(mode), np.float32)
    for _ in range(FRAMES):
        env.step({"control_mode": mode, "action": still})
    env.close()


def modes() -> list[str]:
    """Every robot with each of its control modes."""
    made = []
    for robot in ROBOTS:
        env = gym.make(ROOM, robot_uids=robot, obs_mode="none", render_backend="none")
        made += [f"{robot} {mode}" for mode in env.unwrapped.agent.supported_control_modes]  # type: ignore[attr-defined]
        env.close()
    return made


def same_bits(env_id: str) -> None:
    """Raises AssertionError unless an episode has the hash that is recorded for the lock."""
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    others = {name for name, value in machine().items() if record["machine"][name] != value} - {"mani-skill"}
    if others:
        print(f"{env_id}: no hash to compare with, since {', '.join(sorted(others))} differ")
    elif hashes(env_id, PHYSICS, (0,))["0"] != record["hashes"][key(env_id, PHYSICS)]["0"]:
        raise AssertionError("an episode has other bits")
    else:
        print(f"{env_id}: the same bits")


def main() -> int:
    """Try everything. Returns how many things broke."""
    print(f"mani-skill {installed_version('mani-skill')}, sapien {installed_version('sapien')}")
    tried: dict[Callable[[str], None], Sequence[str]] = {play: [*TASKS], drive: modes(), same_bits: HASHED}
    broken = 0
    for what, names in tried.items():
        for name in names:
            try:
                what(name)
            except Exception as error:
                broken += 1
                traceback.print_exc()
                print(f"{name}: {what.__name__} broke: {type(error).__name__}: {error}", flush=True)
    print(f"{broken} of {sum(map(len, tried.values()))} broke")
    return broken


if __name__ == "__main__":
    sys.exit(bool(main()))
