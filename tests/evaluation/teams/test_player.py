"""Episodes of teams: what is recorded of each robot, and that they are simulated again from their records alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.hashes import extended
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.replay import DIFFERENT, EXACT, SAME_SCORE, compare, job_of
from hazard_ms.evaluation.result import ERROR, DecisionRecord, EpisodeResult, Link
from hazard_ms.evaluation.workers import Job, Word
from hazard_ms.skills.decision import DROP, EXPLORE, STOP, WALK_ONE_STEP
from hazard_ms.skills.team import TeamSkills

pytestmark = pytest.mark.render
PAIR = ("fetch", "fetch")
RAISES = """
from itertools import count
from hazard_ms import Agent
from hazard_ms.skills.decision import Action
NUMBERS = count()
class Raises(Agent):
    def reset(self, brief):
        self.left = ["explore", "drop"] if next(NUMBERS) % 2 else ["explore"] * 3
    def act(self, decision):
        return Action(self.left.pop()) if self.left else 1 / 0  # where the other one looks around
"""


def ignore(word: Word) -> None:
    """Nobody listens."""


def options_of(task: str, agent: str = "auction") -> EpisodeOptions:
    return EpisodeOptions(task, split="test", seed=2, robot_uids=PAIR, agent=agent, effects="off")


@pytest.fixture(scope="module", params=["HazardFire-v1", pytest.param("HazardWind-v1", marks=pytest.mark.long)])
def played(request: pytest.FixtureRequest) -> EpisodeResult:
    """An episode in which robot 0 looks around and stops, and robot 1 looks around, walks a step, and stops."""
    options = options_of(request.param)
    env = TeamSkills.make(options.env_id, PAIR, **{k: v for k, v in options.settings.items() if k != "robot_uids"})
    decisions, _ = env.reset(seed=options.seed)
    thing = next(a.target for a in decisions["fetch-1"].available if a.verb == WALK_ONE_STEP)
    env.close()
    taken = {
        "fetch-0": ((EXPLORE, None), (STOP, None)),
        "fetch-1": ((EXPLORE, None), (WALK_ONE_STEP, thing), (STOP, None)),
    }
    rows = [(robot, action) for robot, actions in taken.items() for action in actions]
    robots, actions = tuple(robot for robot, _ in rows), tuple(action for _, action in rows)
    outcome = attempt(Job(options, 60.0, actions, robots=robots), ignore)
    assert outcome.result is not None and not outcome.error
    return outcome.result


def test_decisions_are_recorded_with_their_robots_as_they_were_taken(played: EpisodeResult) -> None:
    verbs = {name: [d.verb for d in played.decisions if d.robot == name] for name in ("fetch-0", "fetch-1")}
    assert verbs == {"fetch-0": [EXPLORE, STOP], "fetch-1": [EXPLORE, WALK_ONE_STEP, STOP]}
    frames = [d.frame for d in played.decisions]
    assert frames == sorted(frames) and played.ended == "stopped" and played.robot_collisions == 0
    for name in verbs:
        own = [d for d in played.decisions if d.robot == name]
        assert own[0].frame == 0 and own[0].frames > 20
        assert all(after.frame == before.frame + before.frames for before, after in pairwise(own))
    assert played.decisions[-1].frame == played.frames == played.links[-1].frame


def test_an_episode_is_played_again_from_its_record_alone(played: EpisodeResult, tmp_path: Path) -> None:
    played.write(tmp_path / "one.json")
    read = EpisodeResult.read(tmp_path / "one.json")
    again = attempt(job_of(read), ignore).result
    assert again is not None and compare(read, again) == (EXACT, "") and again.decisions == read.decisions


def edited(played: EpisodeResult, which: DecisionRecord, **changes: object) -> EpisodeResult:
    rows = tuple(replace(d, **changes) if d is which else d for d in played.decisions)  # type: ignore[arg-type]
    return replace(played, decisions=rows)


def test_a_changed_decision_is_noticed(played: EpisodeResult) -> None:
    """One of robot 1 that was another, one that robot 0 is said to have taken, and one that is left out."""
    walk = next(d for d in played.decisions if d.verb == WALK_ONE_STEP)
    without = replace(played, decisions=tuple(d for d in played.decisions if d is not walk))
    for record in (edited(played, walk, verb=EXPLORE, target=None), edited(played, walk, robot="fetch-0"), without):
        verdict, why = compare(record, attempt(job_of(record), ignore).result)
        assert verdict in (SAME_SCORE, DIFFERENT) and ("differs from frame" in why or "the links do not say" in why)


def test_an_episode_that_failed_is_kept_to_its_last_decision_and_played_again(tmp_path: Path) -> None:
    """One robot drops nothing, looks around, and raises an error a frame after the other looks around once more."""
    (tmp_path / "own.py").write_text(RAISES)
    record = attempt(Job(options_of("HazardFire-v1", f"independent:{tmp_path}/own.py:Raises"), 60.0), ignore).result
    assert record is not None and record.ended == ERROR and "ZeroDivisionError" in record.error
    last = {d.robot: (d.verb, d.reason, d.frame + d.frames) for d in record.decisions}
    assert sorted(last.values()) == [(EXPLORE, "", record.frames), (EXPLORE, "episode_over", record.frames)]
    assert [d.frames for d in record.decisions if d.verb == DROP or d.reason == "episode_over"] == [1, 1]
    again = attempt(job_of(record), ignore).result
    assert again is not None and compare(record, again) == (EXACT, "")


@pytest.fixture(scope="module")
def pair() -> Iterator[TeamSkills]:
    made = TeamSkills.make("HazardFire-v1", PAIR, effects="off")
    yield made
    made.close()


@pytest.mark.parametrize("number", [0, 1])
def test_links_differ_where_any_robot_does(pair: TeamSkills, number: int) -> None:
    """By a joint of one robot alone, moved by 0.01 rad."""
    pair.reset(seed=1)
    links: list[list[Link]] = [[], [], []]
    for k in range(3):
        extended(links[k], pair)
        robot = list(pair.base.robots.values())[number].robot
        joints = robot.get_qpos().clone()
        joints[0, 5] += 0.01 * (k == 1)
        if k:
            robot.set_qpos(joints)
    assert links[0] == links[1] != links[2]
