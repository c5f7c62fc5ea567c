"""The oracle: what it alone is told, how it plays a small room, and that it stays below its bound."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import Agent, PrivilegedAgent, agent
from hazard_ms.agents.truth import Truth
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.runner import Runner, fates
from hazard_ms.sketch.bound import bound
from hazard_ms.sketch.recording import recorded
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill
from hazard_ms.skills.decision import EXPLORE, PICK_UP, STOP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import UNREACHABLE
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.spec.registry import AGENTS, load
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.playground import brief
from tests.worlds.registering import registered_task

TASK = "HazardHide-v1"
SMALL = {"sensor_configs": {"width": 64, "height": 64}, "effects": "off"}
BURNING = (3.0, 4.6)  # the fire is here [m]


def thing(name: str, x: float, y: float) -> Body:
    return Body(name, "box", "plain_box", (x, y, 0.0), scale=(0.15, 0.15, 0.15), mass=0.4)


HIDE = SceneSpec(  # one box in front of the robot, one behind it, one beside the fire
    name="test/hide",
    room=Room((6.0, 5.0)),
    fixtures=(),
    bodies=(thing("ahead", 4.5, 2.0), thing("behind", 1.2, 2.0), thing("hot", BURNING[0] + 0.3, BURNING[1])),
    target_categories=("box",),
    fires=(BURNING,),
    agent_start=AgentStart((3.0, 2.0)),
)


def hide(physics: str) -> Task:
    return dataclasses.replace(hazard_fire(physics), scenes=lambda split: (HIDE.name,), build=lambda name: HIDE)


class Peeks(PrivilegedAgent):
    """Notes in which order it is called."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def attach(self, env: SkillEnv) -> None:
        self.told.append(f"attach at {env.frame}")

    def reset(self, brief: Brief) -> None:
        self.told.append("reset")

    def act(self, decision: Decision) -> Action:
        return Action(STOP)


class Honest(Agent):
    """Would take an environment, if it got one."""

    attached = False

    def attach(self, env: SkillEnv) -> None:
        self.attached = True

    def reset(self, brief: Brief) -> None:
        return

    def act(self, decision: Decision) -> Action:
        return Action(STOP)


@pytest.fixture(scope="module")
def room() -> Iterator[SkillEnv]:
    with registered_task(TASK, hide):
        env = SkillEnv.make(TASK, **SMALL)
        yield env
        env.close()


def test_the_oracle_alone_of_all_registered_agents_is_privileged() -> None:
    assert {name for name in AGENTS if load(AGENTS[name].agent).privileged} == {"oracle"}


def test_the_oracle_does_not_play_without_an_environment() -> None:
    with pytest.raises(ValueError, match="an environment must be attached to the oracle"):
        agent("oracle").reset(brief())


@pytest.mark.render
def test_only_privileged_agents_get_the_environment_once_the_episode_has_begun(room: SkillEnv) -> None:
    peeks, honest = Peeks(), Honest()
    for player in (peeks, honest):
        assert Runner(room, player).run(0).ended == "stopped"
    assert peeks.told == ["attach at 0", "reset"] and not honest.attached


@pytest.mark.render
def test_the_map_is_told_where_things_really_are(room: SkillEnv) -> None:
    room.reset(seed=0)
    world = room.base.world
    behind = world.index(0, "behind")
    assert behind not in room.seen.objects
    Truth(room, only_known=True).reveal()
    assert behind not in room.seen.objects
    truth = Truth(room, only_known=False)
    room.stage.look()
    assert room.seen.objects[behind].position == pytest.approx(world.position[0, behind].numpy())
    truth.aim = {behind: np.array([2.0, 2.0, 0.1], np.float32)}
    room.stage.look()
    assert room.seen.objects[behind].position.tolist() == pytest.approx([2.0, 2.0, 0.1])
    world.safe[0, behind] = True
    room.seen.forget(behind)
    truth.reveal()
    assert behind not in room.seen.objects
    world.safe[0, behind] = False


