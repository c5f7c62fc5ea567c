"""Numbers of the goal in `info`, from situations that are made by hand (docs/benchmark.md 4 and 5)."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from hazard_ms.tasks.episode import rewards
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.situation import Situation
from tests.worlds.fire_worlds import room_world

THINGS = [("book", (2.0, 2.0, 0.0)), ("apple", (3.0, 2.0, 0.0)), ("laptop", (1.0, 1.0, 0.0))]  # worth 5, 1 and 5


def situation(targets: list[bool]) -> Situation:
    world = room_world(THINGS)
    world.target[0] = torch.tensor(targets)
    nobody: Any = None  # no number of the goal asks for the agent
    return Situation(Episode(world, ()), nobody)


def rescue(now: Situation, index: int, damaged: bool = False) -> None:
    world, episode = now.world, now.episode
    one = torch.arange(len(THINGS)) == index
    if damaged:
        episode.damage.add(one[None], world)
    episode.rescue.mark(world, one[None], episode.damage)


def test_value_is_the_share_of_all_targets_and_damaged_ones_count_half() -> None:
    now = situation([True, True, False])
    assert float(rewards.rescued_value(now)) == 0.0
    rescue(now, 1)
    assert float(rewards.rescued_value(now)) == pytest.approx(1 / 6)
    rescue(now, 0, damaged=True)
    assert float(rewards.rescued_value(now)) == pytest.approx(3.5 / 6)


def test_what_is_no_target_has_no_value() -> None:
    now = situation([True, True, False])
    rescue(now, 2)
    assert float(rewards.rescued_value(now)) == 0.0
    for index in (0, 1):
        rescue(now, index)
    assert float(rewards.rescued_value(now)) == pytest.approx(1.0)


def test_all_are_rescued_when_every_target_is_and_there_is_one() -> None:
    now = situation([True, True, False])
    rescue(now, 0)
    assert not bool(rewards.all_rescued(now))
    rescue(now, 1, damaged=True)
    assert bool(rewards.all_rescued(now))
    assert not bool(rewards.all_rescued(situation([False, False, False])))


def test_damaged_targets_are_counted_until_they_are_safe() -> None:
    now = situation([True, True, False])
    now.episode.damage.add(torch.tensor([[True, False, True]]), now.world)
    assert int(rewards.damaged_targets(now)) == 1
    rescue(now, 0)
    assert int(rewards.damaged_targets(now)) == 0


def test_numbers_of_earlier_frames_stay() -> None:
    now = situation([True, True, True])
    functions = (rewards.rescued, rewards.rescued_value, rewards.all_rescued, rewards.rescued_now)
    before = [of(now) for of in functions]
    now.world.safe[:] = True
    after = [float(of(now)) for of in functions]
    assert [float(number) for number in before] == [0.0] * 4 and after == [3.0, 1.0, 1.0, 0.0]
