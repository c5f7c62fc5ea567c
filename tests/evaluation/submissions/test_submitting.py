"""From results to the leaderboard by the commands alone, with real episodes and a real key."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.cli.report import TRACKS as OFFERED
from hazard_ms.evaluation.result import DIED, EpisodeResult
from hazard_ms.evaluation.submissions import simulating
from hazard_ms.evaluation.submissions.report import Sample, read_report
from hazard_ms.evaluation.submissions.signing import signer
from hazard_ms.evaluation.submissions.tracks import HIDDEN, TRACKS, track_of
from hazard_ms.evaluation.workers import Job, Outcome
from hazard_ms.machine.cores import maker
from tests.worlds.submissions import CARD, SHORT, make_key, report_of


@pytest.fixture
def results(tmp_path: Path, episodes: list[EpisodeResult]) -> Path:
    """A folder of the two results and a card."""
    folder = tmp_path / "results"
    folder.mkdir()
    for result in episodes:
        result.write(folder / f"{result.seed}.json")
    (tmp_path / "card.json").write_text(json.dumps(asdict(CARD)))
    return folder


def submit(results: Path, *words: str) -> int:
    """Submit to the track `trial`. Returns the exit code."""
    place = results.parent
    named = ["--card", str(place / "card.json"), "-o", str(place / "short.zip"), "--track", "trial"]
    return main(["submit", str(results), *named, *words])


@pytest.mark.render
def test_a_submission_is_verified_signed_and_listed(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = results.parent
    assert submit(results) == 0
    key = make_key(place, "anna")
    path = place / "short.report.json"
    words = ["verify", str(place / "short.zip"), "-o", str(path), "--key", str(key), "--backend", "serial"]
    assert main(words) == 0
    told = capsys.readouterr().out
    assert "verified: all 2 episodes" in told and told.count(": exact") == 2
    report = read_report(path)
    assert report.verified and [one.verdict for one in report.seen] == ["exact", "exact"]
    tallies = [EpisodeResult.read(results / f"{seed}.json").tally for seed in (0, 1)]
    assert [one.tally for one in report.seen] == tallies and report.submission in path.read_text()
    assert signer(path, place / "signers") == "anna"
    assert main(["leaderboard", str(place), "-o", str(place / "site")]) == 0
    assert "trial: short" in capsys.readouterr().out
    assert "verified: all 2 episodes" in (place / "site" / f"{report.submission[:16]}.html").read_text()
    path.write_text(path.read_text().replace('"frames": ', '"frames": 1', 1))
    with pytest.raises(
        ValueError, match=r"short\.report\.json must be unchanged since anna signed it, got other content"
    ):
        signer(path, place / "signers")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda results: (results / "1.json").unlink(), "folders must hold all 2 episodes of track trial, got 1"),
        (lambda results: (results.parent / "card.json").unlink(), "card must be a file with the agent's card"),
        (lambda results: card(results, link="javascript:alert(1)"), "link of a card must begin with https://"),
        (lambda results: card(results, authors=[]), "authors must be of length 1 to 100"),
        (lambda results: another(results, agent="greedy"), f"agent must be one of greedy, {SHORT}, got none"),
        (lambda results: another(results), r"folders must hold episodes/HazardFire-v1-0001\.json of .* once"),
        (lambda results: old(results), "other version: .*hazard-ms must be"),
    ],
)
def test_what_cannot_be_submitted_is_refused(
    change: Callable[[Path], None], told: str, results: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change(results)
    assert submit(results) == 2 and not (results.parent / "short.zip").exists()
    assert re.search(told, capsys.readouterr().err)


def card(results: Path, **changes: object) -> None:
    (results.parent / "card.json").write_text(json.dumps({**asdict(CARD), **changes}))


def another(results: Path, **changes: object) -> None:
    replace(EpisodeResult.read(results / "1.json"), **changes).write(results / "2.json")  # type: ignore[arg-type]


def old(results: Path) -> None:
    result = EpisodeResult.read(results / "1.json")
    replace(result, versions={**result.versions, "hazard-ms": "0.0.9"}).write(results / "1.json")


def test_one_agent_of_several_is_submitted(results: Path) -> None:
    another(results, agent="greedy")
    assert submit(results, "--agent", SHORT) == 0


def test_the_command_offers_the_tracks_there_are() -> None:
    assert OFFERED == tuple(TRACKS)
    with pytest.raises(ValueError, match="track must be one of published, .* got 'Published'"):
        track_of("Published")
    with pytest.raises(ValueError, match="must be given with its files"):
        track_of(f"{HIDDEN}autumn")


def test_a_track_asks_for_each_scene_of_its_split_once() -> None:
    """25 of each published task, 50 of each kind of home (docs/benchmark.md)."""
    for name, tasks, scenes in (("published", 3, 25), ("houses", 2, 50)):
        track = TRACKS[name]
        assert len(track.places) == tasks * scenes == len({(p[0], track.scene(p)) for p in track.places})


def test_a_quick_look_says_that_it_is_one(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    places = {("HazardFire-v1", seed): 0.5 for seed in range(5)}
    part = report_of("a", places, sample=Sample(5, 1), episodes=25)
    assert not part.verified and part.verdict == "no fault in 5 of 25 episodes: the rest was not simulated"
    assert submit(results) == 0
    for words, told in (
        (("--episodes", "3"), "episodes must be a whole number from 0 to 2, got 3"),
        (("--workers", "-1"), "workers must be a whole number from 0 to 1024, got -1"),
        (("--backend", "rays"), "backend must be one of serial, local, ray, got 'rays'"),
    ):
        assert main(["verify", str(results.parent / "short.zip"), *words]) == 2
        assert told in capsys.readouterr().err


@pytest.mark.parametrize(
    ("versions", "machine", "ended", "told"),
    [
        ({"torch": "1.0"}, {}, "", "all machines must have the versions .* got one with torch 1.0"),
        (
            {},
            {"processor": "Other"},
            "",
            f"all machines must have processors of the same maker, got Other there and {maker()} here",
        ),
        ({}, {"instructions": "DEFAULT"}, "", "all machines must compute with AVX2, got one where torch uses DEFAULT"),
        ({}, {}, DIED, r"each episode must be simulated, got episodes/HazardFire-v1-0000\.json: worker died"),
    ],
)
def test_what_says_nothing_of_a_submission_is_no_fault_of_it(
    versions: dict[str, str],
    machine: dict[str, str],
    ended: str,
    told: str,
    results: Path,
    episodes: list[EpisodeResult],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Machines that simulate otherwise, and processes that die, accuse nobody: there is no report.

    Here the first episode is as the submission says, and in place of the second one comes the first again.
    """
    own = episodes[0].machine | {"processor": maker(), "instructions": "AVX2"} | machine
    result = replace(episodes[0], versions=episodes[0].versions | versions, machine=own)

    @contextmanager
    def elsewhere(jobs: Sequence[Job], *_: object) -> Iterator[Iterator[tuple[Job, Outcome]]]:
        yield ((job, Outcome(result, ended, died=bool(ended))) for job in jobs)

    assert submit(results) == 0
    monkeypatch.setattr(simulating, "spread", elsewhere)
    path = results.parent / "short.report.json"
    assert main(["verify", str(results.parent / "short.zip"), "-o", str(path)]) == 2
    shown = capsys.readouterr()
    assert re.search(told, shown.err) and (ended or "0000.json: exact" in shown.out) and not path.exists()
