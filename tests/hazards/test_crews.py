"""Hazards act on every robot of a team as they would on it alone; in `paper` each warms the other as a thing would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
import torch

from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.simulation.crew import Crew
from hazard_ms.simulation.world import World
from hazard_ms.spec import Build
from tests.hazards.fire.test_blaze import REAL, with_room
from tests.hazards.fire.test_blaze import begin as begin_blaze
from tests.hazards.fire.test_blaze import run as run_blaze
from tests.hazards.flood.test_wading import LAW as WATER
from tests.hazards.flood.test_wading import by_moments, stream
from tests.hazards.test_fallen_robots import LAW as AIR
from tests.worlds.fire_worlds import begin_without_spread, room_world, updates
from tests.worlds.wind_worlds import Thing, begin, run, street

PAPER = Fire()
NEAR, FAR = (3.0, 2.0), (8.0, 8.0)  # [m], of a fire at (2, 2)
FETCH, G1 = HazardFetch.build, HazardG1.build


def enlist(world: World, builds: Sequence[Build], places: Sequence[tuple[float, float]]) -> list[World]:
    """The worlds of robots of these `builds` at `places` [m]."""
    crew = Crew(tuple(builds), torch.tensor([[(*place, 0.0) for place in places]]).repeat(world.num_envs, 1, 1))
    world.team, world.agent_position = crew, crew.places[:, 0]
    return [
        replace(world, team=replace(crew, number=k), agent_position=crew.places[:, k], agent_build=build)
        for k, build in enumerate(builds)
    ]


def told(law: Any, state: Any, worlds: Sequence[World], name: str) -> list[float]:
    return [float(law.agent_info(state, world)[name][0]) for world in worlds]


def test_each_robot_exchanges_heat_with_all_the_others() -> None:
    """One update by hand: weights 1 / d^2, but 4 within 0.5 m, the room 4, no robot heats itself."""
    world = room_world([], [(2.0, 2.0)], size=(9.0, 9.0), agent=NEAR)
    worlds = enlist(world, (FETCH, G1), (NEAR, (3.0, 4.0)))
    state = begin_without_spread(PAPER, world)
    state.agent_temperature[0] = torch.tensor([100.0, 40.0])
    updates(PAPER, state, world, 1)
    first = 20.0 + (1.0 * 580.0 + 0.25 * 20.0) / (4.0 + 1.0 + 0.25)  # the fire is 1 m away, the other robot 2 m
    second = 20.0 + (0.2 * 580.0 + 0.25 * 80.0) / (4.0 + 0.2 + 0.25)  # the fire is sqrt(5) m away
    want = [100.0 + 0.03 * (first - 100.0), 40.0 + 0.03 * (second - 40.0)]
    assert told(PAPER, state, worlds, "agent_temperature") == pytest.approx(want, rel=1e-5)


def test_what_a_thermal_camera_sees_has_all_robots_in_it() -> None:
    world = room_world([], [], size=(9.0, 9.0), agent=NEAR)
    enlist(world, (FETCH, G1), (NEAR, (3.0, 4.0)))
    state = begin_without_spread(PAPER, world)
    state.agent_temperature[0] = torch.tensor([20.0, 120.0])
    (there,) = PAPER.image(state, world, torch.tensor([[[3.0, 5.0, 0.0]]])).flatten().tolist()
    assert there == pytest.approx(20.0 + 1.0 * 100.0 / (4.0 + 1.0 + 1.0 / 9.0), rel=1e-5)


def test_doses_in_realistic_are_those_of_a_robot_alone_at_the_same_place() -> None:
    def burnt(*places: tuple[float, float]) -> tuple[Any, list[World]]:
        room = room_world([], [(2.0, 2.0)], size=(9.0, 9.0), agent=places[0])
        world = with_room(room, floor="tile")
        worlds = enlist(world, [FETCH] * len(places), places)
        state = begin_blaze(REAL, world)
        state.flame_age[:, 0] = 1e3
        run_blaze(REAL, state, world, 5.0)
        return state, worlds

    alone = [burnt(place) for place in (NEAR, FAR)]
    state, worlds = burnt(NEAR, FAR)
    for name in ("agent_temperature", "agent_dose", "agent_toxic_dose", "agent_flux", "agent_visibility"):
        want = [told(REAL, own, world, name)[0] for own, world in alone]
        assert told(REAL, state, worlds, name) == pytest.approx(want, rel=1e-5), name
    near, far = told(REAL, state, worlds, "agent_dose")
    assert near > 2.0 * far > 0.0


def test_wind_throws_over_the_robot_that_its_build_lets_fall() -> None:
    """In 20 m/s a G1 falls and a Fetch stands; only what lies has lost its own motion."""
    world = street([Thing()], (10.0, 0.0))
    world.agent_build = FETCH
    worlds = enlist(world, (FETCH, G1), ((2.0, 2.0), (2.0, 3.0)))
    state = begin(AIR, world)
    state.speed *= 20.0 / told(AIR, state, worlds, "agent_wind")[0]
    run(AIR, state, world, 1)
    assert told(AIR, state, worlds, "agent_fallen") == [0.0, 1.0]
    assert [bool(AIR.fallen(state, own)) for own in worlds] == [False, True]
    kept = [float(AIR.slow(state, own)[0, 0]) for own in worlds]
    assert kept[0] > 0.5 and kept[1] == 0.0


def test_water_throws_over_the_robot_that_its_build_lets_fall() -> None:
    basin = stream(FETCH, 0.4, 1.05 * by_moments(0.4))
    worlds = enlist(basin.world, (FETCH, G1), ((3.0, 2.0), (3.0, 4.0)))
    state = basin.state
    state.lies, state.lain = torch.zeros(1, 2, dtype=torch.bool), torch.zeros(1, 2)
    basin.run(1 / 30)
    assert told(WATER, state, worlds, "agent_fallen") == [0.0, 1.0]
    left = [1.0 - 1000.0 * wide**2 * 0.4 / mass for wide, mass in ((0.51, 115.0), (0.13, 35.0))]
    assert told(WATER, state, worlds, "agent_traction") == pytest.approx(left, abs=0.01)
