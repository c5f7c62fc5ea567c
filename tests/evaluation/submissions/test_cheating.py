"""Ten kinds of cheating, each in a real submission: every one is caught, and named for what it is."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.replay import episode_of
from hazard_ms.evaluation.result import EpisodeResult, Link
from hazard_ms.evaluation.submissions import faults
from hazard_ms.evaluation.submissions.copies import copied
from hazard_ms.evaluation.submissions.faults import KINDS, faults_of
from hazard_ms.evaluation.submissions.packing import submission_of
from hazard_ms.evaluation.submissions.simulating import compared, verify
from hazard_ms.evaluation.submissions.tracks import Track
from hazard_ms.evaluation.workers import SILENCE, Job
from hazard_ms.skills.decision import EXPLORE
from tests.worlds.submissions import (
    CARD,
    FIRST,
    SECOND,
    SHORT,
    TRIAL,
    Row,
    begun_episode,
    changed,
    honest,
    ignore,
    report_of,
    rescored,
)


def kinds(content: bytes, track: Track = TRIAL) -> list[str]:
    """The kinds of the faults that show without a simulation."""
    return list(dict.fromkeys(fault.kind for fault in faults_of(submission_of(content, "it"), track)))


def test_an_honest_submission_has_no_fault(submission: bytes, episodes: list[EpisodeResult]) -> None:
    assert kinds(submission) == [] == kinds(changed(submission, rescored))
    assert honest(episodes) == submission  # the same bytes from the same results


def swap(files: dict[str, bytes]) -> dict[str, bytes]:
    return dict(reversed(files.items()))


def cut(row: Row) -> None:
    """Forget the last decision and all that came of it; the scores are as they were."""
    row["decisions"].pop()
    row["links"] = row["links"][:2]
    row["frames"] = row["links"][-1]["frame"] + 1
    rescored(row)


CHEATS: dict[str, tuple[str, dict[str, Callable[[Any], Any]]]] = {
    "a better score in a result": (faults.SCORE, {"row": lambda row: row["score"].update(value=1.0)}),
    "a better score in the manifest": (
        faults.SCORE,
        {"manifest": lambda told: told["values"].update({"HazardFire-v1": 1.0})},
    ),
    "another scene": (faults.SCENE, {"row": lambda row: row.update(scene="kitchen_b/07")}),
    "other physics": (faults.PHYSICS, {"row": lambda row: row["settings"].update(physics="realistic")}),
    "another robot": (faults.PHYSICS, {"row": lambda row: row["settings"].update(robot_uids="g1")}),
    "a cut episode": (faults.CUT, {"row": cut}),
    "an older version": (faults.VERSION, {"row": lambda row: row["versions"].update({"hazard-ms": "0.0.9"})}),
    "a forged hash of a file": (
        faults.HASH,
        {"files": lambda files: files | {FIRST: files[FIRST].replace(b'"note": "', b'"note": "X', 1)}},
    ),
    "a reordered manifest": (faults.ORDER, {"manifest": lambda told: told["episodes"].reverse()}),
    "reordered files": (faults.ORDER, {"files": swap}),
    "the same episode twice": (faults.REPEATED, {"manifest": lambda told: told["episodes"][1].update(seed=0)}),
    "an episode left out": (faults.MISSING, {"manifest": lambda told: told["episodes"].pop()}),
    "another track": (faults.RULES, {"manifest": lambda told: told.update(track="houses")}),
    "another agent": (faults.RULES, {"row": lambda row: row.update(agent="oracle")}),
    "another clock": (faults.RULES, {"row": lambda row: row.update(clock="wall")}),
    "a wait without a clock": (faults.RULES, {"row": lambda row: row["decisions"][0].update(waited=30)}),
    "labels that are not allowed": (faults.RULES, {"row": lambda row: row.update(perception="noisy")}),
    "somebody's own weights": (faults.RULES, {"row": lambda row: row.update(perception="small:/etc/passwd")}),
}


@pytest.mark.parametrize("name", CHEATS)
def test_what_was_changed_afterwards_is_named(name: str, submission: bytes) -> None:
    kind, how = CHEATS[name]
    assert kind in kinds(changed(submission, **how)) and kind in KINDS


def test_an_episode_in_the_place_of_another_is_named(submission: bytes) -> None:
    """The better of two episodes is submitted twice, under both names."""
    twice = changed(submission, files=lambda files: {FIRST: files[SECOND], SECOND: files[SECOND]})
    found = faults_of(submission_of(twice, "it"), TRIAL)
    assert [f"{fault.kind}: {fault.what}" for fault in found if fault.kind == faults.REPEATED] == [
        f"{faults.REPEATED}: it holds {SECOND}"
    ]
    reseeded = changed(submission, lambda row: row.update(json.loads(submission_of(submission, "it").files[SECOND])))
    assert faults.REPEATED in kinds(reseeded)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
def test_a_truncated_file_is_named(share: float, submission: bytes, tmp_path: Path) -> None:
    path = tmp_path / "cut.zip"
    path.write_bytes(submission[: int(share * len(submission))])
    report = verify(path, TRIAL)
    assert [fault.kind for fault in report.faults] == [faults.DAMAGED] and not report.verified and not report.seen
    assert report.verdict == "not verified: damaged file"


def test_an_oracle_that_says_it_is_honest_is_named(episodes: list[EpisodeResult]) -> None:
    asked = [replace(result, agent="oracle") for result in episodes]
    assert kinds(honest(asked)) == [faults.CARD]
    assert kinds(honest(asked, replace(CARD, privileged=True))) == []


@pytest.mark.render
def test_what_only_a_simulation_shows_is_named(submission: bytes, episodes: list[EpisodeResult]) -> None:
    """Everything fits together in these records, hashes and scores too, so that nothing shows without a simulation."""
    record = episodes[0]
    played = again(record)
    assert compared(record, played) == ("exact", [])
    best = tuple(replace(fate, rescued=True, frame=90) for fate in record.targets)
    forged = (*record.links[:-1], Link(record.frames, "f" * 64))
    short = replace(record, links=record.links[:-1], frames=record.links[-2].frame, decisions=record.decisions[:-1])
    swapped = replace(record.decisions[0], ok=not record.decisions[0].ok)
    for cheat, kind in (
        (replace(record, targets=best), faults.SCORE),
        (replace(record, links=forged), faults.HASH),
        (replace(short, ended="stopped"), faults.CUT),
        (replace(record, ended="time"), faults.CUT),
        (replace(record, decisions=(swapped, *record.decisions[1:])), faults.COURSE),
        (replace(record, decisions=(*record.decisions, record.decisions[0])), faults.COURSE),
    ):
        _, found = compared(cheat, played)
        assert [fault.kind for fault in found] == [kind]
    unknown = replace(record.decisions[1], verb="fly")
    _, found = compared(record, again(replace(record, decisions=(*record.decisions[:1], unknown))))
    assert found and found[0].kind in (faults.COURSE, faults.CUT)


@pytest.mark.render
def test_other_decisions_and_another_start_are_named(episodes: list[EpisodeResult]) -> None:
    """A record with a decision that was not taken, and one played with other physics that says it was not."""
    record = episodes[0]
    edited = replace(record, decisions=(replace(record.decisions[0], verb=EXPLORE),) * 2 + record.decisions[2:])
    _, found = compared(edited, again(edited))
    assert found and found[0].kind in (faults.COURSE, faults.HASH, faults.CUT)
    lied = replace(begun_episode(0, physics="realistic"), settings=record.settings)
    _, found = compared(lied, again(lied))
    assert [fault.kind for fault in found] == [faults.START]
    elsewhere = replace(begun_episode(0, scene="kitchen_b/07"), scene=record.scene)
    _, found = compared(elsewhere, again(elsewhere))
    assert [fault.kind for fault in found] == [faults.START]


def again(record: EpisodeResult) -> EpisodeResult | None:
    """The simulation of a record's decisions in the episode that the track asks for."""
    options = TRIAL.options((record.env_id, record.seed))
    assert episode_of(record).settings == options.settings
    return attempt(Job(options, SILENCE, tuple((d.verb, d.target) for d in record.decisions)), ignore).result


