"""The runner: what it tells its watchers, in which order, and how it ends a run at a frame."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import groupby
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import Agent
from hazard_ms.evaluation import runner
from hazard_ms.evaluation.hashes import extended
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import Link
from hazard_ms.evaluation.runner import FRAME_REACHED, Runner, environment
from hazard_ms.evaluation.watchers import Progress, Watcher
from hazard_ms.skills.brief import Brief, random_seed
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, EXPLORE, STOP, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv

pytestmark = pytest.mark.render
SEED = 4


class Looker(Agent):
    """Looks around twice and stops."""

    def reset(self, brief: Brief) -> None:
        self.brief, self.left = brief, [STOP, EXPLORE, EXPLORE]

    def act(self, decision: Decision) -> Action:
        self.note = "why"
        return Action(self.left.pop())


class Quits(Looker):
    """Ends the process in its second decision."""

    def act(self, decision: Decision) -> Action:
        return super().act(decision) if len(self.left) > 2 else sys.exit(0)


class Idle(Looker):
    """Drops what it does not hold; looks around after every so many decisions, and stops at the 18th."""

    def __init__(self, every: int | None) -> None:
        self._every, self._made = every, 0

    def act(self, decision: Decision) -> Action:
        self._made += 1
        if self._every is None or self._made % self._every:
            return Action(DROP)
        return Action(STOP if self._made >= 18 else EXPLORE)


class Turns(Looker):
    """Moves by itself when it looks around: it turns for seven frames and is done."""

    def skill(self, stage: Stage, action: Action) -> Skill:
        return self.turning(stage) if action.verb == EXPLORE else super().skill(stage, action)

    def turning(self, stage: Stage) -> Skill:
        for _ in range(7):
            yield stage.act(turn=0.02)
        return Result(True, frames=7)


class Talks(Looker):
    """Stops at once, with a note of which only a part can be shown."""

    def act(self, decision: Decision) -> Action:
        self.note = "a\n\x1b[31m\ud800\u202e b" + "x" * 3_000_000
        return Action(STOP)


class Witness(Watcher):
    """Writes down what it is told."""

    def __init__(self) -> None:
        self.told: list[tuple[str, Any]] = []

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        self.told.append(("begin", decision.frame))

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        self.told.append(("decided", (str(action), note)))

    def frame(self, action: np.ndarray) -> None:
        self.told.append(("frame", action.shape))

    def ended(self, result: Result) -> None:
        self.told.append(("ended", result.frames))

    def finish(self, reason: str) -> None:
        self.told.append(("finish", reason))


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    camera = {"width": 64, "height": 64}
    made = SkillEnv(gym.make("HazardFire-v1", obs_mode="none", control_mode="pd_joint_pos", sensor_configs=camera))
    yield made
    made.close()


def test_watchers_are_told_everything_in_order(env: SkillEnv) -> None:
    first, second = Witness(), Witness()
    played = Runner(env, Looker(), [first, second, Progress("looker"), Watcher()]).run(SEED)
    kinds = [(kind, len(list(group))) for kind, group in groupby(kind for kind, _ in first.told)]
    frames = [d.frames for d in played.decisions]
    look = [("decided", 1), ("frame", frames[0]), ("ended", 1), ("decided", 1), ("frame", frames[1]), ("ended", 1)]
    assert kinds == [("begin", 1), *look, ("decided", 1), ("ended", 1), ("finish", 1)]
    assert first.told == second.told and first.told[-1] == ("finish", "stopped") and played.ended == "stopped"
    assert ("decided", ("explore", "why")) in first.told and sum(frames) == env.frame


@pytest.mark.parametrize("frame", [0, *(pytest.param(frame, marks=pytest.mark.long) for frame in (1, 25)), 70])
def test_a_run_ends_at_the_frame_that_was_asked_for(env: SkillEnv, frame: int) -> None:
    """Before the first decision, in the midst of the first (60 frames) and of the second one."""
    witness = Witness()
    played = Runner(env, Looker(), [witness]).run(SEED, until_frame=frame)
    assert env.frame == frame and played.ended == FRAME_REACHED and witness.told[-1] == ("finish", FRAME_REACHED)
    assert sum(kind == "frame" for kind, _ in witness.told) == frame
    assert Runner(env, Looker()).run(SEED).ended == "stopped", "the next run is not cut short"


@pytest.mark.parametrize("every", [None, pytest.param(9, marks=pytest.mark.long)])
def test_an_episode_in_which_no_time_passes_ends(
    env: SkillEnv, every: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An agent that drops nothing for ever ends like this; one that looks around in between goes on."""
    assert runner.MOST_IDLE == 100
    monkeypatch.setattr(runner, "MOST_IDLE", 10)
    played = Runner(env, Idle(every)).run(SEED)
    if every is None:
        assert (played.ended, len(played.decisions)) == ("too many decisions", 10)
        assert all(d.frames == 0 for d in played.decisions)
    else:
        assert (played.ended, len(played.decisions)) == ("stopped", 18)


