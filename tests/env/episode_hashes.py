"""Hashes of what happens in episodes: bodies, robot, hazards, damage and reward.

They do not depend on the layout of observations, nor on the names of the fields of a state, but on their order. As a
program it prints them as JSON, for one task and preset; with `--write` it records all of them in `episode_hashes.json`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.machine.cores import maker
from hazard_ms.machine.diagnosis import installed_version
from tests.worlds.episodes import actions

RECORD = Path(__file__).with_name("episode_hashes.json")
TASKS = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")
PRESETS = ("paper", "shipped", "realistic")
SEEDS = (0, 1, 2)
STEPS = 300


def machine() -> dict[str, str | None]:
    """What the bits of an episode depend on besides the project's own code: not on the processor, if it has AVX2."""
    names = ("sapien", "mani-skill", "torch", "warp-lang", "numpy")
    return {
        "processor": "AVX2" if torch.backends.cpu.get_cpu_capability().startswith("AVX") else "without AVX2",
        "C library": " ".join(platform.libc_ver()),
        **{name: installed_version(name) for name in names},
    }


def feed(digest: Any, value: Any) -> None:
    """Add every number of a nested state to `digest`, bit by bit, in the order in which the state is declared."""
    if isinstance(value, dict):
        for part in value.values():
            feed(digest, part)
    else:
        array = value.cpu().numpy() if isinstance(value, torch.Tensor) else np.asarray(value)
        digest.update(np.ascontiguousarray(array).tobytes())


def episode_hash(env: Any, seed: int, steps: int) -> str:
    """Hash of every frame's bodies, robot joints, hazard records and reward."""
    digest = hashlib.sha256()
    env.reset(seed=seed)
    base = env.unwrapped
    for action in actions(env, seed, steps):
        _, reward, _, _, _ = env.step(action)
        world = base.world
        for tensor in (world.position, world.rotation, world.velocity, world.angular_velocity, reward):
            feed(digest, tensor)
        for joints in (base.agent.robot.get_qpos(), base.agent.robot.get_qvel()):
            feed(digest, joints)
        for name in sorted(base.episode.parts):
            feed(digest, base.episode.parts[name].save())
    return digest.hexdigest()


def hashes(env_id: str, physics: str, seeds: tuple[int, ...] = SEEDS) -> dict[str, str]:
    """By seed: the hash of an episode of `env_id` with the preset `physics`."""
    torch.set_num_threads(1)
    env = gym.make(env_id, obs_mode="state", render_backend="none", physics=physics, control_mode="pd_joint_pos")
    found = {str(seed): episode_hash(env, seed, STEPS) for seed in seeds}
    env.close()
    return found


def recorded(env_id: str, physics: str) -> dict[str, str]:
    """By seed: the hash in the record, that of processors of this maker where it has one of its own."""
    record = json.loads(RECORD.read_text())
    own = record["makers"].get(maker(), {})
    return dict(record["hashes"][key(env_id, physics)] | own.get(key(env_id, physics), {}))


def key(env_id: str, physics: str) -> str:
    """Under which the record keeps the hashes of a task and a preset."""
    return f"{env_id} {physics}"


def write() -> None:
    """Record the hashes of all tasks and presets, each in a new process."""
    found = {}
    for env_id in TASKS:
        for physics in PRESETS:
            command = [sys.executable, "-m", "tests.env.episode_hashes", env_id, physics]
            out = subprocess.run(
                command, stdout=subprocess.PIPE, text=True, check=True, cwd=Path(__file__).parents[2]
            ).stdout
            found[key(env_id, physics)] = json.loads(out.splitlines()[-1])
    others = json.loads(RECORD.read_text())["makers"]
    RECORD.write_text(json.dumps({"machine": machine(), "hashes": found, "makers": others}, indent=1) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--write", action="store_true")
    parser.add_argument("env_id", nargs="?", default=TASKS[0])
    parser.add_argument("physics", nargs="?", default=PRESETS[0])
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    args = parser.parse_args()
    if args.write:
        write()
    else:
        print(json.dumps(hashes(args.env_id, args.physics, tuple(args.seeds))))


if __name__ == "__main__":
    main()
