"""The plan of a scene: what the rest of its tests, in tests/cli, do not look at."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.pictures.scene_plan import EDGE, WATER, plan
from hazard_ms.spec import AgentStart, Room, SceneSpec

ROOM = SceneSpec("room/00", Room((4.0, 3.0)), (), (), (), (), AgentStart((2.0, 1.0), heading=0.0))


@pytest.mark.parametrize(
    ("side", "where"), [("south", "bottom"), ("north", "top"), ("west", "left"), ("east", "right")]
)
def test_water_comes_from_its_side_and_north_is_up(side: str, where: str) -> None:
    image = plan(dataclasses.replace(ROOM, flood_side=side))
    rows, columns = np.nonzero((image == WATER).all(-1))
    height, width = image.shape[:2]
    rim = image.shape[1] * EDGE / (4.0 + 2 * EDGE)  # [pixels]
    inside = {
        "top": rows.max() < rim,
        "bottom": rows.min() > height - rim,
        "left": columns.max() < rim,
        "right": columns.min() > width - rim,
    }
    assert [name for name, is_there in inside.items() if is_there] == [where]


def test_water_comes_from_both_sides_where_there_are_two() -> None:
    one, other, both = (
        plan(dataclasses.replace(ROOM, flood_side=side, second_flood_side=second))
        for side, second in (("south", None), ("west", None), ("south", "west"))
    )
    water = [(image == WATER).all(-1) for image in (one, other, both)]
    assert (water[2] == (water[0] | water[1])).all() and water[2].sum() > max(water[0].sum(), water[1].sum())


def test_the_arrow_of_the_agent_points_where_it_looks() -> None:
    """Between plans that differ in the heading alone, the difference lies where the arrows are."""
    east, north = (
        plan(dataclasses.replace(ROOM, agent_start=AgentStart((2.0, 1.0), heading))) for heading in (0.0, np.pi / 2)
    )
    rows, columns = np.nonzero((east != north).any(-1))
    metre = east.shape[1] / (4.0 + 2 * EDGE)
    middle = ((3.0 + EDGE - 1.0) * metre, (2.0 + EDGE) * metre)  # of the agent: row, column [pixels]
    assert rows.min() == pytest.approx(middle[0] - 0.5 * metre, abs=6)  # up for north
    assert columns.max() == pytest.approx(middle[1] + 0.5 * metre, abs=6)  # right for east
    assert rows.max() < middle[0] + 0.2 * metre and columns.min() > middle[1] - 0.2 * metre
