"""Practice of many robots in one batch, without a simulator, which would need a GPU: each is as it would be alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import torch
from torch import Tensor

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.simulation.building import make_world
from hazard_ms.simulation.mitigation.door_grip import DoorGrip
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.situation import Situation
from tests.worlds.registering import practising

ROOMS, SEEDS = ("practice/0", "practice/3", "practice/5"), (11, 12, 13)


class Robots:
    """Where robots were put, with hands ahead of them that move with them."""

    def __init__(self, count: int) -> None:
        self.base, self.heading = torch.zeros(count, 2), torch.zeros(count)

    def place(self, rows: Tensor, position: Tensor, heading: Tensor) -> None:
        self.base[rows], self.heading[rows] = position, heading

    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        ahead = torch.stack([self.heading.cos(), self.heading.sin()], dim=-1)
        turn = torch.stack([(self.heading / 2).cos(), *[0 * self.heading] * 2, (self.heading / 2).sin()], dim=-1)
        return torch.cat([self.base + 0.3 * ahead, 0.6 + 0 * ahead[:, :1]], dim=-1), turn

    def base_velocity(self) -> Tensor:
        return 0.2 * torch.stack([self.heading.cos(), self.heading.sin()], dim=-1)


@pytest.fixture(scope="module")
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


def begun(practice: Any, name: str, numbers: list[int]) -> tuple[Any, Situation]:
    """The task made by the function `name`, and the beginning of episodes in the rooms of these numbers."""
    task = getattr(practice, name)()
    world = make_world(tuple(task.build(ROOMS[n]) for n in numbers), torch.device("cpu"))
    world.agent_build = HazardFetch.build
    if task.doors_by_hand:
        world.door_grip = DoorGrip(world.specs, world.openings)
    situation = Situation(Episode(world, (), task.safe_place), Robots(len(numbers)))  # type: ignore[arg-type]
    rows = torch.arange(len(numbers))
    situation.episode.begin(rows, torch.tensor([SEEDS[n] for n in numbers]))
    task.arrange(situation, rows)
    see(situation)
    return task, situation


def see(situation: Situation) -> None:
    agent: Any = situation.agent
    situation.world.agent_position[:, :2], situation.world.agent_heading[:] = agent.base, agent.heading


@pytest.mark.parametrize("name", ["walk_to", "pick_up", "open_door"])
def test_each_robot_starts_sees_and_is_paid_as_if_alone(practice: Any, name: str) -> None:
    task, together = begun(practice, name, [0, 1, 2])
    sizes = {len(names) for names in together.world.names}
    assert name != "pick_up" or len(sizes) > 1  # rooms have different numbers of things: some rows are padding
    for n in range(3):
        _, alone = begun(practice, name, [n])
        torch.testing.assert_close(together.agent.base[n], alone.agent.base[0])  # type: ignore[attr-defined]
        for read in (task.goal.dense, task.goal.success, *(term.of for term in task.observations)):
            assert len(read(together)) == 3
            torch.testing.assert_close(read(together)[n], read(alone)[0])


@pytest.mark.parametrize("name", ["walk_to", "pick_up", "open_door"])
def test_robots_whose_episodes_go_on_stay_where_they_are(practice: Any, name: str) -> None:
    task, situation = begun(practice, name, [0, 1, 2])
    agent: Any = situation.agent
    before, rows = agent.base.clone(), torch.tensor([1])
    situation.episode.begin(rows, torch.tensor([99]))
    task.arrange(situation, rows)
    assert torch.equal(agent.base[[0, 2]], before[[0, 2]]) and not torch.equal(agent.base[1], before[1])
