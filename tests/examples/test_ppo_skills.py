"""The example of reinforcement learning in one file: its sums are right, and it runs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch

from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "ppo_skills.py"


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


def test_advantages_are_those_worked_out_by_hand(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two decisions of two rescues, the first of which ends between them; half of what comes later is believed."""
    monkeypatch.setattr(example, "TRACE", 0.5)
    rewards, values = torch.tensor([[1.0, 0.2], [0.0, 0.4]]), torch.tensor([[0.6, 0.5], [0.3, 0.8]])
    over, last = torch.tensor([[True, False], [False, False]]), torch.tensor([0.9, 0.1])
    found = example.advantages(rewards, values, over, last)
    # last ones: 0 + 0.9 - 0.3 and 0.4 + 0.1 - 0.8; first ones: 1 - 0.6 and 0.2 + 0.8 - 0.5, and half of -0.3
    torch.testing.assert_close(found, torch.tensor([[0.4, 0.35], [0.6, -0.3]]))


def test_what_is_forbidden_has_no_chance(example: Any) -> None:
    mask = torch.tensor([[True, False, True]])
    chances, worth = example.Network(4, 3)(torch.ones(1, 4), mask)
    assert chances.probs[0, 1].item() == 0.0 and worth.shape == (1,)


@pytest.mark.long
def test_it_runs_and_says_how_it_gets_on(example: Any, capsys: pytest.CaptureFixture[str]) -> None:
    means = example.main(["--scenes", "2", "--decisions", "12288"])
    lines = capsys.readouterr().out.splitlines()
    assert len(means) == len(lines) == 3 and "12,288 decisions" in lines[-1] and means[-1] > 0.1
