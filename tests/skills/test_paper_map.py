"""The map of the original's learner, cell by cell, and drawn alike in the simulator and in the sketch."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.options.paper_map import (
    AGENT,
    CELL,
    CELLS,
    EXPLORED,
    HEIGHT,
    LEVEL,
    THING,
    MapLayout,
    cells,
    centre_at,
)
from tests.worlds.playground import Playground

FIRE, WATER = (20.0, 600.0), (0.0, 1.5)
PLACES = {"mug": (1.1, 0.0), "book": (0.0, 2.6), "cart_1": (-3.1, -3.1), "shelf": (2.0, 2.0)}


def ground() -> Playground:
    made = Playground(dict(PLACES), {"mug": 5.0, "book": 1.0}, carts=("cart_1",), sight=5.0)
    made.look()
    return made


def row_and_column(x: float, y: float) -> tuple[int, int]:
    """Those of a place [m], counted from the south-west corner, 8 m from the start."""
    return int((y + 8.0) // 0.25), int((x + 8.0) // 0.25)


def test_things_and_the_agent_are_where_they_are() -> None:
    made = MapLayout([FIRE]).encode(ground().decision())
    assert made.shape == (5, 64, 64) and made.dtype == np.float32
    want = np.full((CELLS, CELLS), -1.0)
    want[row_and_column(1.1, 0.0)] = 0.0  # the first target
    want[row_and_column(0.0, 2.6)] = 1 / 32  # the second
    want[row_and_column(-3.1, -3.1)] = 1.0  # the cart; other things are not shown
    np.testing.assert_array_equal(made[THING], want)
    agent = np.zeros((CELLS, CELLS))
    agent[row_and_column(0.0, 0.0)], agent[row_and_column(0.25, 0.0)] = -2.0, -1.0  # it faces +x
    np.testing.assert_array_equal(made[AGENT], agent)


def test_what_is_in_the_hand_is_where_the_agent_is_and_what_is_safe_is_gone() -> None:
    world = ground()
    world.held, world.at = "book", (-1.0, 1.0)
    world.rescued.add("mug")
    made = MapLayout([FIRE]).encode(world.decision())
    assert made[THING][row_and_column(-1.0, 1.0)] == np.float32(1 / 32)
    assert (made[THING] >= 0).sum() == 2  # that and the cart


def test_explored_floor_heights_and_levels_are_those_of_finer_cells() -> None:
    world = ground()
    seen = world.map
    y, x = seen.cell_of((1.05, 3.35))
    seen.explored[y, x] = True
    seen.levels[0, y : y + 2, x : x + 2] = [[120.0, 320.0], [20.0, np.nan]]
    seen._firm[y, x] = 0.7
    made = MapLayout([FIRE]).encode(world.decision())
    where = row_and_column(*seen.centre_of(y, x))
    assert made[HEIGHT][where] == np.float32(0.7) and made[LEVEL][where] == np.float32(np.log1p(300.0))
    area = made[EXPLORED].sum() * CELL**2
    assert area == pytest.approx(np.pi * 25.0, rel=0.08) and set(np.unique(made[EXPLORED])) == {0.0, 1.0}
    assert made[EXPLORED][row_and_column(0.0, 6.0)] == 0.0 == made[LEVEL][row_and_column(0.0, 6.0)]


def test_levels_at_targets_are_those_that_were_seen_over_them() -> None:
    world = ground()
    world.remember(0, Sighting(np.array([1.1, 0.0, 0.5], np.float32), 0.1, 0.6, 0, 50, levels=(220.0, 0.4)))
    made = MapLayout([FIRE, WATER]).encode(dataclasses.replace(world.decision(), map=world.map))
    where = row_and_column(1.1, 0.0)
    assert made.shape[0] == 6 and made[LEVEL][where] == np.float32(np.log1p(200.0))
    assert made[LEVEL + 1][where] == np.float32(0.4)


def test_levels_are_bounded_and_those_that_range_wide_are_logarithms() -> None:
    layout = MapLayout([FIRE, WATER])
    raw = np.array([[-50.0, 20.0, 21.0, 600.0, 9000.0, np.nan], [-1.0, 0.0, 0.5, 1.5, 9.0, np.nan]])
    want = [np.log1p([0.0, 0.0, 1.0, 580.0, 1160.0, 0.0]), [0.0, 0.0, 0.5, 1.5, 3.0, 0.0]]
    np.testing.assert_allclose(layout.levels(raw), want)
    space = layout.space()
    assert space.shape == (6, 64, 64) and space.high[LEVEL, 0, 0] == np.float32(np.log1p(1160.0))
    assert (space.low[:, 0, 0].tolist(), space.high[LEVEL + 1, 5, 5]) == ([0, 0, -1, -2, 0, 0], 3.0)


def test_what_lies_beyond_is_shown_at_the_edge() -> None:
    world = Playground({"mug": (20.0, 1.0), "book": (-30.0, -30.0)}, {"mug": 5.0, "book": 1.0}, sight=50.0)
    world.look()
    world.at = (0.0, 99.0)
    made = MapLayout([FIRE]).encode(world.decision())
    assert made[THING, row_and_column(0.0, 1.0)[0], 63] == 0.0 and made[THING, 0, 0] == np.float32(1 / 32)
    assert made[AGENT, 63, 32] == -2.0 and MapLayout([FIRE]).space().contains(made)


def test_of_two_targets_in_a_cell_the_first_is_shown() -> None:
    world = Playground({"mug": (1.0, 1.0), "book": (1.05, 1.05)}, {"mug": 5.0, "book": 1.0})
    world.look()
    assert MapLayout([FIRE]).encode(world.decision())[THING][row_and_column(1.0, 1.0)] == 0.0


def test_cells_are_a_quarter_metre_around_the_middle() -> None:
    centre = centre_at(np.array([3.04, -1.26]))
    np.testing.assert_allclose(centre, [3.0, -1.3])
    points = np.array([[3.0, -1.3], [2.99, -1.31], [10.99, 6.69], [11.1, -99.0]])
    y, x = cells(points, centre)
    assert y.tolist() == [32, 31, 63, 0] and x.tolist() == [32, 31, 63, 63]


def test_more_targets_than_there_are_numbers_are_refused() -> None:
    places = {f"mug_{k}": (1.0, 0.1 * k) for k in range(33)}
    with pytest.raises(ValueError, match="at most 32 targets, got 33"):
        MapLayout([FIRE]).encode(Playground(places, dict.fromkeys(places, 1.0)).decision())
