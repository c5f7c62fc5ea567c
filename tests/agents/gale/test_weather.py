"""What agents believe of a gale, from the speeds of the air that the hazard itself makes over the floor."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.agents.gale.weather import Weather
from hazard_ms.hazards.wind.gale import Gale
from hazard_ms.hazards.wind.gale_state import GaleState
from hazard_ms.simulation.world import World
from tests.worlds.wind_worlds import STILL, Block, Thing, begin, street

LAW = Gale(**STILL)
CELL, SIZE = 0.1, 240  # of the map: 24 m, from (-4, -4) on
BLOCKS = (  # as high as the map shows, so that nothing is cut off
    Block("shed", (5.0, 5.0, 0.0), (2.0, 2.0, 2.0)),
    Block("shed", (10.0, 10.5, 0.0), (1.5, 1.5, 2.0)),
    Block("kiosk", (11.0, 4.0, 0.0), (1.5, 1.5, 2.0)),
)
BRIEF: Any = SimpleNamespace(frame_seconds=1.0 / 30.0, max_frames=3000)


def seen(state: GaleState, world: World, time: float) -> Any:
    """A decision of an agent that sees all of the ground and of the sheds at a `time` [s]."""
    axis = -4.0 + (np.arange(SIZE) + 0.5) * CELL
    x, y = np.meshgrid(axis, axis)
    state.time[:] = time
    points = torch.tensor(np.stack([x, y, np.zeros_like(x)], -1).reshape(1, -1, 3), dtype=torch.float32)
    levels = LAW.speed_at(state, world, points)[0].numpy().reshape(SIZE, SIZE)
    height, things = np.zeros((SIZE, SIZE), np.float32), np.full((SIZE, SIZE), -1)
    for number, block in enumerate(BLOCKS):
        over = (np.abs(x - block.at[0]) < block.extent[0] / 2) & (np.abs(y - block.at[1]) < block.extent[1] / 2)
        height[over], things[over] = block.extent[2], number
    grid = SimpleNamespace(
        levels=levels[None],
        height=height,
        object_id=things,
        explored=np.ones((SIZE, SIZE), bool),
        origin=np.array([-4.0, -4.0]),
        cell=CELL,
    )
    names = ("shed_1", "shed_2", "kiosk_1")
    return SimpleNamespace(frame=round(30 * time), map=grid, names=names, targets=())


def angle(vector: Any) -> float:
    return math.atan2(float(vector[1]), float(vector[0]))


@pytest.mark.parametrize("wind", [(4.0, 0.5), (-2.0, 3.0)])
def test_it_finds_out_where_the_wind_blows_to_before_and_behind_the_front(wind: tuple[float, float]) -> None:
    """Headings are told apart in steps of 22.5 and 11.25 degrees, so half of a step more is as good as it gets."""
    world = street((Thing(at=(1.0, 1.0, 0.0)),), wind, blocks=BLOCKS)
    state = begin(LAW, world)
    assert isinstance(state, GaleState)
    weather = Weather(BRIEF)
    assert not weather.known
    for time in np.arange(0.0, 100.0, 4.0):
        weather.note(seen(state, world, float(time)))
    assert weather.known
    chances = weather.courses()
    assert sum(chance for chance, _ in chances) == pytest.approx(1.0)
    _, likely = max(chances, key=lambda row: row[0])
    for number, name in enumerate(("first", "middle", "last")):
        off = math.remainder(angle(likely.flows[number]) - angle(getattr(state, f"{name}_heading")[0]), 2.0 * math.pi)
        assert abs(off) < math.radians(23.0), name
        assert np.hypot(*likely.flows[number]) == pytest.approx(float(getattr(state, f"{name}_speed")[0]), rel=0.05)
    assert likely.front.onset == pytest.approx(float(state.onset[0]), abs=6.0)


def test_it_knows_nothing_of_the_turn_before_it_sees_the_front() -> None:
    """The winds that come are likely on both sides of the first."""
    world = street((Thing(at=(1.0, 1.0, 0.0)),), (4.0, 0.5), blocks=BLOCKS)
    state = begin(LAW, world)
    assert isinstance(state, GaleState)
    state.onset[:] = 1000.0  # nowhere near yet
    weather = Weather(BRIEF)
    weather.note(seen(state, world, 0.0))
    turns = [
        math.remainder(angle(course.flows[2]) - angle(course.flows[0]), 2.0 * math.pi)
        for _, course in weather.courses()
    ]
    assert min(turns) < -0.5 and max(turns) > 0.5
