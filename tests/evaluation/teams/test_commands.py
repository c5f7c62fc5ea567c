"""Which commands take several robots, and what they refuse of them before anything is played."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import tyro

from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.evaluation import sweep
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions, PlayOptions, SweepOptions
from hazard_ms.evaluation.regret.command import regret
from hazard_ms.evaluation.spread import Where
from hazard_ms.machine.processes import needs_key
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.pictures.options import RenderOptions
from tests.evaluation.teams.test_fields import TEAM

TWO = EnvOptions(split="test", robot_uids=("fetch", "fetch"))


def test_several_robots_are_a_team_and_one_is_none() -> None:
    words = ["--robot-uids", "fetch", "g1", "--agents", "joint", "auction"]
    options = tyro.cli(tyro.conf.OmitArgPrefixes[SweepOptions], args=words)
    assert options.env.robot_uids == ("fetch", "g1") and options.agents == ("joint", "auction")
    assert options.env.settings["robot_uids"] == ("fetch", "g1")
    one = tyro.cli(tyro.conf.OmitArgPrefixes[SweepOptions], args=["-r", "g1"])
    assert one.env.robot_uids == "g1" and not one.env.team
    assert EnvOptions(robot_uids=("g1",)).robot_uids == "g1"
    assert EnvOptions(robot_uids=["fetch", "fetch"]).robot_uids == ("fetch", "fetch")  # type: ignore[arg-type]


def test_teams_have_files_of_their_own() -> None:
    names = set()
    for robots in ("fetch", ("fetch", "fetch"), ("fetch", "g1")):
        options = SweepOptions(EnvOptions(robot_uids=robots), agents=("joint",), episodes=1)
        names.add(options.place(options.episode_options()[0]).name)
    assert len(names) == 3 and "HazardFire-v1-train-paper-fetch-g1-joint-0000.json" in names


BAD: list[tuple[dict[str, Any], str]] = [
    ({"agents": ("joint", "greedy")}, "team agent must be one of independent, auction, joint.*got 'greedy'"),
    ({"agents": ("independent:gready",)}, "did you mean 'greedy'"),
    ({"agents": ("independent:oracle",)}, "agents of a team must see only what robots see .* got oracle"),
    ({"agents": ("joint:planner",)}, "must be joint alone"),
    ({"clock": "wall"}, "clock of a team must be one of off, got 'wall'"),
    ({"perception": "noisy"}, "perception of a team must be one of truth, got 'noisy'"),
    ({"env": EnvOptions(robot_uids=("fetch", "fetsh"))}, "robot_uids must be .* got 'fetsh'"),
    ({"env": EnvOptions(robot_uids=("fetch",) * 5)}, "robot_uids must be at most 4 robots, got 5"),
]


@pytest.mark.parametrize(("bad", "told"), BAD, ids=str)
def test_what_no_team_can_do_is_refused_before_anything_is_played(
    bad: dict[str, Any], told: str, tmp_path: Path
) -> None:
    given = {"env": TWO, "agents": ("joint",), "episodes": 1, "output": tmp_path / "results", **bad}
    with pytest.raises(ValueError, match=told):
        sweep.evaluate(SweepOptions(**given))
    assert not list(tmp_path.glob("results/*.json"))


def test_no_robot_is_refused() -> None:
    with pytest.raises(ValueError, match="robot_uids must be at least one robot"):
        EnvOptions(robot_uids=())


@pytest.mark.parametrize(
    "options",
    [
        RenderOptions(Path("a.png"), episode=EpisodeOptions(robot_uids=("fetch", "fetch"))),
        RecordOptions(TWO),
        CaptureOptions(TWO),
    ],
    ids=lambda options: type(options).__name__,
)
def test_other_commands_have_one_robot(options: RenderOptions | RecordOptions | CaptureOptions) -> None:
    with pytest.raises(ValueError, match="robot_uids must be at most one robot here: .*got 2"):
        options.check()
    PlayOptions(EpisodeOptions(robot_uids=("fetch", "fetch"))).check()


def test_decisions_of_teams_are_not_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    TEAM.write(tmp_path / "team.json")
    with pytest.raises(ValueError, match="got none in"):
        regret([tmp_path], Where(1), ())
    assert f"left out: {tmp_path}/team.json was played by a team, whose decisions" in capsys.readouterr().out


def test_each_robot_of_a_team_may_ask_a_model() -> None:
    assert needs_key("independent:llm:model=a") and needs_key("independent:own.py:Mine") and needs_key("llm")
    assert not needs_key("independent") and not needs_key("independent:planner") and not needs_key("joint")


def test_words_that_are_options_are_no_robots(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        tyro.cli(tyro.conf.OmitArgPrefixes[PlayOptions], args=["-r", "fetch", "--help"])
    assert ended.value.code == 0 and "{fetch,g1} ..." in capsys.readouterr().out
