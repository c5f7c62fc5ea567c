"""Exports for ManiSkill: h5py and ManiSkill's own reader and tools find in them what was recorded."""

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
from mani_skill.trajectory.dataset import ManiSkillTrajectoryDataset

from hazard_ms.demonstrations.export import maniskill
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import dataset, driven, enter, frames_of, subtasks_of

ROOT = Path(__file__).parents[3]
FRAMES = 6


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dataset(tmp_path_factory.mktemp("recorded"), obs="state")


@pytest.fixture(scope="module")
def written(recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    return exported(recorded, tmp_path_factory.mktemp("written"))


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return driven(tmp_path_factory.mktemp("real"), FRAMES)


def exported(folder: Path, output: Path, **wanted: Any) -> tuple[Path, dict[str, Any]]:
    path = output / maniskill.write(Source(folder, **wanted), output)
    return path, json.loads(path.with_suffix(".json").read_text())


def test_arrays_and_descriptions_of_all_episodes(written: tuple[Path, dict[str, Any]]) -> None:
    path, about = written
    assert path.name == "trajectory.state.pd_joint_pos.physx_cpu.h5"
    info = about["env_info"]
    assert (info["env_id"], info["max_episode_steps"]) == ("hazard_ms:HazardFire-v1", 1500)
    assert info["env_kwargs"]["control_mode"] == "pd_joint_pos" and info["env_kwargs"]["split"] == "train"
    assert about["source_type"] == "motionplanning" and "shoulder_pan_joint [rad]" in about["source_desc"]
    with h5py.File(path) as file:
        assert list(file) == ["traj_0", "traj_1"]
        for number, frames in enumerate((5, 8)):
            expected, group = frames_of(number, frames, True), file[f"traj_{number}"]
            assert set(group) == {"obs", "actions", "rewards", "terminated", "truncated", "success", "subtask"}
            for ours, theirs in (("obs", "obs"), ("action", "actions"), ("reward", "rewards")):
                np.testing.assert_array_equal(group[theirs], expected[ours])
                assert group[theirs].dtype == np.float32
            assert group["success"][:].tolist() == group["terminated"][:].tolist() == [False] * (frames - 1) + [True]
            episode = about["episodes"][number]
            assert (episode["episode_id"], episode["elapsed_steps"], episode["success"]) == (number, frames, True)
            assert episode["reset_kwargs"] == {"options": {"scene": "kitchen_b/00"}, "seed": 10 + number}
            assert episode["info"]["subtasks"] == subtasks_of(number)
            assert group["subtask"][:].tolist() == expected["subtask"].tolist()


def test_the_reader_of_maniskill_gives_what_was_recorded(written: tuple[Path, dict[str, Any]]) -> None:
    read = ManiSkillTrajectoryDataset(str(written[0]))
    assert len(read) == 5 + 8
    for index, (number, frames, frame) in ((2, (0, 5, 2)), (5 + 7, (1, 8, 7))):
        expected = frames_of(number, frames, True)
        np.testing.assert_array_equal(read[index]["action"], expected["action"][frame])
        np.testing.assert_array_equal(read[index]["obs"], expected["obs"][frame])
        assert float(read[index]["reward"]) == frame + 1


def test_privileged_arrays_are_left_out_unless_asked_for(recorded: Path, tmp_path: Path) -> None:
    path, _ = exported(recorded, tmp_path, privileged=True)
    with h5py.File(path) as file:
        assert file["traj_1/privileged/option_value"][0, 1] == 0.5


def test_states_and_observations_of_every_frame_by_simulating_again(real: Path, tmp_path: Path) -> None:
    path, about = exported(real, tmp_path, obs="state", states=True)
    episode = about["episodes"][0]
    env = gym.make(about["env_info"]["env_id"], render_backend="none", **about["env_info"]["env_kwargs"])
    base: Any = env.unwrapped
    with h5py.File(path) as file:
        group = file["traj_0"]
        obs, _ = env.reset(**episode["reset_kwargs"])
        for frame in range(FRAMES + 1):
            if frame:
                obs = env.step(group["actions"][frame - 1])[0]
            np.testing.assert_array_equal(group["obs"][frame], obs[0])
            state, kept = base.get_state_dict(), group["env_states"]
            joints, heat = state["articulations"]["hazard_fetch"][0], state["hazard_ms"]["fire"]["temperature"][0]
            np.testing.assert_array_equal(kept["articulations/hazard_fetch"][frame], joints)
            np.testing.assert_array_equal(kept["hazard_ms/fire/temperature"][frame], heat)
            assert set(kept["actors"]) == set(state["actors"])
            assert kept["hazard_ms/chance/frame"][frame, 0] == frame
    env.close()


@pytest.mark.parametrize(("name", "row", "frame"), [("qpos", 3, 3), ("state", 0, FRAMES)])
def test_an_episode_that_comes_out_differently_is_refused(
    real: Path, tmp_path: Path, name: str, row: int, frame: int
) -> None:
    (before,) = (path for path in real.iterdir() if path.is_dir())
    made = tmp_path / before.name
    made.mkdir()
    for path in before.glob("*.*"):
        (made / path.name).write_bytes(path.read_bytes())
    arrays = dict(np.load(made / "frames.npz"))
    arrays[name][row, -1] += 1.0
    np.savez_compressed(made / "frames.npz", **arrays)
    enter(tmp_path, made.name)
    with pytest.raises(ValueError, match=f"got another state in frame {frame};"):
        exported(tmp_path, tmp_path, states=True)


@pytest.mark.long
@pytest.mark.parametrize("how", [["--use-env-states"], []], ids=["by states", "by actions"])
def test_the_tool_of_maniskill_replays_it(real: Path, tmp_path: Path, how: list[str]) -> None:
    path, _ = exported(real, tmp_path, states=True)
    again = tmp_path / "again.h5"
    for suffix in (".h5", ".json"):
        again.with_suffix(suffix).write_bytes(path.with_suffix(suffix).read_bytes())
    tool = ["-m", "hazard_ms.cli.maniskill", "replay_trajectory", "--traj-path", str(again)]
    wanted = ["--save-traj", "--allow-failure", "--obs-mode", "state", *how]
    out = subprocess.run([sys.executable, *tool, *wanted], capture_output=True, text=True, cwd=ROOT, check=False)
    assert "Replayed 1 episodes, 1/1" in out.stdout, out.stderr[-2000:]
    (replayed,) = tmp_path.glob("again.state.*.h5")
    with h5py.File(replayed) as new, h5py.File(path) as old:
        name = "traj_0/env_states/articulations/hazard_fetch"
        assert new[name].shape == old[name].shape
        if not how:
            np.testing.assert_array_equal(new[name], old[name])
