"""Every kind of track with real episodes: with perception, by a clock, in homes, in hidden scenes."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from hazard_ms.agents.base import Agent
from hazard_ms.agents.latency import TOKENS, Thought
from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.averted.alone import losses
from hazard_ms.evaluation.choices import EnvOptions
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.spread import Where
from hazard_ms.evaluation.submissions import faults
from hazard_ms.evaluation.submissions.faults import faults_of
from hazard_ms.evaluation.submissions.packing import pack, submission_of
from hazard_ms.evaluation.submissions.simulating import compared, simulated
from hazard_ms.evaluation.submissions.tracks import Place, Track
from hazard_ms.evaluation.workers import Job
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision
from tests.worlds.submissions import CARD, ignore, make_key

pytestmark = [pytest.mark.render, pytest.mark.long, pytest.mark.timeout(900)]
FIRE, HOME = "HazardFire-v1", "HazardHouseFire-v1"
LOOKER, THINKER = (f"tests.evaluation.submissions.test_tracks:{name}" for name in ("Looker", "Thinker"))


class Looker(Agent):
    """Looks around twice and stops, whatever it sees."""

    def reset(self, brief: Brief) -> None:
        self.left = [STOP, EXPLORE, EXPLORE]

    def act(self, decision: Decision) -> Action:
        return Action(self.left.pop())


class Thinker(Looker):
    """Takes the time of 50 written tokens for each decision: 1.3 s, 39 frames."""

    thought = Thought(0.0, 0, 50, 1)


def played(options: EpisodeOptions, averted: bool = False) -> EpisodeResult:
    result = attempt(Job(options, 60.0, averted=averted), ignore).result
    assert result is not None and not result.error
    return result


def check(track: Track, result: EpisodeResult) -> None:
    """The submission of one episode has no fault, and its simulation is exact, with the same score."""
    place: Place = (result.env_id, result.seed)
    submission = submission_of(pack({place: result}, track, CARD), "it")
    assert faults_of(submission, track) == []
    (seen,), found = simulated(submission, track, [place], Where(1))
    assert (seen.verdict, found) == ("exact", []) and seen.tally == result.tally and seen.averted == result.averted


def test_with_perception() -> None:
    track = Track("perception", "", (FIRE,), 1, detectors=("small",))
    check(track, played(track.options((FIRE, 0), LOOKER, "small")))


def test_by_a_clock() -> None:
    """A wait that the tokens do not explain is found without a simulation."""
    track = Track("clock", "", (FIRE,), 1, clock=TOKENS)
    result = played(replace(track.options((FIRE, 0), THINKER), clock=TOKENS))
    assert [d.waited for d in result.decisions] == [39, 39, 39]
    check(track, result)
    quick = replace(result, decisions=tuple(replace(d, waited=0) for d in result.decisions))
    found = faults_of(submission_of(pack({(FIRE, 0): quick}, track, CARD), "it"), track)
    assert [(fault.kind, fault.what) for fault in found] == [(faults.RULES, "decision 0 must wait 39 frames, got 0")]


def test_in_homes(tmp_path: Path) -> None:
    """The score is what was averted, against the same episode without anybody."""
    track = Track("houses", "", (HOME,), 1, averted=True)
    options = track.options((HOME, 0), LOOKER)
    sweep = SweepOptions(EnvOptions(HOME, "test"), (LOOKER,), episodes=1, workers=1, output=tmp_path)
    alone = losses(sweep, [options])[options]
    result = replace(played(options, averted=True), lost_alone=alone)
    assert result.averted is not None
    better = replace(result, lost_alone=replace(alone, targets=alone.targets + 1.0)) if alone else result
    assert [fault.kind for fault in compared(better, result)[1]] == [faults.SCORE]
    check(track, result)


def test_in_hidden_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By the commands alone: drawn, published, played, submitted, verified, signed, listed."""
    file, secret, scenes = (tmp_path / name for name in ("autumn.json", "secret.json", "scenes"))
    assert main(["commitments", str(file), "--draw", "1", "--secret", str(secret)]) == 0
    assert main(["commitments", str(file), "--published", str(secret), "-o", str(scenes)]) == 0
    for task in ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"):
        words = ["evaluate", "-e", task, "--split", "test", "--scenes", str(scenes / task), "--agents", LOOKER]
        assert main([*words, "--workers", "1", "-o", str(tmp_path / "played")]) == 0
    (tmp_path / "card.json").write_text(json.dumps(asdict(CARD)))
    hidden = ["--hidden", str(file), str(secret)]
    named = ["--card", str(tmp_path / "card.json"), "-o", str(tmp_path / "short.zip")]
    assert main(["submit", str(tmp_path / "played"), *named, *hidden]) == 0
    signed = ["-o", str(tmp_path / "short.report.json"), "--key", str(make_key(tmp_path))]
    assert main(["verify", str(tmp_path / "short.zip"), "--workers", "1", *hidden, *signed]) == 0
    assert "verified: all 3 episodes" in capsys.readouterr().out
    assert main(["leaderboard", str(tmp_path), "-o", str(tmp_path / "site")]) == 0
    shown = capsys.readouterr().out
    assert "hidden-autumn: short" in shown and "not counted" not in shown
    assert "hidden-autumn" in (tmp_path / "site" / "index.html").read_text()
    assert main(["verify", str(tmp_path / "short.zip")]) == 2
    assert "must be given with its files, --hidden" in capsys.readouterr().err
