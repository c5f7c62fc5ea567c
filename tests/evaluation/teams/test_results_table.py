"""results/teams.py plays through `hazard-ms evaluate`, and its rows are what results tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hazard_ms.evaluation.averted.loss import Loads, Loss
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult
from results import teams
from tests.evaluation.teams.test_fields import TEAM
from tests.worlds.results import result_of

HOME = "HazardHouseFire-v1"
BORNE = {"fetch-0": Loads(heat=0.5, collisions=2), "fetch-1": Loads(heat=0.25)}


def played(env_id: str, agent: str, seed: int, robots: str | tuple[str, ...]) -> EpisodeResult:
    """A result as `evaluate` writes it: of 8 lost if nobody acts, 2 are lost."""
    options = EpisodeOptions(env_id, split="test", robot_uids=robots, agent=agent, seed=seed)
    loss = Loss(2.0, 20.0, 2.0, 20.0)
    made = replace(result_of(options), lost=loss, lost_alone=replace(loss, targets=8.0), loads=Loads(heat=1.5))
    own = {"format": 4, "robot_collisions": 1, "robot_loads": BORNE, "loads": None}
    return made if isinstance(robots, str) else replace(made, **own)  # type: ignore[arg-type]


def test_a_row_tells_what_the_result_does() -> None:
    pair, one = (played(HOME, agent, 3, robots) for agent, robots in (("joint", teams.PAIR), ("greedy", "fetch")))
    row = teams.row_of(pair)
    assert list(row) == list(teams.COLUMNS) and row["robots"] == "fetch fetch" and row["robot_collisions"] == "1"
    assert (row["averted"], row["heat"], row["water"]) == ("0.75", "0.5 0.25", "")
    assert (float(row["value"]), int(row["rescued"])) == (pair.tally.value, pair.tally.rescued)
    single = teams.row_of(one)
    assert (single["robots"], single["heat"], single["robot_collisions"]) == ("fetch", "1.5", "0")
    assert teams.row_of(replace(TEAM, robot_loads=None))["heat"] == ""
    assert [teams.setup_of(each) for each in (row, single)] == ["2 joint", "1 greedy"]


def test_what_is_missing_is_played_by_evaluate_and_nothing_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, ...]] = []

    def evaluate(task: str, folder: Path, *words: str, check: bool) -> None:
        asked.append(words)
        robots, seed = words[words.index("-r") + 1 :], int(words[words.index("-s") + 1])
        folder.mkdir(parents=True, exist_ok=True)
        agent = words[words.index("--agents") + 1]
        result = played(task, agent, seed, robots if len(robots) > 1 else robots[0])
        result.write(folder / f"{task}-{seed}.json")

    for name, value in {"RAW": tmp_path / "raw", "FILE": tmp_path / "teams.csv", "HERE": tmp_path}.items():
        monkeypatch.setattr(teams, name, value)
    monkeypatch.setattr(teams, "evaluate", evaluate)
    monkeypatch.setattr(teams, "machine", lambda: "a machine")
    teams.play(HOME, 2)
    teams.play(HOME, 2)
    assert len(asked) == 2 * (len(teams.SETUPS) - 1)
    assert [words[words.index("--agents") + 1 :] for words in asked[:3]] == [
        ("greedy", "-s", "0", "--episodes", "1", "-r", "fetch"),
        ("planner", "-s", "0", "--episodes", "1", "-r", "fetch"),
        ("independent", "-s", "0", "--episodes", "1", "-r", "fetch", "fetch"),
    ]
    teams.main(["oracle", "house fire", "1"])
    assert [words[words.index("--agents") + 1] for words in asked[-2:]] == ["joint", "oracle"]
    text = (tmp_path / "teams.csv").read_text()
    teams.write(teams.episodes())
    assert (tmp_path / "teams.csv").read_text() == text and text.count("\n") == 1 + len(asked)
    for name in ("2 joint", "2 oracle"):
        assert f"| house fire | {name} |" in (tmp_path / "teams.md").read_text()


def test_the_table_in_the_repository_is_that_of_its_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(teams, "RAW", tmp_path)
    every = teams.episodes()
    kept, shown = teams.FILE.read_text(), (teams.HERE / "teams.md").read_text()
    assert teams.tables(every) in shown
    monkeypatch.setattr(teams, "FILE", tmp_path / "teams.csv")
    monkeypatch.setattr(teams, "HERE", tmp_path)
    monkeypatch.setattr(teams, "machine", lambda: "a machine")
    teams.write(every)
    assert (tmp_path / "teams.csv").read_text() == kept
