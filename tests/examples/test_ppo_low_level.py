"""The example of PPO on single motions: its sums are right, and it runs on a CPU and in the way of a GPU."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch
from safetensors.torch import load_file

from tests.worlds.registering import loaded, practising

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "ppo_low_level.py"


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module, practising():
        yield module


def test_advantages_are_those_worked_out_by_hand(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two actions of two robots, the first of which succeeds between them: nothing of what follows is its own."""
    monkeypatch.setattr(example, "TRACE", 0.5)
    rewards, values = torch.tensor([[1.0, 0.2], [0.0, 0.4]]), torch.tensor([[0.6, 0.5], [0.3, 0.8]])
    after = torch.tensor([[0.0, 0.8], [0.9, 0.1]])
    over = torch.tensor([[True, False], [False, False]])
    found = example.advantages(rewards, values, after, over, 0.5)
    # last ones: 0 + 0.45 - 0.3 and 0.4 + 0.05 - 0.8; first ones: 1 - 0.6, and 0.2 + 0.4 - 0.5 and a quarter of -0.35
    torch.testing.assert_close(found, torch.tensor([[0.4, 0.0125], [0.15, -0.35]]))


def test_an_episode_that_is_cut_short_counts_what_would_have_followed(example: Any) -> None:
    none = torch.zeros(1, 1)
    found = example.advantages(none, none, torch.full((1, 1), 2.0), torch.tensor([[True]]), 0.5)
    assert found.item() == 1.0


def test_what_is_read_is_scaled_by_all_that_was_seen(example: Any) -> None:
    policy, seen = example.Policy(3, 2), torch.randn(500, 3) * torch.tensor([1.0, 5.0, 0.1]) + 2.0
    for part in seen.split([100, 250, 150]):
        policy.note(part)
    torch.testing.assert_close(policy.mean, seen.mean(0), rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(policy.variance, seen.var(0, unbiased=False), rtol=1e-3, atol=1e-4)
    moved = example.Policy(3, 2)
    moved.load_state_dict({**policy.state_dict(), "mean": policy.mean + 1.0})
    torch.testing.assert_close(policy(seen)[1], moved(seen + 1.0)[1], atol=1e-4, rtol=1e-4)


def test_an_action_is_kept_for_as_many_frames_as_said(example: Any) -> None:
    env = example.practice("walk_to", "train", 1)
    assert isinstance(env, gym.Wrapper)
    env.reset(seed=0)
    start = env.unwrapped.agent.base_pose()[0].clone()
    action = torch.zeros(1, 13)
    action[:, 11] = 1.0
    *_, info = env.step(action)
    went = float((env.unwrapped.agent.base_pose()[0] - start).norm())
    assert int(info["elapsed_steps"]) == 5 and 4 / 62 < went < 5.1 / 62  # at 1/62 m a frame, once it moves
    assert float(env.unwrapped.agent.base_velocity().norm()) == pytest.approx(30 / 62, abs=0.01)
    env.close()


def test_robots_in_a_batch_learn_and_leave_a_curve_and_a_policy(
    example: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One robot in the batch, since this is a CPU; on a GPU there are more."""
    monkeypatch.setitem(example.SAMPLES, "pick_up", 48)
    torch.manual_seed(0)
    example.main(["--task", "pick_up", "--robots", "1", "--minutes", "0", "--episodes", "1", "--out", str(tmp_path)])
    lines = (tmp_path / "pick_up.csv").read_text().splitlines()
    assert lines[0].startswith("minutes,frames,success") and len(lines) == 2 and lines[1].split(",")[1] == "144"
    assert "success in rooms of test" in capsys.readouterr().out
    policy = example.Policy(47, 10)
    policy.load_state_dict(load_file(tmp_path / "pick_up.safetensors"))
    assert policy.count == 48 and not torch.equal(policy.variance, torch.ones(47))


@pytest.mark.long
@pytest.mark.timeout(900)
def test_it_runs_in_processes(tmp_path: Path) -> None:
    """As a program of its own: new processes import the main module again."""
    words = ["--task", "walk_to", "--minutes", "0.01", "--episodes", "1", "--out", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, str(EXAMPLE), *words], capture_output=True, text=True, timeout=800, cwd=ROOT, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "success in rooms of test" in done.stdout and (tmp_path / "walk_to.csv").read_text().count("\n") >= 2