def test_decisions_of_another_submission_are_named() -> None:
    """They simulate perfectly, so only a comparison shows it; the same authors may submit what they had."""
    places = {("HazardFire-v1", seed): 0.5 for seed in range(10)}
    first, other = report_of("first", places, 1), report_of("other", places, 2)
    assert copied(other, [first]) == []
    theft = replace(first, submission="b" * 64, card=replace(CARD, name="mine", authors=("a thief",)))
    (fault,) = copied(theft, [other, first])
    assert fault.kind == faults.COPIED and "10 of 10 episodes are those of 'first'" in fault.what
    assert copied(replace(theft, card=first.card), [first]) == [] == copied(first, [first])
    padded = replace(theft, seen=tuple(replace(one, decisions="a" * 64) for one in theft.seen))
    assert [fault.kind for fault in copied(padded, [first])] == [faults.COPIED]  # with decisions that change nothing
    half = replace(theft, seen=(*theft.seen[:5], *other.seen[5:]))
    assert copied(half, [first]) == []


def test_every_kind_is_described_in_the_docs() -> None:
    text = (Path(__file__).parents[3] / "docs/leaderboard.md").read_text()
    assert [kind for kind in KINDS if f"`{kind}`" not in text] == []


def test_the_agent_of_a_stranger_is_never_made(submission: bytes) -> None:
    """Its name is only compared: the simulation asks one of ours that is privileged, or nobody."""
    from hazard_ms.evaluation.submissions.simulating import _asked

    assert _asked(SHORT) == _asked("greedy:weights=/etc/passwd") == _asked("llm:url=http://a") == "random"
    assert _asked("oracle:known=/etc/passwd") == "oracle"


def test_ssh_keygen_is_here() -> None:
    assert shutil.which("ssh-keygen"), "tests of signatures need openssh-client"
