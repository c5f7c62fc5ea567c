"""Observation spaces: bounded where the quantity is, the same in every scene, pinned together with their version."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from gymnasium.spaces.utils import flatten_space
from mani_skill.utils.common import flatten_state_dict

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.sensing.observation_table import OBSERVATION_VERSION
from hazard_ms.spec.registry import ROBOTS, TASKS

PINNED = Path(__file__).with_name("layouts.json")
STATE, IMAGES = ("state", "state_dict"), ("rgb+depth+segmentation", "pointcloud")


def made(task: str, mode: str, robot: str = "fetch", **more: Any) -> Any:
    backend = {"render_backend": "none"} if mode in STATE else {"sensor_configs": {"width": 32, "height": 32}}
    return gym.make(task, obs_mode=mode, robot_uids=robot, **backend, **more)


def layout(space: gym.Space, path: str = "") -> list[str]:
    """Keys in order with their shapes, types and bounds."""
    if isinstance(space, gym.spaces.Dict):
        return [line for key, inner in space.items() for line in layout(inner, f"{path}/{key}")]
    assert isinstance(space, gym.spaces.Box)
    ends = [" ".join(f"{v:.4g}" for v in np.unique(end)) for end in (space.low, space.high)]
    bounds = hashlib.sha256(np.round(np.stack([space.low, space.high]).astype(np.float64), 4).tobytes()).hexdigest()[
        :12
    ]
    return [f"{path or '/'} {space.shape} {space.dtype} {bounds} {ends[0][:30]} | {ends[1][:30]}"]


def test_what_is_bounded_has_bounds() -> None:
    env = made("HazardFire-v1", "state_dict", max_episode_steps=100)
    space = env.unwrapped.single_observation_space
    extra, joints = space["extra"], space["agent"]["qpos"]
    for name in ("held", "target_held", "target_rescued", "target_damaged"):
        assert (extra[name].low == 0).all() and (extra[name].high == 1).all()
    assert (extra["frame"].low, extra["frame"].high) == (0, 1500)
    assert (extra["target_value"].low == 0).all() and (extra["target_value"].high == 5).all()
    assert extra["agent_pose"].high[2] == pytest.approx(2 * np.pi) and np.isinf(extra["agent_pose"].high[:2]).all()
    assert (extra["target_fire"].low >= -273.16).all()
    limits = {j.name: j.limits[0].reshape(-1).tolist() for j in env.unwrapped.agent.robot.active_joints}
    for k, name in enumerate(limits):
        low, high = limits[name]
        want = (low - 0.1, high + 0.1) if np.isfinite(low) else (-2 * np.pi, 2 * np.pi)
        assert (joints.low[k], joints.high[k]) == pytest.approx(want, abs=1e-5), name
    assert not space["agent"]["qvel"].is_bounded("both")
    env.close()


def test_numbers_of_targets_are_those_of_the_things_and_a_flat_state_holds_them_in_maniskills_order() -> None:
    env = made("HazardFire-v1", "state_dict")
    env.reset(seed=0)
    base = env.unwrapped
    world, damaged = base.world, base.episode.damage.damaged
    damaged[0, ::2] = world.held[0, 1::3] = True
    things = world.target[0].nonzero()[:, 0].tolist()
    obs = base.get_obs()
    of = {"target_position": world.position, "target_damaged": damaged, "target_held": world.held}
    for name, numbers in of.items():
        rows = obs["extra"][name][0].reshape(32, -1)
        for row, thing in enumerate(things):
            assert rows[row].tolist() == numbers[0, thing].float().reshape(-1).tolist(), (name, row)
        assert not rows[len(things) :].any()
    base._obs_mode = "state"
    assert torch.equal(base._flatten_raw_obs(obs), flatten_state_dict(obs, use_torch=True))
    env.close()


def test_a_longer_episode_widens_the_bound_of_the_frame() -> None:
    env = made("HazardFire-v1", "state_dict", max_episode_steps=4000)
    for space in (env.observation_space, env.unwrapped.single_observation_space):
        assert np.all(space["extra"]["frame"].high == 4000)
    env.close()


def test_the_flat_space_has_the_bounds_of_the_nested_one() -> None:
    row, nested = made("HazardFlood-v1", "state"), made("HazardFlood-v1", "state_dict")
    space = row.unwrapped.single_observation_space
    assert space == flat(nested.unwrapped.single_observation_space)
    assert row.observation_space.shape == (1, *space.shape)
    row.close()
    nested.close()


@pytest.mark.parametrize("task", ["HazardFire-v1", "HazardWind-v1"])
def test_the_space_is_the_same_in_every_scene(task: str) -> None:
    """Scenes have different numbers of things and of targets."""
    env = made(task, "state_dict")
    names = env.unwrapped.task.all_scenes
    spaces = []
    for name in (names[0], names[len(names) // 2], names[-1]):
        observation, _ = env.reset(options={"scene": name})
        spaces.append(env.unwrapped.single_observation_space)
        assert env.observation_space.contains({k: {n: v.numpy() for n, v in p.items()} for k, p in observation.items()})
    assert spaces[0] == spaces[1] == spaces[2]
    again = made(task, "state_dict", split="test")
    assert again.unwrapped.single_observation_space == spaces[0]
    env.close()
    again.close()


def test_a_wrapper_s_own_observations_get_a_space() -> None:
    """ManiSkill's way: `update_obs_space` with what the wrapper makes of an observation."""
    env = made("HazardFire-v1", "state_dict")
    base = env.unwrapped
    base.update_obs_space({"frame": base._init_raw_obs["extra"]["frame"], "twice": base._init_raw_obs["agent"]["qpos"]})
    assert list(base.single_observation_space) == ["frame", "twice"]
    assert flatten_space(base.single_observation_space).shape == (16,)
    env.close()