def test_an_agent_may_move_by_itself(env: SkillEnv) -> None:
    """And the next agent in the same environment is played by the benchmark's skills."""
    witness = Witness()
    played = Runner(env, Turns(), [witness]).run(SEED)
    assert [(d.verb, d.ok, d.frames) for d in played.decisions[:2]] == [(EXPLORE, True, 7)] * 2
    assert sum(kind == "frame" for kind, _ in witness.told) == env.frame == 14
    assert Runner(env, Looker()).run(SEED).decisions[0].frames > 40


def test_an_agent_cannot_end_the_process(env: SkillEnv) -> None:
    with pytest.raises(RuntimeError, match=r"act of the agent must return or raise an error, got sys.exit\(0\)"):
        Runner(env, Quits()).run(SEED)


def test_watchers_and_records_get_the_note_that_can_be_shown(env: SkillEnv) -> None:
    witness = Witness()
    played = Runner(env, Talks(), [witness]).run(SEED)
    note = played.decisions[0].note
    assert witness.told[1] == ("decided", ("stop", note)) and len(note) == 2000
    assert note.startswith("a  [31m   bxxx") and note.endswith("xx…") and note.isprintable()


def test_the_agent_is_told_what_the_paper_tells_it(env: SkillEnv) -> None:
    player = Looker()
    Runner(env, player).run(SEED)
    told, world = player.brief, env.base.world
    assert (told.task, told.robot, told.safe_place, told.max_frames) == ("HazardFire-v1", "fetch", "bag", 1500)
    assert told.frame_seconds == pytest.approx(1 / 30) and told.random_seed == random_seed(SEED)
    assert [t.name for t in told.targets] == [n for n, t in zip(world.names[0], world.target[0], strict=False) if t]
    assert [(h.name, h.title, h.unit) for h in told.hazards] == [("fire", "temperature", "°C")] and "bag" in told.text
    scene = env.base.specs[0].name
    assert scene not in repr(told) and scene.partition("/")[0] not in repr(told)


def test_the_map_of_a_decision_is_a_copy(env: SkillEnv) -> None:
    decision, _ = env.reset(seed=SEED)
    before = decision.map.explored.copy()
    with pytest.raises(ValueError, match="read-only"):
        decision.map.explored[:] = True
    later, *_ = env.step(Action(EXPLORE))
    assert (decision.map.explored == before).all() and later.map.explored.sum() > before.sum()
    assert (env.seen.explored == later.map.explored).all()


def test_links_differ_where_anything_differs(env: SkillEnv) -> None:
    """What differs by less than the grain is the same; and so is everything after a second reset."""
    env.reset(seed=SEED)
    base, world = env.base, env.base.world
    before = linked(env)
    assert before == linked(env) and extended_by(before, env) == before, "one link for a frame"
    world.position[0, 0, 2] = 0.5
    moved = linked(env)
    world.position[0, 0, 2] += 1e-5
    assert linked(env) == moved != before
    world.position[0, 0, 2] += 1e-3
    assert linked(env) != moved
    env.reset(seed=SEED)
    assert linked(env) == before, "hashes repeat"
    base.episode.damage.damaged[0, 0] = True
    damaged = linked(env)
    base.episode.states["fire"].temperature[0, 0] += 1.0
    assert before != damaged != linked(env)
    after = [extended_by([Link(50, start)], env)[-1] for start in ("a", "b")]
    assert after[0].frame == 0 and after[0] != after[1], "a link holds those before it"


def linked(env: SkillEnv) -> list[Link]:
    """A chain of one link."""
    return extended_by([], env)


def extended_by(links: list[Link], env: SkillEnv) -> list[Link]:
    made = list(links)
    extended(made, env)
    return made


def test_episodes_compute_no_rewards_unless_somebody_asks_for_them() -> None:
    """They are a tenth to a fifth of a frame, and results hold none; demonstrations do."""
    for asked, mode in ({}, "none"), ({"reward_mode": "dense"}, "dense"):
        made = environment(EpisodeOptions(), **asked)
        assert made.base.reward_mode == mode
        made.close()
