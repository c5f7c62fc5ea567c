"""What LeRobot asks of an environment, and what demonstrations promise a policy that was trained on them."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

pytest.importorskip("pyarrow", reason="pyarrow is not installed; the extra demos brings it")
pytest.importorskip("av", reason="av is not installed; the extra demos brings it")

import av
import pyarrow.parquet as pq

from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.demonstrations.export import lerobot
from hazard_ms.demonstrations.export.source import Source
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.hazards.presets import FREQUENCIES
from hazard_ms.lerobot import ENV_ID
from hazard_ms.lerobot.environment import RobotEnv
from hazard_ms.lerobot.hub import make_env
from hazard_ms.lerobot.sizes import ACTIONS, FRAMES, STATES, frames_of
from hazard_ms.skills.actions import wait
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import STOP, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.motor.motion import turn_by
from tests.worlds.registering import practising

pytestmark = pytest.mark.render
EPISODE = EpisodeOptions(agent="tests.lerobot.test_environment:Turns", seed=11, scene="kitchen_a/03")
EXAMPLE = Path(__file__).parents[2] / "examples" / "lerobot" / "env.py"
CAMERAS = ("head", "wrist", "shoulder")
MOST_OFF = 6.0  # of a film's colours, which are compressed, in the mean [levels]
FEWEST = 8  # frames of the recording


class Turns(PrivilegedAgent):
    """Waits, turns by half a radian, and stops: a short episode, since each of its frames is drawn six times."""

    def attach(self, env: SkillEnv) -> None:
        self.env = env

    def reset(self, brief: Brief) -> None:
        return

    def act(self, decision: Decision) -> Action:
        self.env.run(wait(self.env.stage, 3))
        self.env.run(turn_by(self.env.stage, 0.5))
        return Action(STOP)


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short recording with pictures of every frame, as a LeRobot dataset."""
    output = tmp_path_factory.mktemp("demos")
    options = RecordOptions(
        agent=EPISODE.agent, keep=0.0, verify=False, every=1, obs="rgb", cameras="+".join(CAMERAS), output=output
    )
    options.dataset.mkdir(parents=True)
    outcome = attempt(RecordJob(EPISODE, 60.0, record=options), lambda word: None)
    assert not outcome.error
    folder = tmp_path_factory.mktemp("export") / "set"
    lerobot.write(Source(options.dataset), folder)
    return folder


@pytest.fixture(scope="module")
def env() -> Iterator[RobotEnv]:
    made = gym.make(ENV_ID, task="HazardFire-v1", side=64, every=3, max_frames=7)
    assert isinstance(made, RobotEnv)  # no wrapper: LeRobot looks for the task's sentence on what gym.make returns
    yield made
    made.close()


def test_the_actions_of_a_dataset_give_its_states_and_pictures_again(exported: Path) -> None:
    rows = pq.read_table(exported / "data").to_pydict()
    (episode,) = pq.read_table(exported / "meta/episodes").to_pylist()
    films = {}
    for camera in CAMERAS:
        with av.open(str(next((exported / "videos" / f"observation.images.{camera}").rglob("*.mp4")))) as film:
            films[camera] = [picture.to_ndarray(format="rgb24").astype(float) for picture in film.decode(video=0)]
    env = gym.make(ENV_ID, task=episode["env_id"], cameras=CAMERAS[1:], **json.loads(episode["settings"]))
    seen, _ = env.reset(seed=episode["seed"], options={"scene": episode["scene"], "lerobot_new_rollout": True})
    moved, apart = np.zeros_like(seen["agent_pos"]), list[float]()
    assert [len(shown) for shown in films.values()] == [len(rows["action"])] * 3 and len(rows["action"]) >= FEWEST
    for number, (state, action) in enumerate(zip(rows["observation.state"], rows["action"], strict=True)):
        np.testing.assert_array_equal(seen["agent_pos"], np.array(state, np.float32))
        assert set(seen["pixels"]) == set(CAMERAS)
        for camera, shown in films.items():
            assert np.abs(seen["pixels"][camera] - shown[number]).mean() < MOST_OFF, camera
            apart.append(np.abs(seen["pixels"][camera] - films["head"][number]).mean())
        before = seen["agent_pos"]
        seen, reward, terminated, truncated, info = env.step(np.array(action, np.float32))
        moved = np.maximum(moved, np.abs(seen["agent_pos"] - before))
        assert not terminated and not truncated and info["is_success"] is False
    assert moved.max() > 0.01  # it did something
    assert min(apart[1::3] + apart[2::3]) > 2.0 * MOST_OFF  # cameras see other things than that of the head
    assert 19.0 < min(rows["hazard"]) <= max(rows["hazard"]) < 2000.0  # a label [C], not what policies see
    assert json.loads((exported / "meta/info.json").read_text())["features"]["hazard"]["names"] == ["fire.temperature"]
    words = pq.read_table(exported / "meta/tasks.parquet").to_pydict()
    assert env.get_wrapper_attr("task_description") in [text for column in words.values() for text in column]
    env.close()


