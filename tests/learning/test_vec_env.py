"""The sketch as a vector environment of Stable-Baselines3: what its learners ask for is there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.utils import get_action_masks, is_masking_supported
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

from hazard_ms.agents.learned.set_policy import worthwhile
from hazard_ms.learning.vec_env import SketchVecEnv
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.skills.options.options import COUNT, END, FIRST, LOOK
from tests.worlds.sketch_scenes import chancy_times, random_scene

ROOT = Path(__file__).parents[2]
SPAWNED = """
import gymnasium as gym
def make():
    return gym.make("hazard_ms:HazardFireSkills-v1", backend="sketch", scenes=["kitchen_a/00"])
if __name__ == "__main__":
    from sb3_contrib import MaskablePPO
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import SubprocVecEnv
    for learner in (PPO, MaskablePPO):
        envs = SubprocVecEnv([make, make], start_method="spawn")
        model = learner("MlpPolicy", envs, n_steps=16, batch_size=32, device="cpu")
        print(model.learn(64).num_timesteps)
        envs.close()
"""


def envs(count: int = 6) -> SketchVecEnv:
    return SketchVecEnv(SketchBatch([random_scene(s) for s in range(4)], [(20.0, 600.0)], chancy_times(), count))


def test_ends_tell_what_was_seen_last_and_what_the_episode_was_worth() -> None:
    made, chance, sums, ends = envs(), np.random.default_rng(0), np.zeros(6), 0
    made.seed(1)
    assert made.reset().shape == (6, *made.observation_space.shape)  # type: ignore[misc]
    for _ in range(60):
        mask = np.array(made.action_masks())
        obs, rewards, done, infos = made.step((chance.random(mask.shape) * mask).argmax(axis=1))
        sums += rewards
        assert rewards.dtype == np.float32 and len({id(info) for info in infos}) == 6
        for n in range(6):
            assert bool(done[n]) == ("terminal_observation" in infos[n])
            assert "TimeLimit.truncated" not in infos[n]  # the score is settled at the end of time
            if done[n]:
                ends += 1
                assert infos[n]["episode"]["r"] == pytest.approx(sums[n], abs=1e-5)
                assert infos[n]["value"] == pytest.approx(sums[n], abs=1e-5)
                sums[n] = 0.0
    assert ends > 6


def test_stopping_is_offered_only_where_there_is_nothing_to_go_to() -> None:
    made, chance, seen = envs(64), np.random.default_rng(0), set()
    made.reset()
    for _ in range(40):
        mask = get_action_masks(made)
        assert mask.shape == (64, COUNT) and mask.any(axis=1).all()
        np.testing.assert_array_equal(mask, worthwhile(made.batch.action_masks()))
        assert (mask[:, FIRST[END]] == ~mask[:, : FIRST[LOOK]].any(axis=1)).all()
        seen |= set(mask[:, FIRST[END]].tolist())
        made.step((chance.random(mask.shape) * mask).argmax(axis=1))
    assert seen == {True, False}


def test_attributes_are_those_of_rescues() -> None:
    made = envs()
    assert is_masking_supported(made) and not made.has_attr("wealth") and made.env_is_wrapped(VecMonitor) == [False] * 6
    assert made.get_attr("render_mode", [1, 2]) == [None, None] and len(made.env_method("action_masks", indices=3)) == 1
    for wrong in (lambda: made.get_attr("wealth"), lambda: made.env_method("fly"), lambda: made.set_attr("wealth", 1)):
        with pytest.raises(AttributeError):
            wrong()


@pytest.mark.long
@pytest.mark.parametrize("learner", [PPO, MaskablePPO])
def test_learners_of_stable_baselines_run_unchanged(learner: type[PPO] | type[MaskablePPO]) -> None:
    model = learner("MlpPolicy", VecMonitor(envs()), n_steps=16, batch_size=48, device="cpu")
    model.learn(192)
    assert model.num_timesteps == 192 and model.ep_info_buffer


@pytest.mark.long
@pytest.mark.timeout(900)
def test_learners_of_stable_baselines_run_on_single_rescues_in_processes(tmp_path: Path) -> None:
    """In a script of its own: spawned processes import the main module again."""
    (tmp_path / "spawned.py").write_text(SPAWNED)
    command = [sys.executable, str(tmp_path / "spawned.py")]
    out = subprocess.run(command, capture_output=True, text=True, timeout=800, cwd=ROOT)
    assert out.returncode == 0, out.stderr[-2000:]
    assert out.stdout.split() == ["64", "64"]
