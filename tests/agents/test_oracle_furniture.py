"""The oracle is told where furniture and walls are; nobody else is, and what it is told is what looks would find."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.oracle import Oracle
from hazard_ms.evaluation.runner import Runner
from hazard_ms.scenes.boxes import turned
from hazard_ms.scenes.floor import boxes_of, partitions
from hazard_ms.sensing.furniture import told
from hazard_ms.sensing.semantic_map import LINTELS, SemanticMap
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire
from tests.worlds.registering import registered_task

TASK = "HazardFurnished-v1"
SMALL = {"sensor_configs": {"width": 64, "height": 64}, "effects": "off"}
ROOMS = Room(
    (6.05, 5.0), openings=(Opening("doorway", "middle", 2.5, 0.9, 2.0),), partitions=(Partition("middle", "y", 2.0),)
)
FURNISHED = SceneSpec(  # in a room that is no whole number of cells long: furniture behind the robot, and a wall
    name="test/furnished",
    room=ROOMS,
    fixtures=(
        Fixture("desk", "table", "plain_box", (3.2, 0.8, 0.0), turned(0.5), (0.9, 0.5, 0.8)),
        Fixture("chest", "table", "plain_box", (0.9, 3.1, 0.0), scale=(0.4, 0.7, 1.3)),
        Fixture("shelf", "table", "plain_box", (3.0, 4.5, 1.1), scale=(0.5, 0.3, 0.2)),
    ),
    bodies=(Body("hidden", "box", "plain_box", (1.4, 1.0, 0.0), scale=(0.15, 0.15, 0.15), mass=0.4),),
    target_categories=("box",),
    fires=((5.5, 0.5),),
    agent_start=AgentStart((4.2, 2.5)),
)


def furnished(physics: str) -> Task:
    return dataclasses.replace(
        hazard_fire(physics), scenes=lambda split: (FURNISHED.name,), build=lambda name: FURNISHED
    )


class Idle(Oracle):
    """Stops after its first decision, and keeps what was in the map before and then."""

    def act(self, decision: Decision) -> Action:
        assert self._truth is not None
        seen = self._truth.env.seen
        self.explored_before = seen.explored.copy()
        super().act(decision)
        self.height, self.explored = seen.height, seen.explored.copy()
        return Action(STOP)


@pytest.fixture(scope="module")
def room() -> Iterator[SkillEnv]:
    with registered_task(TASK, furnished):
        env = SkillEnv.make(TASK, **SMALL)
        yield env
        env.close()


def centres(seen: SemanticMap) -> NDArray[np.float64]:
    return seen.centre_of(*np.mgrid[: len(seen.explored), : len(seen.explored)])


@pytest.mark.render
@pytest.mark.parametrize("known", [False, True])
def test_the_furniture_is_in_the_map_before_the_first_skill(known: bool, room: SkillEnv) -> None:
    """Wherever a box covers a whole cell, its top; where nothing is within a cell, the floor."""
    player = Idle(known)
    Runner(room, player).run(0)
    x, y = np.moveaxis(centres(room.seen), -1, 0)
    size, corner = ROOMS.size, room.seen.cell / np.sqrt(2) + 1e-6
    inside = (x > 0.0) & (x < 6.0) & (y > 0.0) & (y < size[1])  # the last cell along x is half in the wall
    # the first look enters walls into the cells before them, too
    free = (x > 0.15) & (x < size[0] - 0.15) & (y > 0.15) & (y < size[1] - 0.15) & (np.hypot(x - 4.2, y - 2.5) > 0.5)
    for box in (*boxes_of(FURNISHED)[0], *partitions(ROOMS)):
        inner = dataclasses.replace(box, half_x=box.half_x - 0.05, half_y=box.half_y - 0.05)
        if min(inner.half_x, inner.half_y) > 0.05:
            top = player.height[inner.distance(x, y) == 0.0]
            assert len(top) > 4 and top == pytest.approx(min(box.high, LINTELS), abs=0.03)  # the last sample below
        free &= box.distance(x, y) > corner
    hidden = np.hypot(x - 1.4, y - 1.0) < 0.2
    assert free.sum() > 1000 and (player.height[free & ~hidden] < 0.02).all()
    ring = ~inside & (x > -0.1) & (x < 6.1) & (y > -0.1) & (y < size[1] + 0.1)
    assert (player.height[ring] > LINTELS - 0.1).all() and player.explored[ring].all()
    behind = free & (x < 1.8)
    assert player.explored[behind].all() if not known else not player.explored[behind].any()
    assert not player.explored_before[behind].any()  # recorders begin with the map of an honest agent
    assert known == (room.base.world.index(0, "hidden") not in room.seen.objects)


@pytest.mark.render
def test_the_map_of_another_agent_has_only_what_was_seen(room: SkillEnv) -> None:
    room.reset(seed=0)
    x, y = np.moveaxis(centres(room.seen), -1, 0)
    west = (x > 0.0) & (x < 1.8) & (y > 0.0) & (y < ROOMS.size[1])
    assert not room.seen.height[west].any() and not room.seen.explored[west].any()


@pytest.mark.render
def test_looks_in_a_real_room_find_nothing_higher_than_what_is_told() -> None:
    """Models of furniture are told as they are drawn: looks see parts of them, and nothing else that stays."""
    env = SkillEnv.make("HazardFire-v1", split="train", effects="off", reward_mode="none")
    try:
        env.reset(seed=0)
        spec = env.base.specs[0]
        height, within = told(env.seen, spec, env.base.actors[0][len(spec.bodies) :])
        env.step(Action(EXPLORE))
        seen = env.seen
        centre = centres(seen)
        inside = seen.explored & (centre > seen.cell).all(-1) & (centre < np.array(spec.room.size) - seen.cell).all(-1)
        fixed = inside & (seen.height > 0.1) & ~np.isin(seen.object_id, np.flatnonzero(seen.loose))
        assert within[inside].all() and fixed.sum() > 100
        assert (seen.height[fixed] <= height[fixed] + 0.02).mean() > 0.98
        assert (np.abs(seen.height - height)[fixed] < 0.05).mean() > 0.6  # most of what is seen is seen at its top
    finally:
        env.close()