@pytest.mark.render
def test_the_future_is_told_anew_when_it_comes_otherwise(room: SkillEnv) -> None:
    room.reset(seed=0)
    world, truth = room.base.world, Truth(room, only_known=False)
    first = truth.future()
    assert truth.future() is first and first.damaged_at[world.index(0, "hot")] > 0
    world.position[0, world.index(0, "ahead"), 0] += 0.3
    second = truth.future()
    assert second is not first and truth.future() is second
    room.base.episode.damage.damaged[0, world.index(0, "ahead")] = True
    room.base.episode.damage.frame[0, world.index(0, "ahead")] = 0
    third = truth.future()
    assert third is not second and third.damaged_at[world.index(0, "ahead")] == 0
    world.safe[0, world.index(0, "hot")] = True
    assert truth.future() is not third
    world.safe[0, world.index(0, "hot")] = False


@pytest.mark.render
@pytest.mark.parametrize("known", [pytest.param(False, marks=pytest.mark.long), True])
def test_everything_in_a_small_room_is_rescued(known: bool, room: SkillEnv) -> None:
    """Without a look around by the oracle, which needs none, and with one where it must know first."""
    played = Runner(room, agent(f"oracle:known={known}")).run(0)
    assert played.ended == "all rescued" and all(fate.rescued for fate in fates(room))
    looked = [record.verb for record in played.decisions].count(EXPLORE)
    assert looked == (1 if known else 0)


@pytest.mark.render
def test_what_fails_at_once_is_not_tried_again_from_there(room: SkillEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is tried again when the robot has been elsewhere; nothing is left to do after that."""
    oracle, run, verbs = agent("oracle"), room.run, list[tuple[str, str | None]]()
    act = oracle.act

    def noted(decision: Decision) -> Action:
        action = act(decision)
        verbs.append((action.verb, action.target))
        return action

    def failing(doing: Skill) -> Result:
        if verbs[-1] != (PICK_UP, "ahead"):
            return run(doing)
        doing.close()
        return Result(False, UNREACHABLE)

    monkeypatch.setattr(oracle, "act", noted)
    monkeypatch.setattr(room, "run", failing)
    Runner(room, oracle).run(0)
    tries = [k for k, verb in enumerate(verbs) if verb == (PICK_UP, "ahead")]
    others = [k for k, verb in enumerate(verbs) if verb[0] == PICK_UP and verb[1] != "ahead"]
    assert len(others) == 2 and len(tries) == 2 and tries[0] < min(others) and max(others) < tries[1]
    assert verbs[-1] == (STOP, None)


@pytest.mark.render
def test_what_no_plan_saves_in_time_is_tried_all_the_same() -> None:
    """In less time than the shortest rescue is expected to take, which it may beat, the oracle does not give up."""
    with registered_task("HazardHurry-v1", hide) as name:
        env = SkillEnv.make(name, max_episode_steps=70, **SMALL)
        try:
            played = Runner(env, agent("oracle")).run(0)
        finally:
            env.close()
    assert [record.verb for record in played.decisions][:1] == [WALK_TO] and played.ended == "time"
    assert played.decisions[0].note == "too late by any plan, but the nearest"


def value(env: SkillEnv, name: str, seed: int) -> float:
    Runner(env, agent(name)).run(seed)
    return Tally.of(fates(env)).value


@pytest.mark.long
@pytest.mark.render
def test_the_oracle_beats_greedy_and_stays_below_its_bound() -> None:
    env = SkillEnv.make("HazardFire-v1", split="test", effects="off")
    try:
        scores: dict[str, list[Any]] = {"oracle": [], "greedy": [], "bound": []}
        for seed in (1, 2):
            for name in ("oracle", "greedy"):
                scores[name].append(value(env, name, seed))
            base = env.base
            spec = base.specs[0]
            worth = [fate.value for fate in fates(env)]
            line = recorded(base.task, "paper", spec, seed)
            scores["bound"].append(bound(line, spec, base.agent.build, worth, env.max_frames))
        assert sum(scores["oracle"]) > sum(scores["greedy"])
        for name in ("oracle", "greedy"):
            assert all(v <= b + 1e-6 for v, b in zip(scores[name], scores["bound"], strict=True)), scores
    finally:
        env.close()
