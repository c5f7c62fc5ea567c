"""The example that trains on an export with ManiSkill's own reader: it reads all frames, learns, and plays."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch

from hazard_ms.demonstrations.export import maniskill
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import driven
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_on_export.py"
FRAMES = 6


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    return folder / maniskill.write(Source(driven(folder / "real", FRAMES), obs="state"), folder)


def test_it_learns_from_an_export_and_plays(example: Any, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ((obs, action), *rest), about = example.load(file)
    assert not rest and len(obs) == len(action) == FRAMES
    policy = example.train([(obs, action)] * 2, 40)
    first, *_, last = (float(line.split()[3]) for line in capsys.readouterr().out.splitlines())
    assert last < 0.5 * first
    assert math.isfinite(example.play(policy, about, 2))
    with pytest.raises(SystemExit):
        example.main([str(file)])
    assert "at least 2 episodes, got 1" in capsys.readouterr().err


def test_a_policy_gives_usual_actions_where_it_knows_nothing(example: Any) -> None:
    obs, action = torch.tensor([[0.0, 5.0], [2.0, 5.0]]), torch.tensor([[1.0], [3.0]])
    policy = example.Policy(obs, action)
    with torch.no_grad():
        for layer in policy.net:
            for weights in layer.parameters():
                weights.zero_()
        assert policy(torch.tensor([[7.0, 5.0]])).tolist() == [[2.0]]
