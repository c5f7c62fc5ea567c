"""Submissions of teams: from results to the leaderboard, and every kind of cheating that those of one robot know."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.result import ERROR, EpisodeResult, Link
from hazard_ms.evaluation.submissions import faults
from hazard_ms.evaluation.submissions.copies import copied
from hazard_ms.evaluation.submissions.packing import read_submission
from hazard_ms.evaluation.submissions.report import read_report
from hazard_ms.evaluation.submissions.simulating import _job, _nobody, _seen, compared, verify
from hazard_ms.evaluation.submissions.tracks import TRACKS
from hazard_ms.skills.decision import STOP
from tests.evaluation.submissions.test_cheating import CHEATS, kinds
from tests.worlds.submissions import (
    CARD,
    FIRST,
    SECOND,
    TRIAL,
    TRIAL_TEAMS,
    Row,
    changed,
    honest,
    ignore,
    make_key,
    short_episode,
)

pytestmark = pytest.mark.render


def again(record: EpisodeResult) -> EpisodeResult:
    """The simulation of a record's decisions in the episode that the track asks for."""
    played = attempt(_job(record, (record.env_id, record.seed), TRIAL_TEAMS), ignore).result
    assert played is not None
    return played


def more(row: Row) -> None:
    row["settings"].update(robot_uids=["fetch"] * 3)


@pytest.mark.parametrize("name", CHEATS)
def test_what_was_changed_afterwards_is_named(name: str, of_team: bytes) -> None:
    kind, how = CHEATS[name]
    how = {"row": more} if name == "another robot" else how
    assert kinds(of_team, TRIAL_TEAMS) == []
    assert kind in kinds(changed(of_team, **how), TRIAL_TEAMS)


def test_an_episode_in_the_place_of_another_is_named(of_team: bytes) -> None:
    twice = changed(of_team, files=lambda files: {FIRST: files[SECOND], SECOND: files[SECOND]})
    assert faults.REPEATED in kinds(twice, TRIAL_TEAMS)


@pytest.mark.parametrize("share", [0.1, 0.99])
def test_a_truncated_file_is_named(share: float, of_team: bytes, tmp_path: Path) -> None:
    path = tmp_path / "cut.zip"
    path.write_bytes(of_team[: int(share * len(of_team))])
    assert [fault.kind for fault in verify(path, TRIAL_TEAMS).faults] == [faults.DAMAGED]


@pytest.mark.parametrize("name", ["oracle", "independent:oracle"])
def test_a_team_that_says_it_is_honest_is_named(name: str, pairs: list[EpisodeResult]) -> None:
    asked = [replace(result, agent=name) for result in pairs]
    assert kinds(honest(asked, track=TRIAL_TEAMS), TRIAL_TEAMS) == [faults.CARD]
    told = honest(asked, replace(CARD, privileged=True), TRIAL_TEAMS)
    assert kinds(told, TRIAL_TEAMS) == []


def test_one_robot_and_a_team_are_not_taken_for_each_other(of_team: bytes, submission: bytes) -> None:
    for content, track in ((of_team, TRIAL), (submission, TRIAL_TEAMS)):
        assert {faults.PHYSICS, faults.VERSION} <= set(kinds(content, track))


@pytest.mark.parametrize("name", ["greedy", "oracle"])
def test_what_is_told_of_one_robot_is_as_it_was(name: str) -> None:
    """Submissions and reports that were made before there were teams, to the byte and to the hash."""
    folder = Path(__file__).parents[3] / "results" / "leaderboard"
    submission, report = read_submission(folder / f"{name}.zip"), read_report(folder / f"{name}.report.json")
    for file, (_, result) in submission.rows().items():
        assert result.to_json().encode() == submission.files[file]
        (seen,) = (one for one in report.seen if one.seed == result.seed)
        assert _seen(seen.place, result, None, "exact").decisions == seen.decisions
        assert [_job(result, seen.place, TRIAL).robots] == [("",) * len(result.decisions)]


def exchanged(record: EpisodeResult, robots: dict[str, str]) -> EpisodeResult:
    """A record whose robots have each other's names."""
    return replace(record, decisions=tuple(replace(d, robot=robots[d.robot]) for d in record.decisions))


