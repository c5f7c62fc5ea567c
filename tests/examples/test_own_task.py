"""A task with another goal, from outside the package, is played, filmed and rendered."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

from hazard_ms.cli.__main__ import main
from hazard_ms.spec.catalogue import CATEGORIES
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_task.py"
TASK = "HazardKeepDry-v1"
SHORT = "tests.examples.stopping:Stopping"


@pytest.fixture(scope="module", autouse=True)
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module
    assert TASK not in gym.registry


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make(TASK, obs_mode="state_dict", render_backend="none", reward_mode="sparse")
    yield made
    made.close()


def test_it_is_small() -> None:
    assert len(EXAMPLE.read_text().splitlines()) < 60


def test_the_targets_are_what_water_ruins(env: Any) -> None:
    env.reset(seed=0)
    base = env.unwrapped
    names = {list(CATEGORIES)[int(c)] for c in base.world.category[base.world.target]}
    assert names and all(CATEGORIES[n].value == 5 and not CATEGORIES[n].waterproof for n in names)
    assert env.spec.max_episode_steps == base.task.max_frames == 600


def test_the_goal_is_a_share_of_dry_targets_at_a_frame(env: Any) -> None:
    """Two targets wet at frame 600: success, and the dry share is the reward; all wet: it has failed, and ends."""
    env.reset(seed=0)
    base = env.unwrapped
    targets = torch.nonzero(base.world.target[0]).flatten()
    *_, info = env.step(None)
    assert float(info["dry"]) == 1.0 and not bool(info["success"]) and not bool(info["fail"])
    assert set(info) >= {"success", "fail", "dry", "sim_error"} and "rescued" not in info
    base.episode.damage.damaged[0, targets[:2]] = True
    share = 1.0 - 2 / len(targets)
    for frame, success in ((599, False), (600, True)):
        base.world.chance.frame[:] = frame
        info = base.get_info()
        assert bool(info["success"]) == success and float(info["dry"]) == pytest.approx(share)
        reward = float(base.compute_sparse_reward(None, None, info))
        assert reward == pytest.approx(share if success else 0.0)
    base.episode.damage.damaged[0, targets] = True
    _, reward, terminated, _, info = env.step(None)
    assert bool(info["fail"]) and not bool(info["success"]) and bool(terminated) and float(reward) == 0.0


def test_it_is_described(capsys: pytest.CaptureFixture[str]) -> None:
    """Its observations, its info and its rewards, though functions of its goal have no docstrings."""
    assert main(["describe", "--load", str(EXAMPLE), "-e", TASK, "--obs-mode", "state_dict"]) == 0
    out = capsys.readouterr().out
    assert "share of the targets that are dry" in out and "sparse" in out


@pytest.mark.render
def test_it_is_played_and_filmed(tmp_path: Path) -> None:
    film = tmp_path / "dry.mp4"
    words = ["play", "--load", str(EXAMPLE), "-e", TASK, "--agent", SHORT, "--output", str(film), "--every", "10"]
    assert main(words) == 0
    assert json.loads(film.with_suffix(".json").read_text())["env_id"] == TASK and film.stat().st_size > 10_000


@pytest.mark.render
def test_it_is_rendered(tmp_path: Path) -> None:
    picture = tmp_path / "dry.png"
    words = ["render", "--load", str(EXAMPLE), "-e", TASK, "--frame", "30", "--size", "96", "-o", str(picture)]
    assert main(words) == 0
    assert picture.stat().st_size > 3000
