"""`hazard-ms replay`: a record of an episode is enough to play it again, and what differs is told."""

from __future__ import annotations

import dataclasses
import re
from importlib.metadata import version
from pathlib import Path

import pytest

from hazard_ms.evaluation.attempts import Recorded, attempt
from hazard_ms.evaluation.hashes import EVERY
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.replay import DIFFERENT, EXACT, SAME_SCORE, compare, episode_of, job_of, other_versions
from hazard_ms.evaluation.result import EpisodeResult, Link
from hazard_ms.evaluation.workers import Job, Word
from hazard_ms.skills.decision import EXPLORE, STOP, WALK_ONE_STEP, Action, Decision
from tests.worlds.results import result_of

EPISODES = (
    EpisodeOptions(seed=3, scene="kitchen_b/00", lighting="night", effects="off"),
    EpisodeOptions("HazardCompound-v1", hazards=("fire", "wind"), robot_uids="g1", scene="kitchen_b/00"),
    EpisodeOptions(affects_agent=True, physics="realistic", scene="my scenes/room-3.json"),
)
LINKS = tuple(Link(frame, f"{frame:064x}") for frame in (0, 50, 100))
OWN = "open({mark!r}, 'w').close()\nfrom hazard_ms.agents.random import Random as Mine\n"


@pytest.mark.parametrize("episode", EPISODES, ids=lambda e: e.command)
def test_a_result_says_which_episode_it_is_of(episode: EpisodeOptions) -> None:
    again = episode_of(result_of(episode))
    assert (again.settings, again.reset_options, again.seed) == (episode.settings, episode.reset_options, episode.seed)


def test_settings_that_no_episode_has_are_refused() -> None:
    record = dataclasses.replace(result_of(EPISODES[0]), settings={"split": "test", "gravity": 3.7})
    with pytest.raises(ValueError, match="settings must be those of an episode, got .*gravity"):
        episode_of(record)


def test_what_differs_is_told() -> None:
    record = dataclasses.replace(result_of(EPISODES[0]), links=LINKS)
    assert compare(record, record) == (EXACT, "")
    other = dataclasses.replace(record, links=(LINKS[0], Link(50, "f" * 64), Link(100, "e" * 64)))
    assert compare(record, other) == (SAME_SCORE, ", differs from frame 50 of 1500 on")
    shorter = dataclasses.replace(record, links=LINKS[:2])
    verdict, why = compare(record, shorter)
    assert verdict == SAME_SCORE and "2 instead of 3" in why
    better = dataclasses.replace(result_of(EPISODES[0], saved=True), links=other.links)
    verdict, why = compare(record, better)
    assert verdict == DIFFERENT and "from frame 50" in why and "0.0 % of the value in the file, 50.0 % now" in why
    assert compare(record, None, "ValueError: no") == (DIFFERENT, ", it could not be played: ValueError: no")


def test_an_episode_that_failed_counts_as_replayed_only_if_it_failed_alike() -> None:
    record = dataclasses.replace(result_of(EPISODES[0], ended="error"), error="KeyError: 'plan'")
    assert compare(record, record, "KeyError: 'plan'") == (EXACT, "")
    other = dataclasses.replace(record, error="ValueError: no")
    assert compare(record, other, "ValueError: no") == (DIFFERENT, ", it could not be played: ValueError: no")


def test_packages_of_other_versions_are_told() -> None:
    here = {"sapien": version("sapien"), "numpy": version("numpy")}
    assert other_versions(here) == "" == other_versions({})
    told = f"sapien 3.0.0, here {here['sapien']}; warp-drive 1, here absent"
    assert other_versions({**here, "sapien": "3.0.0", "warp-drive": "1"}) == told


def test_the_actions_of_a_record_are_taken_in_order_and_no_file_of_others_is_run(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(OWN.format(mark=str(tmp_path / "mark")))
    player = Recorded(((EXPLORE, None), (WALK_ONE_STEP, "pan_1")), f"{tmp_path}/own.py:Mine")
    assert not (tmp_path / "mark").exists()
    decision: Decision = None  # type: ignore[assignment]  # a record does not look at it
    wanted = [Action(EXPLORE), Action(WALK_ONE_STEP, "pan_1"), Action(STOP), Action(STOP)]
    assert [player.act(decision) for _ in wanted] == wanted


@pytest.mark.render
def test_an_episode_is_played_again_from_its_record_alone(tmp_path: Path) -> None:
    """What a process that died has left is replayed, too; a decision that was edited is found out."""
    episode = EpisodeOptions(split="test", seed=4, agent="tests.evaluation.test_play:Short")
    words: list[Word] = []
    whole = attempt(Job(episode, 60.0), words.append).result
    spoken = [word.so_far for word in words if word.so_far]
    assert [len(each.decisions) for each in spoken] == [0, 1, 2] and len(words) == 6
    assert whole is not None and [d.verb for d in whole.decisions] == [EXPLORE, WALK_ONE_STEP, STOP]
    for record in (whole, spoken[-1]):
        record.write(tmp_path / "one.json")
        read = EpisodeResult.read(tmp_path / "one.json")
        again = attempt(job_of(read), ignore).result
        assert again is not None and compare(read, again) == (EXACT, "")
        assert read.links[-1].frame == read.frames == again.frames > 50
    start, end = whole.decisions[1].frame, whole.frames
    edited = dataclasses.replace(
        whole, decisions=(whole.decisions[0], dataclasses.replace(whole.decisions[1], verb=EXPLORE, target=None))
    )
    verdict, why = compare(edited, attempt(job_of(edited), ignore).result)
    told = re.fullmatch(rf", differs from frame (\d+) of {end} on.*", why)
    assert verdict in (SAME_SCORE, DIFFERENT) and told and start < int(told[1]) <= start + EVERY


def ignore(word: Word) -> None:
    """Nobody listens."""
