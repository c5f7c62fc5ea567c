"""The hand goes into furniture through its open side, between two boards of which the map shows the upper one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.skills.motor.surface import Surface, place_of
from tests.worlds.arena import Arena, Box

BOARD, ROOF = 0.5, 0.86  # heights of the top of the lower board, and of the bottom of the upper one [m]
FRONT, BACK, SIDE = 0.6, 0.9, 0.4  # of the shelf, along x and y [m]
MIDDLE, DEPTH = (FRONT + BACK) / 2, BACK - FRONT
BOXES = (
    Box("lower", (MIDDLE, 0.0, BOARD / 2), (DEPTH, 2 * SIDE, BOARD)),
    Box("upper", (MIDDLE, 0.0, ROOF + 0.3), (DEPTH, 2 * SIDE, 0.6)),
    Box("back", (BACK + 0.02, 0.0, 0.75), (0.04, 2 * SIDE, 1.5)),
    Box("left", (MIDDLE, SIDE + 0.02, 0.75), (DEPTH, 0.04, 1.5)),
    Box("right", (MIDDLE, -SIDE - 0.02, 0.75), (DEPTH, 0.04, 1.5)),
    Box("button", (FRONT + 0.12, 0.05, BOARD + 0.005), (0.03, 0.03, 0.01), 0.05),
    Box("jar", (FRONT + 0.12, -0.2, BOARD + 0.06), (0.1, 0.1, 0.12), 0.3),
    Box("stool", (-1.0, 0.0, 0.2), (0.4, 0.4, 0.4)),
    Box("cup", (-1.0, 0.0, 0.45), (0.08, 0.08, 0.1), 0.3),
)


@pytest.fixture(scope="module")
def arena() -> Iterator[Arena]:
    made = Arena(BOXES)
    yield made
    made.close()


@pytest.mark.parametrize("name", ["button", "jar"])
def test_what_lies_between_two_boards_is_picked_up(arena: Arena, name: str) -> None:
    """Nothing is dragged along or struck on the way: the other thing stays where it is."""
    arena.restart()
    other = arena.stage.position(arena.index("jar" if name == "button" else "button"))
    assert arena.run(pick_up(arena.stage, arena.index(name))).ok
    moved = arena.stage.position(arena.index("jar" if name == "button" else "button")) - other
    assert np.abs(moved).max() < 0.02


def test_furniture_is_open_towards_the_nearest_floor(arena: Arena) -> None:
    """The front of the shelf faces west; what stands on a stool is in the open."""
    arena.restart()
    stage = arena.stage
    out = Surface(stage, place_of(stage, arena.index("jar"))).out
    assert out == pytest.approx([-1.0, 0.0], abs=0.15)
    turned = Surface(stage, place_of(stage, arena.index("jar")), np.pi / 2).outward  # seen by who does not turn
    assert turned == pytest.approx([0.0, 1.0, 0.0], abs=0.15)
    assert not Surface(stage, place_of(stage, arena.index("cup"))).out.any()


def test_a_thing_behind_a_screen_of_its_own_height_is_in_the_open(arena: Arena) -> None:
    """A cell of the map that is higher does not make furniture around a thing: most of what is around it must be."""
    arena.restart()
    place = place_of(arena.stage, arena.index("cup"))
    row, column = arena.map.cell_of(place.middle[:2])
    arena.map._firm[row, column] = 1.5
    assert not Surface(arena.stage, place).out.any()
