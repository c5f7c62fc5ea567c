"""Recorded answers play an episode again without the network, and are used for nothing else."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.cache import TABLE, Cache, Stored, key_of
from hazard_ms.agents.llm.scripted import ScriptedServer
from tests.agents.llm.conftest import Ground, Made
from tests.worlds.playground import play

PLAYED = {"way": "think", "version": "llm-2"}


def test_a_replay_needs_no_network_and_is_the_same(llm: Made, server: ScriptedServer, tmp_path: Path) -> None:
    file = str(tmp_path / "answers.sqlite")
    player = llm(cache=file, **PLAYED)
    taken, calls = play(player, Ground()), player.counters["calls"]
    thought = player.counters["seconds"]
    asked = server.calls
    server.stop()
    again = Llm(base_url=server.address, model="greedy", cache=file, replay=True, **PLAYED)  # type: ignore[arg-type]
    assert play(again, Ground()) == taken
    assert server.calls == asked == calls
    assert again.counters == {**player.counters, "cached": calls}, "times, too, are those that were recorded"
    assert thought > 0


def test_calls_without_an_answer_are_replayed_as_such(llm: Made, server: ScriptedServer, tmp_path: Path) -> None:
    file = str(tmp_path / "answers.sqlite")
    lost = llm("500", cache=file, tries=1)
    with pytest.raises(RuntimeError, match="3 decisions"):
        play(lost, Ground())
    again = llm("500", cache=file, replay=True)
    asked = server.calls
    with pytest.raises(RuntimeError, match="3 decisions"):
        play(again, Ground())
    assert server.calls == asked and again.counters["lost"] == 3
    with pytest.raises(RuntimeError, match="3 decisions"):
        play(llm("500", cache=file, tries=1), Ground())
    assert server.calls == asked + 3, "over the network they are tried again"


@pytest.mark.parametrize("other", [{"temperature": 0.5}, {"version": "llm-1"}, {"sample": 1}, {"model": "first"}])
def test_answers_to_other_questions_are_not_used(llm: Made, tmp_path: Path, other: dict[str, object]) -> None:
    file = str(tmp_path / "answers.sqlite")
    play(llm(cache=file, version="llm-2"), Ground(), most=4)
    player = llm(**{"cache": file, "replay": True, "version": "llm-2", **other})
    with pytest.raises(ValueError, match="cache must hold an answer to every call"):
        play(player, Ground(), most=4)


def test_recorded_answers_save_calls(llm: Made, server: ScriptedServer, tmp_path: Path) -> None:
    file = str(tmp_path / "answers.sqlite")
    first = play(llm(cache=file), Ground())
    asked = server.calls
    player = llm(cache=file)
    assert play(player, Ground()) == first
    assert server.calls == asked and player.counters["cached"] == player.counters["calls"] == asked


def test_the_same_question_twice_in_an_episode_has_two_answers() -> None:
    request = {"model": "m", "messages": []}
    keys = {key_of(request, sample, turn) for sample in (0, 1) for turn in (0, 1)}
    assert len(keys) == 4 and key_of(dict(reversed(request.items())), 0, 0) == key_of(request, 0, 0)


def test_files_that_hold_no_answers_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="cache must be a file of recorded answers"):
        Cache(tmp_path / "none.sqlite", writable=False)
    (tmp_path / "text").write_text("no database " * 1000)
    with pytest.raises(ValueError, match="cache must be a file of recorded answers"):
        Cache(tmp_path / "text")
    with sqlite3.connect(tmp_path / "other") as other:
        other.execute("CREATE TABLE things (name TEXT)")
    with pytest.raises(ValueError, match="cache must be a file of recorded answers"):
        Cache(tmp_path / "other", writable=False)


def test_two_processes_share_a_file(tmp_path: Path) -> None:
    one, two = Cache(tmp_path / "both"), Cache(tmp_path / "both")
    one.put("a", Stored({"x": [1, "ü"]}, 0.25), "host", "m")
    two.put("b", Stored({}, 1.0), "host", "m")
    assert two.get("a") == Stored({"x": [1, "ü"]}, 0.25) and one.get("b") == Stored({}, 1.0) and one.get("c") is None


ROW = "INSERT INTO answers (key, body, seconds, host, model) VALUES ('k', {body}, {seconds}, '', '')"


@pytest.mark.parametrize(
    "script",
    [
        "CREATE VIEW answers AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x+1 FROM c) "
        "SELECT 'k' AS key, '{}' AS body, 1 AS seconds FROM c WHERE x < 0",
        f"{TABLE}; CREATE TRIGGER q AFTER INSERT ON answers BEGIN DELETE FROM answers; END",
        "CREATE TABLE answers (key TEXT PRIMARY KEY, body, seconds, host, model, at)",
        f"{TABLE}; CREATE TABLE more (x)",
    ],
)
def test_files_with_other_tables_are_refused(tmp_path: Path, script: str) -> None:
    with sqlite3.connect(tmp_path / "other") as other:
        other.executescript(script)
    with pytest.raises(ValueError, match="cache must be a file of recorded answers, got a database with other tables"):
        Cache(tmp_path / "other")


@pytest.mark.parametrize(
    ("body", "seconds"),
    [("'[1]'", "1"), ("x'ff00'", "1"), ("'{'", "1"), ("'{}'", "'abc'"), ("'{}'", "9e999"), ("'5'", "1")],
)
def test_rows_of_other_types_are_refused(tmp_path: Path, body: str, seconds: str) -> None:
    cache = Cache(tmp_path / "answers")
    with sqlite3.connect(tmp_path / "answers") as database:
        database.execute(ROW.format(body=body, seconds=seconds))
    with pytest.raises(ValueError, match="answers"):
        cache.get("k")
