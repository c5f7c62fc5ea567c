"""Water that comes in at outer doors alone, as in homes of `paper`."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.spec import Opening
from tests.hazards.flood.test_flood_surface import DIVIDED, NOTHING, SIZE, SLOPE, at, levels, room, ways_on_a_grid

LAW = Flood(through_doors=True)
INLETS = {"east": 1.2, "west": 4.6, "south": 2.4, "north": 7.7}  # middles of outer doors along their walls [m]


@pytest.mark.parametrize("side", INLETS)
@pytest.mark.parametrize("kind", DIVIDED)
def test_water_takes_the_shortest_way_from_the_outer_door(side: str, kind: str) -> None:
    """Against a grid, whose 16 directions make ways up to 2.8 % longer, and which ends in the middle of doorways."""
    partitions, openings = DIVIDED[kind]
    door = Opening("door", side, INLETS[side], 0.9, 2.0)
    world = room(NOTHING, side, SIZE, 1, (1.0, 1.0), partitions, (*openings, door))
    state = at(LAW, world, 1400)
    want = ways_on_a_grid(side, kind, 0.1, (INLETS[side] - 0.45, INLETS[side] + 0.45))
    cells = [(i, j) for i in range(3, 100, 9) for j in range(3, 60, 7)]
    found = levels(LAW, state, world, [((i + 0.5) * 0.1, (j + 0.5) * 0.1) for i, j in cells])
    for (i, j), level in zip(cells, found, strict=True):
        if math.isinf(want[i, j]):
            near = any(abs(((i if p.axis == "y" else j) + 0.5) * 0.1 - p.at) < 0.15 for p in partitions)
            assert near or level == 0.0  # in a wall, or behind a closed one
        elif want[i, j] < 1.3 / SLOPE:
            way = (1.4 - level) / SLOPE
            assert way == pytest.approx(want[i, j], abs=0.03 * want[i, j] + 0.1 + 1.3 * len(partitions))


def test_a_door_that_is_shut_keeps_the_water_out_and_one_that_is_opened_lets_it_in() -> None:
    partitions, _ = DIVIDED["closed"]
    inner, outer = Opening("door", partitions[0].name, 3.0, 0.9, 2.0, open=1.0), Opening("door", "west", 1.0, 0.9, 2.0)
    beyond = (9.0, 3.0) if partitions[0].axis == "y" else (3.0, 5.5)
    world = room(NOTHING, "west", SIZE, 1, (1.0, 1.0), partitions, (inner, outer))
    state, wet = at(LAW, world, 1400), []
    for share in (1.0, 0.0, 0.5):
        world.openings.set_open(torch.arange(1), 0, share)
        LAW.advance(state, world, 1 / 30)
        wet.append(levels(LAW, state, world, [beyond])[0] > 0.0)
    assert wet == [True, False, True]


def test_a_wall_without_a_door_lets_water_in_at_its_middle() -> None:
    state = at(LAW, world := room(NOTHING, "south", SIZE, 1, (1.0, 1.0)), 1400)
    middle, corner = levels(LAW, state, world, [(SIZE[0] / 2, 0.0), (0.0, 0.0)])
    assert middle == pytest.approx(1.4, abs=1e-5)
    assert corner == pytest.approx(1.4 - SLOPE * (SIZE[0] / 2 - 0.45), abs=1e-4)


def test_two_doors_are_two_sources() -> None:
    ways = [Opening("door", "west", 1.0, 0.9, 2.0), Opening("door", "north", 8.0, 0.9, 2.0)]
    world = room(NOTHING, "west", SIZE, 1, (1.0, 1.0), (), tuple(ways))
    world = dataclasses.replace(world, specs=(dataclasses.replace(world.specs[0], second_flood_side="north"),))
    found = levels(LAW, at(LAW, world, 1400), world, [(0.0, 1.0), (8.0, SIZE[1]), (9.0, 3.0)])
    assert np.allclose(found[:2], 1.4) and found[2] == pytest.approx(1.4 - SLOPE * math.hypot(0.55, 3.0), abs=1e-3)
