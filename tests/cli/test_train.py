"""The commands `hazard-ms train ...`, on one scene each."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.learned.weights import load, load_map
from hazard_ms.cli import train
from hazard_ms.cli.__main__ import main
from hazard_ms.skills.options.choices import ACTIONS
from tests.worlds.policies import stored_map

FIRE = "HazardFire-v1"


@pytest.fixture(autouse=True)
def _few_scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(train, "VALIDATION_SCENES", 1)


@pytest.mark.long
def test_a_policy_is_trained_stored_and_scored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    few = ["--scenes", "1", "--rounds", "1", "--episodes", "4"]
    assert main(["train", "bc", "-e", FIRE, "-o", str(tmp_path / "made"), *few]) == 0
    out = capsys.readouterr().out
    path = tmp_path / "made" / f"bc_{FIRE}.safetensors"
    assert "round 0: " in out and str(path) in out
    told = json.loads(path.with_suffix(".json").read_text())
    assert told["command"].endswith("--seed 0 --scenes 1 --rounds 1 --episodes 4 --physics paper")
    assert len(told["rounds"]) == 1 and load(path, FIRE).shape.ranges == ((20.0, 600.0),)
    assert main(["train", "score", str(path), "-e", FIRE]) == 0
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.endswith(str(path)))
    assert line.split()[0] == f"{told['rounds'][0]['student']:.3f}"


@pytest.mark.long
def test_a_policy_is_trained_by_reinforcement_and_resumed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = ["train", "ppo", "-e", FIRE, "-o", str(tmp_path), "--scenes", "1"]
    assert main([*plain, "--decisions", "4096"]) == 0
    first = (tmp_path / f"rl_{FIRE}.csv").read_text().splitlines()
    assert first[0].startswith("decisions,seconds,training,validation,greedy") and first[-1].startswith("4096,")
    told = json.loads((tmp_path / f"rl_{FIRE}.json").read_text())
    assert told["command"].endswith("--seed 0 --scenes 1 --reward value --physics paper")
    capsys.readouterr()
    assert main([*plain, "--decisions", "8192"]) == 0
    assert "resumes after 4,096 decisions" in capsys.readouterr().out
    after = (tmp_path / f"rl_{FIRE}.csv").read_text().splitlines()
    assert after[: len(first)] == first and after[-1].startswith("8192,")
    path = tmp_path / f"rl_{FIRE}.safetensors"
    assert load(path, FIRE).shape.ranges == ((20.0, 600.0),)
    assert main(["train", "score", str(path), "-e", FIRE]) == 0
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.endswith(str(path)))
    assert line.split()[0] == f"{float(after[-1].split(',')[-1]):.3f}"
    assert main([*plain, "--decisions", "8192", "--seed", "1"]) == 2
    assert "give another folder" in capsys.readouterr().err


@pytest.mark.long
def test_the_six_actions_are_trained_resumed_and_scored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = ["train", "ppo", "-e", FIRE, "-o", str(tmp_path), "--scenes", "1", "--actions", "paper", "--share", "0.125"]
    assert main([*plain, "--decisions", "512"]) == 0
    path = tmp_path / f"rl_paper_{FIRE}.safetensors"
    told = json.loads(path.with_suffix(".json").read_text())
    assert told["command"].endswith("--reward paper --physics paper --actions paper --share 0.125")
    assert load_map(path, FIRE).shape.share == 0.125
    assert main([*plain, "--decisions", "1024"]) == 0
    assert "resumes after 512 decisions" in capsys.readouterr().out
    assert main([*plain, "--decisions", "1024"]) == 0
    assert capsys.readouterr().out == f"{path} has already trained for that long, or no longer improves\n"
    assert main(["train", "score", str(path), "-e", FIRE]) == 0
    out = capsys.readouterr().out
    assert str(path) in out and "random six actions" in out and "greedy, over options" in out


def test_actions_are_those_of_environments() -> None:
    assert train.ACTIONS == ACTIONS


def test_what_cannot_be_trained_or_scored_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, most in (("scenes", 975), ("rounds", 1000), ("episodes", 10**7)):
        assert main(["train", "bc", "-e", FIRE, "-o", str(tmp_path), f"--{name}", "0"]) == 2
        assert f"{name} must be a whole number from 1 to {most}" in capsys.readouterr().err
    given = str(stored_map(tmp_path / "given.safetensors"))
    ppo = ["train", "ppo", "-e", FIRE, "-o", str(tmp_path)]
    for wrong, said in (
        (["--decisions", "0"], "decisions must be a whole number"),
        (["--reward", "gold"], "reward must be one of value, paper"),
        (["--actions", "papr"], "did you mean 'paper'"),
        (["--masked"], "masked must be left out with --actions options"),
        (["--share", "0.25"], "share must be left out with --actions options, whose network has one width, got 0.25"),
        (["--minutes", "nan"], "minutes must be positive, got nan"),
        (["--actions", "paper", "--start", given, "--masked"], "share and masked must be those of the --start policy"),
        (
            ["--actions", "paper", "--start", given, "--share", "1"],
            "share and masked must be those of the --start policy",
        ),
        (["--actions", "paper", "--share", "2"], "share of a policy must be from 1/32 to 1"),
        (["--start", str(tmp_path / "none.safetensors")], "none.safetensors must hold a policy"),
    ):
        assert main([*ppo, *wrong]) == 2
        assert said in capsys.readouterr().err
    assert main(["train", "score", str(tmp_path / "none.safetensors"), "-e", FIRE]) == 2
    assert "none.safetensors must hold a policy for HazardFire-v1" in capsys.readouterr().err