def pin(task: str, mode: str, robot: str) -> str:
    env = made(task, mode, robot)
    lines = layout(env.unwrapped.single_observation_space)
    lines = lines if mode in STATE else sorted(lines)  # ManiSkill gives textures in any order
    env.close()
    return digest(lines)


def digest(lines: list[str]) -> str:
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def flat(space: gym.spaces.Dict) -> gym.spaces.Box:
    """The space of the same numbers in a row."""
    found = [box for part in ("agent", "extra") for box in boxes(space[part])]
    low, high = (np.concatenate([getattr(box, end).ravel() for box in found]) for end in ("low", "high"))
    return gym.spaces.Box(low, high, dtype=np.float32)


def boxes(space: gym.Space) -> list[Any]:
    """The parts of a nested space, in order."""
    return [box for inner in space.values() for box in boxes(inner)] if isinstance(space, gym.spaces.Dict) else [space]


def test_the_pinned_layouts_are_those_of_this_version() -> None:
    """Any change of keys, order, shapes, types or bounds changes OBSERVATION_VERSION, and with it layouts.json."""
    pinned = json.loads(PINNED.read_text())
    assert pinned["version"] == OBSERVATION_VERSION
    for task in TASKS:
        for robot in ROBOTS:
            env = made(task, "state_dict", robot)
            nested = env.unwrapped.single_observation_space
            env.close()
            for mode, space in zip(STATE, (flat(nested), nested), strict=True):
                key = f"{task} {robot} {mode}"
                assert pinned["layouts"][key] == digest(layout(space)), f"{key} changed: raise OBSERVATION_VERSION"


@pytest.mark.render
@pytest.mark.parametrize("mode", IMAGES)
def test_the_pinned_layouts_of_images_are_those_of_this_version(mode: str) -> None:
    pinned = json.loads(PINNED.read_text())["layouts"]
    for task in ("HazardFire-v1", "HazardCompound-v1"):
        assert pinned[f"{task} fetch {mode}"] == pin(task, mode, "fetch"), "raise OBSERVATION_VERSION"


if __name__ == "__main__":  # python -m tests.env.test_spaces: writes the layouts of a new version
    keys = [(t, m, r) for t in TASKS for r in ROBOTS for m in STATE]
    keys += [(t, m, "fetch") for t in ("HazardFire-v1", "HazardCompound-v1") for m in IMAGES]
    found = {f"{t} {r} {m}": pin(t, m, r) for t, m, r in keys}
    PINNED.write_text(json.dumps({"version": OBSERVATION_VERSION, "layouts": found}, indent=1) + "\n")
