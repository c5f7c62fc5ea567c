"""`hazard-ms describe`, and the page docs/observations.md that it makes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.skills.options.interface_page import page
from hazard_ms.spec.registry import ROBOTS, TASKS
from tests.worlds.registering import loaded

PAGE = Path(__file__).parents[2] / "docs" / "observations.md"


def test_flat_states_are_told_by_index(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["describe", "-e", "HazardFire-v1", "--obs-mode", "state"]) == 0
    said = capsys.readouterr().out
    assert "state[0:15] agent/qpos" in said and "32  heading [rad] -6.2832 to 6.2832" in said
    assert [line for line in said.splitlines() if line.isupper()] == ["OBSERVATION", "ACTION", "REWARD", "INFO"]


def test_json_is_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["describe", "-e", "HazardWind-v1", "--robot-uids", "g1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    rows = {row["key"]: row for row in told["observation"]}
    assert rows["extra/frame"]["low"] == 0.0 and rows["extra/frame"]["high"] == 3000
    assert rows["extra/agent_pose"]["high"][0] is None and rows["extra/agent_pose"]["entries"] == ["x", "y", "heading"]
    assert set(told) == {"observation", "action", "reward", "info"}


def test_environments_of_skills_are_described(capsys: pytest.CaptureFixture[str]) -> None:
    """Every index of the vector once; every option."""
    assert main(["describe", "-e", "HazardCompoundSkills-v1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    indices = []
    for row in told["observation"]:
        start, _, step = row["key"].strip("[").partition("]")[0].partition(" +")
        indices += [
            int(start) + k * int(step.split(" ")[0] or 0) if step else int(start) for k in range(row["shape"][0])
        ]
    assert sorted(indices) == list(range(len(indices)))
    assert [row["key"] for row in told["action"]] == [
        "[0:32] target",
        "[32:35] cart",
        "[35:43] landmark",
        "[43:44] look",
        "[44:45] stop",
    ]


def test_what_a_third_party_registered_is_described(capsys: pytest.CaptureFixture[str]) -> None:
    """Its task has an environment of skills, too; every number has a meaning."""
    example = Path(__file__).parents[2] / "examples" / "own_hazard.py"
    with loaded(example):
        for env_id in ("HazardEarthquake-v1", "HazardEarthquakeSkills-v1"):
            assert main(["describe", "-e", env_id, "--load", str(example), "--json"]) == 0
            told = json.loads(capsys.readouterr().out)
            assert all(row["meaning"] for rows in told.values() for row in rows)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [(["-e", "HazardFir-v1"], "HazardFire-v1"), (["--obs-mode", "stat"], "state"), (["-r", "g2"], "g1")],
)
def test_unknown_names_are_refused(wrong: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["describe", *wrong]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.render
def test_the_page_is_what_the_command_makes() -> None:
    made = page(tuple(TASKS), tuple(ROBOTS))
    assert PAGE.read_text() == made, "make it again: hazard-ms describe --markdown > docs/observations.md"
