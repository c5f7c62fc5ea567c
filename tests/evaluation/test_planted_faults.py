"""What a planted fault costs is put down to that fault."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.causes import EXECUTION, PARTS, PLANNING, EpisodeRegret
from hazard_ms.sketch.skill_times import SkillTimes
from tests.evaluation.planted_faults import CLUMSY, NONE, RANDOM, SHOWN_IN, added, judged, measured, share
from tests.worlds.plaza import FRAMES, TASK, task
from tests.worlds.registering import registered_task

SEEDS = range(8)
LEAST = 0.8  # share of what a fault costs that must be put down to it
COSTLY = 0.04  # least loss that a fault must add, so that its share means something

Sound = tuple[list[EpisodeOptions], SkillTimes, list[EpisodeRegret]]


@pytest.fixture(scope="module")
def sound() -> Iterator[Sound]:
    """Episodes, the skill times there, and the regrets of the planner without a fault."""
    with registered_task(TASK, task, FRAMES):
        episodes = [EpisodeOptions(TASK, split="test", seed=seed) for seed in SEEDS]
        times = measured(episodes)
        yield episodes, times, [judged(NONE, episode, times) for episode in episodes]


@pytest.mark.render
@pytest.mark.long
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("fault", list(SHOWN_IN))
def test_what_a_fault_costs_is_put_down_to_it(fault: str, sound: Sound) -> None:
    episodes, times, without = sound
    more = added([judged(fault, episode, times) for episode in episodes], without)
    assert sum(more.values()) > COSTLY and share(fault, more) >= LEAST, more


def test_parts_that_shrank_are_not_counted_as_explained() -> None:
    more = dict.fromkeys(PARTS, 0.0) | {PLANNING: 0.3, EXECUTION: 0.1}
    assert share(RANDOM, more) == pytest.approx(0.75) and share(CLUMSY, more) == pytest.approx(0.25)
    assert share(RANDOM, more | {EXECUTION: -0.2}) == 1.0
