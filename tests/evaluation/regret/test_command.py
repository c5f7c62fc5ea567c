"""`hazard-ms regret`: out of a result alone, with the waits of its agent, resumed, and shown by `hazard-ms report`."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.attempts import attempt as replayed
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.causes import (
    ENDED,
    LATENCY,
    PLANNING,
    Appraisal,
    EpisodeRegret,
    beside,
    decisions_of,
    digest,
    lost_by,
    place_of,
)
from hazard_ms.evaluation.regret.command import RegretJob, attempt
from hazard_ms.evaluation.replay import EXACT, compare, job_of
from hazard_ms.evaluation.result import ERROR, EpisodeResult
from hazard_ms.evaluation.runner import play
from hazard_ms.skills.decision import WALK_TO, Action
from tests.worlds.courses import drawn
from tests.worlds.duel import DEAR, FRAMES, PAUSE, TASK, Scripted, duel
from tests.worlds.registering import registered_task


@pytest.mark.render
@pytest.mark.long
def test_an_episode_is_judged_from_its_record_as_it_was_played(tmp_path: Path) -> None:
    """Its waits included; one that an agent broke off says what could still be rescued."""
    place = tmp_path / "slow.json"
    with registered_task(TASK, duel, FRAMES):
        played = play(EpisodeOptions(TASK, agent="slow"), player=Scripted(Action(WALK_TO, DEAR), pause=PAUSE))
        assert [decision.waited for decision in played.decisions] == [PAUSE, 0]
        played.write(place)
        again = replayed(job_of(EpisodeResult.read(place)), lambda word: None).result
        assert again is not None and compare(played, again) == (EXACT, "")
        _judge(place)
        found = beside(place)
        assert found is not None and found.decisions[0].cause == LATENCY and found.lost[ENDED] == 0.0
        assert found.start - found.value == pytest.approx(sum(found.lost.values()))
        first = place_of(place).read_bytes()
        _judge(place)
        assert place_of(place).read_bytes() == first

        broken = dataclasses.replace(played, decisions=played.decisions[:0], links=played.links[:1], ended=ERROR)
        broken.write(place)
        assert beside(place) is None
        _judge(place)
        found = beside(place)
        assert found is not None and found.lost[ENDED] == found.start > 0.5 and found.decisions == ()

        other = dataclasses.replace(played, targets=(dataclasses.replace(played.targets[0], rescued=True, frame=9),))
        other.write(place)
        outcome = attempt(_job(place), lambda word: None)
        assert outcome.result is None and "its replay must be the same episode, got another" in outcome.error


def _job(place: Path) -> RegretJob:
    job = job_of(EpisodeResult.read(place))
    return RegretJob(job.options, job.decision_seconds, job.actions, job.waits, place)


def _judge(place: Path) -> None:
    outcome = attempt(_job(place), lambda word: None)
    assert outcome.result is not None, outcome.error


@pytest.mark.render
@pytest.mark.long
def test_the_command_judges_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place, said = tmp_path / "results" / "one.json", tmp_path / "lost.json"
    place.parent.mkdir()
    play(EpisodeOptions(split="test", seed=4, agent="tests.evaluation.test_play:Short")).write(place)
    command = ["regret", str(place.parent), "--workers", "1", "-o", str(said)]
    assert main(command) == 0
    (agent,) = json.loads(said.read_text())
    row = json.loads(said.read_text())[agent]
    assert agent == "tests.evaluation.test_play:Short" and row["value"] == 0.0
    assert row[PLANNING] > 0.5 * row["start"] > 0.2  # it stops in the middle
    assert "1/1 one.json" in capsys.readouterr().out
    written = place_of(place).stat().st_mtime_ns
    assert main(command) == 0
    assert place_of(place).stat().st_mtime_ns == written and "1/1" not in capsys.readouterr().out
    assert main(["replay", str(place.parent)]) == 0  # the files beside results are no results


def test_folders_without_results_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["regret", str(tmp_path)]) == 2 and "got none in" in capsys.readouterr().err
    assert main(["regret", str(tmp_path / "no")]) == 2 and "folder must be one that" in capsys.readouterr().err


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three results of two agents, of which two were judged."""
    for agent, seed, regret in (("greedy", 0, 0.2), ("greedy", 1, 0.4), ("rule", 0, None)):
        place = tmp_path / f"{agent}-{seed}.json"
        drawn(agent, seed, 0.6).write(place)
        if regret is not None:
            choice = Appraisal(100 + seed, "walk_to", "pan_1", 0.9, regret, regret, instead="to rescue <b>")
            decisions = decisions_of([choice], [False], [0.4])
            EpisodeRegret(
                digest(place), agent, seed, f"room/{seed:02d}", 0.9, 0.4, lost_by(decisions, 0.0), decisions
            ).write(place_of(place))
    return tmp_path


def test_the_report_shows_what_was_lost(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(folder), "--json"]) == 0
    agents = json.loads(capsys.readouterr().out)["groups"][0]["agents"]
    lost = agents["greedy"]["lost"]
    assert "lost" not in agents["rule"] and lost["episodes"] == 2
    assert lost["shares"]["planning"] == pytest.approx(0.3) and lost["shares"]["execution"] == pytest.approx(0.2)
    assert [(row["frame"], row["lost"]) for row in lost["worst"]] == [(101, 0.4), (100, 0.2)]
    page = folder / "page.html"
    assert main(["report", str(folder), "-o", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert "What was lost, and why" in text and "to rescue &lt;b&gt; was worth 40.0 % of the value more" in text
    assert text.count("left out") == 0 and ">room/01</a>" in text
    table = capsys.readouterr().out
    assert "lost, % of value" in table and "left out" not in table


def test_a_result_that_was_played_again_is_not_shown_with_an_older_regret(folder: Path) -> None:
    for seed in range(2):
        drawn("greedy", seed, 0.7).write(folder / f"greedy-{seed}.json")
    page = folder / "page.html"
    assert main(["report", str(folder), "-o", str(page)]) == 0
    assert "What was lost" not in page.read_text(encoding="utf-8")
