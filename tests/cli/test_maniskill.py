"""ManiSkill's own tools on our environments: recording, replaying, wrappers; and our robots in its own scenes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import h5py
import numpy as np
import pytest
import torch
from mani_skill.utils.wrappers.record import RecordEpisode

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.cli.maniskill import full_name
from tests.worlds.episodes import actions

ROOT = Path(__file__).parents[2]
FRAMES = 4


def module(*arguments: str) -> str:
    """Standard output of `python -m` with these arguments."""
    out = subprocess.run(
        [sys.executable, "-m", *arguments], capture_output=True, text=True, timeout=400, cwd=ROOT, check=False
    )
    assert out.returncode == 0, out.stderr[-3000:]
    return out.stdout


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A trajectory of FRAMES frames."""
    folder = tmp_path_factory.mktemp("recording")
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", control_mode="pd_joint_pos")
    env = RecordEpisode(made, str(folder), save_video=False, trajectory_name="trajectory")
    env.reset(seed=4)
    for action in actions(env, 4, FRAMES):
        env.step(action)
    env.close()
    return folder / "trajectory.h5"


def names_of(group: Any) -> set[str]:
    found: set[str] = set()
    group.visit(found.add)
    return found


def test_recorded_actors_are_one_dataset_each(recording: Path) -> None:
    with h5py.File(recording) as file:
        actors = file["traj_0/env_states/actors"]
        assert actors and all(isinstance(entry, h5py.Dataset) for entry in actors.values()), names_of(actors)
        assert all(name.startswith("env-0_") for name in actors)


@pytest.mark.long
def test_recorded_id_imports_the_package_by_itself(recording: Path) -> None:
    info = json.loads(recording.with_suffix(".json").read_text())["env_info"]
    assert info["env_id"] == "hazard_ms:HazardFire-v1" and info["max_episode_steps"] == 1500
    code = (
        f"import gymnasium as gym; env = gym.make({info['env_id']!r}, **{info['env_kwargs']!r});"
        "print(env.spec.id, env.spec.max_episode_steps); print(gym.make(env.spec).unwrapped.task.name)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert out.stdout.splitlines() == ["hazard_ms:HazardFire-v1 1500", "HazardFire-v1"], out.stderr[-2000:]


def test_replay_by_states_gives_the_recorded_states(recording: Path, tmp_path: Path) -> None:
    copied = tmp_path / "copied.h5"
    for suffix in (".h5", ".json"):
        copied.with_suffix(suffix).write_bytes(recording.with_suffix(suffix).read_bytes())
    options = ("--traj-path", str(copied), "--use-env-states", "--save-traj", "--allow-failure", "--obs-mode", "state")
    shown = module("hazard_ms.cli.maniskill", "replay_trajectory", *options)
    assert "Replayed 1 episodes, 1/1" in shown
    (replayed,) = tmp_path.glob("copied.state.*.h5")
    with h5py.File(replayed) as new, h5py.File(recording) as old:
        states, recorded = new["traj_0/env_states"], old["traj_0/env_states"]
        for name in names_of(recorded):
            if isinstance(recorded[name], h5py.Dataset):
                assert states[name].shape == recorded[name].shape, name
        for name, body in recorded["actors"].items():  # from each recorded state, ManiSkill replays one frame
            np.testing.assert_allclose(states["actors"][name][1:, :7], body[1:, :7], atol=1e-3, err_msg=name)
        assert states["hazard_ms/chance/frame"][1:, 0].tolist() == list(range(1, FRAMES + 1))


def test_short_names_stand_for_modules_of_maniskill() -> None:
    assert full_name("replay_trajectory") == "mani_skill.trajectory.replay_trajectory"
    assert full_name("demo_robot") == "mani_skill.examples.demo_robot"
    assert full_name("mani_skill.examples.demo_robot") == "mani_skill.examples.demo_robot"
    for wrong, allowed in (("replay_trajektory", "did you mean 'replay_trajectory'"), ("os.path", "MODULE must be")):
        with pytest.raises(ValueError, match=allowed):
            full_name(wrong)


@pytest.mark.long
@pytest.mark.parametrize("robot", ["hazard_fetch", "hazard_g1"])
def test_our_robots_stand_in_scenes_of_maniskill(robot: str) -> None:
    """In a process of its own, in which nothing but `import hazard_ms` makes them known."""
    code = (
        "import gymnasium as gym, hazard_ms, mani_skill.envs\n"
        "from mani_skill.utils.registration import REGISTERED_ENVS\n"
        f"env = gym.make('Empty-v1', robot_uids={robot!r}, obs_mode='state', render_backend='none')\n"
        "env.reset(seed=0); env.step(env.action_space.sample())\n"
        "print(env.unwrapped.agent.uid, 'HazardWind-v1' in REGISTERED_ENVS)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert out.stdout.split() == [robot, "True"], out.stderr[-2000:]


def test_wrappers_of_maniskill() -> None:
    from mani_skill.utils.wrappers import FrameStack

    env = gym.make("HazardFire-v1", obs_mode="state", render_backend="none")
    single = env.observation_space.shape
    stacked = FrameStack(env, num_stack=3)
    obs, _ = stacked.reset(seed=0)
    assert tuple(obs.shape) == (*single[:1], 3, *single[1:])
    assert stacked.step(stacked.action_space.sample())[0].shape == obs.shape
    env.close()


def test_cached_resets_begin_at_one_of_the_cached_states() -> None:
    """What is seen is what that state shows, its hazards, and frame 1 comes after one step."""
    from mani_skill.utils.wrappers.cached_reset import CachedResetsConfig, CachedResetWrapper

    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", deterministic=False, scene_every=0)
    env = CachedResetWrapper(made, config=CachedResetsConfig(num_resets=2, seed=5))
    cached = [env._cached_resets_obs_buffer[k : k + 1] for k in range(2)]
    states = env._cached_resets_env_states["hazard_ms"]
    seeds = states["chance"]["seed"].tolist()
    assert seeds[0] != seeds[1]
    for _ in range(3):
        obs, _ = env.reset()
        now = made.unwrapped.get_state_dict()["hazard_ms"]  # type: ignore[attr-defined]
        number = seeds.index(now["chance"]["seed"][0].tolist())
        assert torch.equal(obs, cached[number])
        assert torch.equal(made.unwrapped.get_obs(made.unwrapped.get_info()), obs)  # type: ignore[attr-defined]
        for name, numbers in now["fire"].items():
            assert torch.equal(numbers[0], states["fire"][name][number]), name
        env.step(env.action_space.sample())
        assert made.unwrapped.world.frame.tolist() == [1]  # type: ignore[attr-defined]
    env.close()


@pytest.mark.render
def test_pictures_of_all_cameras_in_one_tensor() -> None:
    from mani_skill.utils.wrappers import FlattenRGBDObservationWrapper

    camera = {"width": 32, "height": 32}
    made = gym.make("HazardFire-v1", obs_mode="rgb+depth", sensor_configs=camera, effects="off")
    env = FlattenRGBDObservationWrapper(made)
    obs, _ = env.reset(seed=0)
    assert obs["rgb"].shape == (1, 32, 32, 3) and obs["depth"].shape == (1, 32, 32, 1) and obs["state"].ndim == 2
    env.close()
