"""The free floor: what stands in the way, which part a robot gets to, and how long its ways are."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import OVERHEAD_HEIGHT, cell_of, free_for, largest, steps_from
from hazard_ms.spec import Opening, Partition, Room

ROOM = Room((4.0, 4.0))
MIDDLE = cell_of((2.0, 2.0))


@pytest.mark.parametrize(
    ("low", "high", "free"),
    [(0.0, 0.8, False), (0.6, 0.9, False), (0.0, 0.02, True), (OVERHEAD_HEIGHT + 0.1, 2.0, True)],
    ids=["counter", "table top", "rug", "wall cupboard"],
)
def test_a_robot_stands_on_rugs_and_below_what_hangs_high(low: float, high: float, free: bool) -> None:
    thing = Box(2.0, 2.0, 0.5, 0.5, 0.0, low, high)
    assert bool(free_for(ROOM, [thing], [], 0.3)[MIDDLE]) is free


def test_a_robot_gets_through_a_doorway_and_not_through_the_wall_beside_it() -> None:
    wall = Partition("partition_1", "y", 2.0, 0.1)
    room = Room((4.0, 4.0), partitions=(wall,), openings=(Opening("doorway", "partition_1", 1.0, 1.2, 2.0),))
    free = free_for(room, [], [], 0.3)
    assert free[cell_of((2.0, 1.0))] and not free[cell_of((2.0, 3.0))]


@pytest.mark.parametrize("flipped", [False, True])
def test_the_largest_part_is_the_largest_wherever_it_lies(flipped: bool) -> None:
    free = np.zeros((20, 20), bool)
    free[1:3, 1:3] = True
    free[10:15, 10:15] = True
    free[7:9, 17:19] = True
    free = free[::-1, ::-1] if flipped else free
    assert largest(free).sum() == 25 and (largest(free) <= free).all()
    assert not largest(np.zeros((3, 3), bool)).any()


def test_every_other_step_goes_over_a_corner() -> None:
    """The first may not, the second may: 20 cells along both axes take about 20 sqrt(2) steps."""
    steps = steps_from(np.ones((21, 21), bool), (0, 0))
    assert [int(steps[k, k]) for k in range(4)] == [0, 2, 3, 4]
    assert [int(steps[k, 0]) for k in range(4)] == [0, 1, 2, 3]
    assert float(steps[20, 20]) == pytest.approx(20 * np.sqrt(2), rel=0.08)
