"""The agent that fights fires first, in a room in which a box burns between an extinguisher and a target."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.evaluation.runner import Runner, fates
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.registering import registered_task

pytestmark = pytest.mark.render
TASK = "HazardFight-v1"
ROOM = SceneSpec(
    name="test/fight",
    room=Room((8.0, 8.0)),
    fixtures=(),
    bodies=(
        Body("powder_0", "fire_extinguisher", "plain_box", (3.0, 4.6, 0.0), scale=(0.12, 0.12, 0.4), mass=3.3),
        Body("box_0", "box", "plain_box", (6.0, 4.0, 0.0), scale=(0.4, 0.4, 0.4), mass=3.0),
        Body("book_0", "book", "plain_box", (4.0, 6.5, 0.0), scale=(0.15, 0.15, 0.2), mass=0.4),
    ),
    target_categories=("book",),
    fires=((7.6, 0.4),),
    agent_start=AgentStart((2.0, 4.0), 0.0),
)


def fight(physics: str) -> Task:
    task = dataclasses.replace(hazard_fire(physics), mitigations=("extinguish",))
    return dataclasses.replace(task, scenes=lambda split: (ROOM.name,), build=lambda name: ROOM)


class Arsonist(Watcher):
    """Sets the box on fire as the episode begins."""

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        state, b = env.base.episode.states["fire"], env.base.world.index(0, "box_0")
        state.status[0, b], state.temperature[0, b] = BURNING, 600.0


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    with registered_task(TASK, fight, 1500):
        made = SkillEnv.make(TASK, effects="off")
        yield made
        made.close()


def played(env: SkillEnv, who: str) -> tuple[list[tuple[str, str | None]], bool]:
    """What was done with success, and whether the box burns or is burnt at the end."""
    run = Runner(env, agent(who), [Arsonist()]).run(0)
    box = env.base.world.index(0, "box_0")
    assert all(fate.rescued for fate in fates(env))
    done = [(d.verb, d.target) for d in run.decisions if d.ok]
    return done, int(env.base.episode.states["fire"].status[0, box]) != 0


def test_it_puts_out_what_burns_and_then_rescues(env: SkillEnv) -> None:
    done, burnt = played(env, "fighter")
    order = [done.index(one) for one in (("pick_up", "powder_0"), ("extinguish", "box_0"), ("pick_up", "book_0"))]
    assert order == sorted(order) and not burnt


def test_what_it_fights_burns_without_it_and_a_fire_too_large_is_left_alone(env: SkillEnv) -> None:
    for who in ("greedy", "fighter:large=1"):
        done, burnt = played(env, who)
        assert burnt and "extinguish" not in {verb for verb, _ in done}