def test_what_lerobot_asks_of_an_environment(env: RobotEnv) -> None:
    assert env.task == env.task_description == env.unwrapped.task_description != ""
    assert env._max_episode_steps == 3  # 7 frames, three a step
    assert env.metadata["render_fps"] == 10
    seen, info = env.reset(seed=3, options={"lerobot_new_rollout": True})
    assert info["is_success"] is False and info["value"] == 0.0
    assert seen["pixels"]["head"].shape == (64, 64, 3) and seen["pixels"]["head"].dtype == np.uint8
    assert seen["pixels"]["head"].std() > 10.0 and seen["agent_pos"].shape == (STATES["fetch"],)
    frames, ended = [], []
    for _ in range(3):
        seen, reward, terminated, truncated, info = env.step(np.zeros(env.action_space.shape, np.float32))
        assert isinstance(reward, float) and not terminated and info["is_success"] is False
        frames.append(info["frames"])
        ended.append(truncated)
    assert frames == [3, 3, 1] and ended == [False, False, True]
    picture = env.render()
    assert picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3 and picture.std() > 10.0


def test_gymnasiums_own_checks(env: RobotEnv) -> None:
    check_env(env, skip_render_check=True)


def test_a_step_of_many_frames_adds_up_their_rewards(env: RobotEnv) -> None:
    action = env.action_space.sample() * 0.2
    env.reset(seed=3)
    _, together, *_ = env.step(action)
    one = gym.make(ENV_ID, task="HazardFire-v1", side=64, max_frames=7)
    one.reset(seed=3)
    assert together == pytest.approx(sum(float(one.step(action)[1]) for _ in range(3)), abs=1e-9)
    one.close()


def test_vectors_begin_anew_in_the_step_that_ends_an_episode() -> None:
    """LeRobot reads `final_info`, and would take every success for a failure otherwise."""
    made = make_env(n_envs=2, task="HazardFire-v1", side=64, max_frames=2)
    assert list(made) == ["hazard"] and list(made["hazard"]) == [0]
    vector: Any = made["hazard"][0]
    vector.reset(seed=[5, 6])
    assert vector.call("_max_episode_steps") == (2, 2)
    assert all(hasattr(each, "task_description") and hasattr(each, "task") for each in vector.envs)
    action = np.zeros((2, ACTIONS["fetch"]), np.float32)
    vector.step(action)
    seen, _, _, truncated, info = vector.step(action)
    assert truncated.all() and info["final_info"]["is_success"].tolist() == [False, False]
    assert seen["pixels"]["head"].shape == (2, 64, 64, 3)
    _, _, _, truncated, info = vector.step(action)
    assert not truncated.any() and "final_info" not in info
    vector.close()


@pytest.mark.long
def test_vectors_of_processes() -> None:
    made = make_env(n_envs=2, use_async_envs=True, task="HazardFire-v1", side=64, max_frames=2)["hazard"][0]
    seen, _ = made.reset(seed=[5, 6])
    alone = gym.make(ENV_ID, task="HazardFire-v1", side=64, max_frames=2)
    for number in (0, 1):
        np.testing.assert_array_equal(alone.reset(seed=5 + number)[0]["agent_pos"], seen["agent_pos"][number])
    alone.close()
    made.close()


def test_the_example_for_the_hub_is_what_lerobot_loads() -> None:
    spec = importlib.util.spec_from_file_location("env", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.make_env is make_env


@pytest.mark.parametrize("robot", sorted(STATES))
def test_the_sizes_that_are_told_before_there_is_an_environment(robot: str) -> None:
    env = gym.make(ENV_ID, task="HazardFire-v1", robot_uids=robot, side=64)
    assert env.observation_space["agent_pos"].shape == (STATES[robot],)  # type: ignore[index]
    assert env.action_space.shape == (ACTIONS[robot],)
    env.close()


def test_tasks_of_practice_and_of_others_have_their_module_before_them() -> None:
    with practising():
        env = gym.make(ENV_ID, task="hazard_ms.tasks.practice:HazardPickUp-v1", side=64, split="train")
        _, info = env.reset(seed=1)
        assert info == {"is_success": False}
        assert env.get_wrapper_attr("task_description") == "Take the thing before you into your hand."
        env.close()


def test_the_frames_of_a_second() -> None:
    assert FRAMES == {name: frames for name, (frames, _) in FREQUENCIES.items()}
    assert frames_of(10, "paper") == 3 and frames_of(20, "shipped") == 5
    for fps in (0, 7, 31, -30, 10.0):
        with pytest.raises(ValueError, match="fps must be a divisor of 30"):
            frames_of(fps, "paper")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"task": "HazardFier-v1"}, "HazardFire"),
        ({"every": 0}, "every must be"),
        ({"side": 4}, "side must be"),
        ({"obs_mode": "state"}, "obs_mode must not be given"),
        ({"num_envs": 2}, "num_envs must not be given"),
        ({"render_mode": "ansi"}, "render_mode must be"),
        ({"render_backend": "none", "render_mode": None}, "render_backend must be a renderer"),
        ({"max_frames": 0}, "max_frames must be"),
        ({"robot_uids": "spot"}, "robot_uids must be"),
    ],
)
def test_what_cannot_be_is_refused(keywords: dict[str, Any], message: str) -> None:
    with pytest.raises((ValueError, gym.error.Error), match=message):
        gym.make(ENV_ID, **keywords)
