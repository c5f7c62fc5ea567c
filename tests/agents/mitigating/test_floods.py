"""The oracle shuts a door on water that would carry off more than it could rescue."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.oracle import Oracle
from hazard_ms.evaluation.runner import Runner
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec, Task
from hazard_ms.tasks.house import hazard_house_flood
from tests.worlds.registering import registered_task

TASK = "HazardTwoFloodedRooms-v1"
BOOKS = [(x, 0.6 + 0.6 * k, 0.0) for x in (5.2, 6.0) for k in range(7)]
HOME = SceneSpec(
    name="test/two_flooded_rooms",
    room=Room(
        (8.0, 5.0),
        openings=(
            Opening("door", "west", 2.5, 0.9, 2.0),
            Opening("door", "middle", 2.5, 0.9, 2.0, open=1.0),
        ),
        partitions=(Partition("middle", "y", 4.0),),
    ),
    fixtures=(),
    bodies=tuple(
        Body(f"book_{k}", "book", "plain_box", at, scale=(0.2, 0.15, 0.04), mass=1.5) for k, at in enumerate(BOOKS)
    ),
    target_categories=("book",),
    fires=(),
    flood_side="west",
    agent_start=AgentStart((2.5, 2.5), 0.0),
)


def home(physics: str) -> Task:
    return dataclasses.replace(hazard_house_flood(physics), scenes=lambda split: (HOME.name,), build=lambda name: HOME)


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    with registered_task(TASK, home, 1000):
        made = SkillEnv.make(TASK, sensor_configs={"width": 128, "height": 128}, effects="off")
        yield made
        made.close()


def played(env: SkillEnv, who: str) -> tuple[list[str], int]:
    """The verbs that worked, and how many books are damaged or were carried off at the end."""
    run = Runner(env, agent(who)).run(0)
    world, episode, lost = env.base.world, env.base.episode, 0
    for k, (x, y, _) in enumerate(BOOKS):
        b = world.index(0, f"book_{k}")
        if not bool(episode.rescue.safe[0, b]):
            off = float(world.position[0, b, :2].sub(world.position.new_tensor([x, y])).norm())
            lost += bool(episode.damage.damaged[0, b]) or off > 0.5
    return [d.verb for d in run.decisions if d.ok], lost


@pytest.mark.render
def test_the_oracle_shuts_water_out_that_would_reach_more_than_it_could_carry_off(env: SkillEnv) -> None:
    verbs, lost = played(env, "oracle")
    without, soaked = played(env, "oracle:mitigate=false")
    assert "shut" in verbs and "shut" not in without
    assert lost < soaked


@pytest.mark.render
def test_in_water_it_keeps_to_the_target_that_it_is_on_its_way_to(
    env: SkillEnv, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A detour of 150 frames past what drifts by does not make the target under way seem farther than before."""
    made = Oracle()
    decision, _ = env.reset(seed=0)
    made.attach(env)
    made.reset(env.brief())
    assert made._truth is not None
    plain = made._problem(decision, made._truth)[1]
    monkeypatch.setattr(made._truth, "detours", lambda decision, scene, targets: np.full(len(targets), 150.0))
    made._goal = "book_3"
    longer = made._problem(decision, made._truth)[1]
    assert plain is not None and longer is not None
    more = np.subtract(longer.pick, plain.pick)
    assert more[3] <= 0.0 and np.delete(more, 3).min() > 100.0