def test_what_only_a_simulation_shows_is_named(pairs: list[EpisodeResult]) -> None:
    record = pairs[0]
    played = again(record)
    assert compared(record, played) == ("exact", [])
    tell, wait, *rest = record.decisions
    best = tuple(replace(fate, rescued=True, frame=20) for fate in record.targets)
    forged = (*record.links[:-1], Link(record.frames, "f" * 64))
    for cheat, kind in (
        (replace(record, targets=best), faults.SCORE),
        (replace(record, robot_collisions=3), faults.SCORE),
        (replace(record, links=forged), faults.HASH),
        (replace(record, ended="time"), faults.CUT),
        (replace(record, links=record.links[:-1]), faults.CUT),
        (replace(record, decisions=(wait, tell, *rest)), faults.COURSE),
    ):
        assert [fault.kind for fault in compared(cheat, played)[1]] == [kind]


def test_decisions_and_messages_that_were_not_taken_are_named(pairs: list[EpisodeResult]) -> None:
    """Without the message robot 1 knows nothing of the thing, so that its step there fails."""
    record = pairs[0]
    tell, *rest = record.decisions
    silent = replace(record, decisions=(replace(tell, target="nothing is here"), *rest))
    for cheat in (silent, exchanged(record, {"fetch-0": "fetch-1", "fetch-1": "fetch-0"})):
        _, found = compared(cheat, again(cheat))
        assert found and found[0].kind in (faults.COURSE, faults.HASH, faults.CUT)
    other = pairs[1]
    stolen = replace(record, decisions=other.decisions)
    _, found = compared(stolen, again(stolen))
    assert found and found[0].kind in (faults.COURSE, faults.HASH, faults.CUT)


def test_a_record_that_ends_before_all_have_stopped_is_cut_unless_the_agent_failed(pairs: list[EpisodeResult]) -> None:
    """Nothing else in it is wrong: hashes, fates and frames are those of the simulation up to there."""
    record = pairs[0]
    stop = next(d for d in reversed(record.decisions) if d.verb == STOP)
    cut = replace(record, decisions=tuple(d for d in record.decisions if d is not stop))
    played = again(cut)
    for ended in ("stopped", "budget"):
        assert [fault.kind for fault in compared(replace(cut, ended=ended), played)[1]] == [faults.CUT]
    assert compared(replace(cut, ended=ERROR, error="ZeroDivisionError"), played) == ("exact", [])


def test_if_nobody_acts_all_robots_stop(pairs: list[EpisodeResult], episodes: list[EpisodeResult]) -> None:
    for record, track, robots in ((pairs[0], TRIAL_TEAMS, ("fetch-0", "fetch-1")), (episodes[0], TRIAL, ("",))):
        job = _nobody(_job(record, (record.env_id, record.seed), track))
        assert job.robots == robots and job.actions == ((STOP, None),) * len(robots)


def test_a_team_is_submitted_verified_and_listed_and_its_copy_is_named(
    pairs: list[EpisodeResult], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the commands alone. A track of one robot takes no team, and says why."""
    (tmp_path / "results").mkdir()
    for result in (*pairs, short_episode(0)):
        result.write(tmp_path / "results" / f"{len(result.decisions)}-{result.seed}.json")
    key, report, place = make_key(tmp_path, "anna"), tmp_path / "first.report.json", tmp_path / "first.zip"
    (tmp_path / "card.json").write_text(json.dumps({**asdict(CARD), "name": "first"}))
    submit = ["submit", str(tmp_path / "results"), "--card", str(tmp_path / "card.json"), "-o", str(place)]
    assert main([*submit, "--agent", "joint", "--track", "trial"]) == 2
    assert re.search(r"got 0; .*left out: 5-0\.json, whose robot_uids must be 'fetch', got", capsys.readouterr().err)
    assert main([*submit, "--track", "trial-teams"]) == 0
    assert main(["verify", str(place), "--backend", "serial", "-o", str(report), "--key", str(key)]) == 0
    assert "verified: all 2 episodes" in capsys.readouterr().out
    found = read_report(report)
    assert [(one.tally, one.course) for one in found.seen] == [(r.tally, r.links[-1].sha256) for r in pairs]
    theft = replace(found, submission="f" * 64, card=replace(CARD, authors=("a thief",)))
    assert [fault.what for fault in copied(theft, [found])] == ["2 of 2 episodes are those of 'first'"]
    other = exchanged(pairs[0], {"fetch-0": "fetch-1", "fetch-1": "fetch-0"})
    assert _seen(found.seen[0].place, other, None, "exact").decisions != found.seen[0].decisions
    assert main(["leaderboard", str(tmp_path), "-o", str(tmp_path / "site")]) == 0
    assert "trial-teams: first" in capsys.readouterr().out
    assert TRACKS["trial-teams"].words in (tmp_path / "site" / "index.html").read_text()
