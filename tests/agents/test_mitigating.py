"""The oracle does something about a fire among books that burn before they could all be carried off."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.agents.base import agent
from hazard_ms.agents.mitigating import prospects
from hazard_ms.agents.mitigating.choice import Chooser
from hazard_ms.evaluation.runner import Runner
from hazard_ms.simulation.building import make_world
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.recording import ahead
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.skills.decision import Action
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.registering import registered_task

TASK = "HazardShelves-v1"
FIRE = (5.0, 4.0)
RING = [(FIRE[0] + 0.55 * math.cos(a), FIRE[1] + 0.55 * math.sin(a)) for a in np.arange(7) * 2.0 * np.pi / 7]
ROOM = SceneSpec(
    name="test/shelves",
    room=Room((8.0, 8.0)),
    fixtures=(),
    bodies=(
        Body("powder_0", "fire_extinguisher", "plain_box", (2.0, 5.0, 0.0), scale=(0.12, 0.12, 0.4), mass=3.3),
        *(
            Body(f"book_{k}", "book", "plain_box", (x, y, 0.0), scale=(0.12, 0.12, 0.2), mass=0.4)
            for k, (x, y) in enumerate(RING)
        ),
    ),
    target_categories=("book",),
    fires=(FIRE,),
    agent_start=AgentStart((2.0, 4.0), 0.0),
)
DOORS = Room(
    (6.0, 4.0),
    openings=(
        Opening("door", "middle", 2.0, 0.9, 2.0, open=1.0),
        Opening("doorway", "far", 2.0, 0.9, 2.0),
        Opening("door", "west", 2.0, 0.9, 2.0),
    ),
    partitions=(Partition("middle", "y", 3.0), Partition("far", "y", 4.5)),
)


def shelves(physics: str) -> Task:
    task = dataclasses.replace(hazard_fire(physics), mitigations=("extinguish",), averted=True)
    return dataclasses.replace(task, scenes=lambda split: (ROOM.name,), build=lambda name: ROOM)


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    with registered_task(TASK, shelves, 1500):
        made = SkillEnv.make(TASK, sensor_configs={"width": 128, "height": 128}, effects="off")
        yield made
        made.close()


def played(env: SkillEnv, who: str) -> tuple[list[tuple[str, str | None]], int]:
    """What was done with success, and how many books are damaged at the end."""
    run = Runner(env, agent(who)).run(0)
    books = [env.base.world.index(0, f"book_{k}") for k in range(len(RING))]
    episode = env.base.episode
    lost = np.where(episode.rescue.safe[0, books], episode.rescue.damaged[0, books], episode.damage.damaged[0, books])
    return [(d.verb, d.target) for d in run.decisions if d.ok], int(lost.sum())


@pytest.mark.render
def test_the_oracle_puts_out_what_would_burn_more_than_it_can_carry_off(env: SkillEnv) -> None:
    done, lost = played(env, "oracle")
    without, burnt = played(env, "oracle:mitigate=false")
    verbs = [verb for verb, _ in done]
    assert ("pick_up", "powder_0") in done and "extinguish" in verbs
    assert "extinguish" not in {verb for verb, _ in without}
    assert lost < burnt


@pytest.mark.render
def test_after_a_fight_it_plans_with_the_future_without_that_fire(
    env: SkillEnv, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whenever it weighs measures, books are to burn when they will if nobody acts from then on."""
    weighed: list[tuple[int, bool]] = []
    course = Chooser.course

    def spied(self: Chooser, problem: Problem, targets: Sequence[int], *rest: Any) -> Any:
        if env.decision().last_action == Action("drop") or not weighed:
            will = ahead(env.base).whole_until()[list(targets)]
            weighed.append((env.frame, np.allclose(problem.damaged_at, will)))
        return course(self, problem, targets, *rest)

    monkeypatch.setattr(Chooser, "course", spied)
    done, _ = played(env, "oracle")
    last = max(k for k, (verb, _) in enumerate(done) if verb == "extinguish")
    assert done[last + 1][0] == "drop"
    assert weighed[0] == (0, True) and len(weighed) > 1 and weighed[1][1]


def test_a_fire_is_fought_from_where_the_jet_gets_to_it_and_the_nearest_first() -> None:
    """East of a wall at x = 3 m with a doorway from y = 1.55 to 2.45 m; who comes from the west looks through it."""
    tool = dataclasses.replace(ROOM.bodies[0], position=(0.5, 0.5, 0.0))
    spec = dataclasses.replace(ROOM, room=DOORS, bodies=(tool,), fires=(), agent_start=AgentStart((1.0, 2.0)))
    world, ways = make_world((spec,), torch.device("cpu")), Ways(spec)
    start = np.array([1.0, 2.0])
    behind = prospects.Seat(0, np.array([3.4, 0.5]), 1)  # beside the wall: within 3 m of the start, and hidden
    ahead_of = prospects.Seat(1, np.array([1.0, 3.5]), 1)
    home: Any = SimpleNamespace(world=world)
    far, near = (prospects.view_of(home, ways, seat, start) for seat in (behind, ahead_of))
    assert far is not None and near is not None
    x, y = far
    crosses = y + (0.5 - y) * (3.0 - x) / (3.4 - x)  # where the straight line to it meets the wall
    assert x > 3.0 or 1.55 < crosses < 2.45
    assert np.hypot(*(near - start)) <= 0.5  # it is in view at once, and walks end half a metre before a place
    fight = prospects.fight([behind, ahead_of], {0: far, 1: near}, ways, start)
    assert fight.numbers == (1, 0)
    np.testing.assert_allclose(fight.between, ways.frames(near, far))


def test_what_is_behind_a_door_is_closed_off_by_it() -> None:
    """From the west, both goals east of the door are closed off, and none beside the robot."""
    spec = dataclasses.replace(ROOM, room=DOORS, bodies=(), fires=(), agent_start=AgentStart((1.0, 2.0)))
    goals = np.array([[2.0, 3.0], [4.2, 2.0], [5.5, 2.0]])
    edges = np.zeros(3)
    assert prospects.closes(spec, 0, 0.29, (1.0, 2.0), goals, edges) == [1, 2]
    assert prospects.closes(spec, 0, 0.29, (5.0, 2.0), goals, edges) == [0]
    assert prospects.closes(spec, 2, 0.29, (1.0, 2.0), goals, edges) == []


def test_a_scene_has_its_doors_as_they_are_now() -> None:
    """Shares are those of doors; doorways have no leaf."""
    spec = dataclasses.replace(ROOM, room=DOORS, bodies=(), fires=())
    now = prospects.as_now(spec, [0.25, 1.0, 0.0], (1.5, 2.0))
    assert [o.share for o in now.room.openings] == [0.25, 1.0, 0.0]
    assert now.agent_start.position == (1.5, 2.0) and now.room.openings[1] == spec.room.openings[1]
