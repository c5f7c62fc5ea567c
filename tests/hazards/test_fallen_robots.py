"""Robots that the wind of `realistic` throws over: W-38 of docs/physics.md 2.3, lying, standing up, and the drive."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind.sweeping import sweeping_speed, toppling_speed
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.spec import Build
from tests.worlds.wind_worlds import Thing, begin, run, street

LAW = dataclasses.replace(wind("realistic"), by_split=False, scale=1.0, gust_intensity=0.0, sheltered=False)
AIR, GRAVITY = 1.225, 9.81  # [kg/m^3], [m/s^2]
# Mass [kg], drag area [m^2], width of the stance [m] and height of the drag [m] as the makers give them.
ROBOTS = {"fetch": (HazardFetch.build, 115.0, 0.7, 0.51, 0.55), "g1": (HazardG1.build, 35.0, 0.31, 0.19, 0.66)}
FRAMES_DOWN = 240  # 8 s of a G1


def storm(build: Build, speed: float) -> tuple[Any, Any]:
    """A street in which the air at a robot's chest has this `speed` [m/s]."""
    world = street([Thing()], (10.0, 0.0), copies=2)
    world.agent_build = build
    state = begin(LAW, world)
    state.speed *= speed / float(LAW.agent_info(state, world)["agent_wind"][0])
    return state, world


@pytest.mark.parametrize("name", ROBOTS)
def test_it_topples_where_the_moment_of_the_drag_is_that_of_its_weight(name: str) -> None:
    build, mass, area, stance, height = ROBOTS[name]
    speed = toppling_speed(build)
    assert 0.5 * AIR * area * speed**2 * height == pytest.approx(mass * GRAVITY * stance / 2)
    assert speed < sweeping_speed(build)
    for share, falls in ((0.98, False), (1.02, True)):
        state, world = storm(build, share * speed)
        run(LAW, state, world, 3)
        assert state.lies[:, 0].tolist() == [falls] * 2
        assert LAW.agent_info(state, world)["agent_fallen"].tolist() == [falls] * 2


def test_a_g1_stands_up_after_eight_seconds_of_calm_and_falls_again_in_a_storm() -> None:
    state, world = storm(HazardG1.build, 20.0)
    run(LAW, state, world, 1)
    assert state.lies.all()
    state.speed[1] = 1.0
    run(LAW, state, world, FRAMES_DOWN - 2)
    assert state.lies[:, 0].tolist() == [True, True]
    run(LAW, state, world, 4)
    assert state.lies[:, 0].tolist() == [True, False]
    assert float(state.lain[0]) < 0.2 and float(state.lain[1]) == 0.0


def test_a_fetch_stays_down_and_a_robot_without_a_stance_never_falls() -> None:
    state, world = storm(HazardFetch.build, 36.0)
    run(LAW, state, world, 1)
    state.speed[:] = 0.5
    run(LAW, state, world, 3000)
    assert state.lies.all()
    steady = dataclasses.replace(HazardFetch.build, stance=math.inf)
    state, world = storm(steady, 90.0)
    run(LAW, state, world, 10)
    assert not state.lies.any()


@pytest.mark.parametrize(("speed", "slides"), [(20.0, 0.0), (36.0, 36.0 - 32.94)])
def test_what_lies_keeps_nothing_of_its_motion_and_slides_once_friction_gives_way(speed: float, slides: float) -> None:
    """W-7's law: at what the wind is faster than it must be to move it."""
    state, world = storm(HazardG1.build, speed)
    run(LAW, state, world, 1)
    left = LAW.slow(state, world)
    assert left[0].tolist() == pytest.approx([0.0, slides, 0.0], abs=0.01)


@pytest.mark.parametrize("preset", ["paper", "shipped"])
def test_nobody_falls_in_paper_and_shipped(preset: str) -> None:
    law, world = dataclasses.replace(wind(preset), scale=60.0), street([Thing()], (5.0, 0.0))
    world.agent_build = HazardG1.build
    state = begin(law, world)
    run(law, state, world, 3)
    assert law.fallen(state, world) is None and not state.lies.any()
    assert set(law.agent_info(state, world)) == {"agent_wind"}


@pytest.mark.parametrize("field", ["stance", "drag_height", "rising"])
def test_builds_that_cannot_be_are_refused(field: str) -> None:
    with pytest.raises(ValueError, match=f"{field} must be positive, got 0.0"):
        dataclasses.replace(HazardG1.build, **{field: 0.0})


def blown(affects_agent: bool) -> Any:
    made = gym.make(
        "HazardWind-v1",
        robot_uids="g1",
        affects_agent=affects_agent,
        physics="realistic",
        render_backend="none",
        obs_mode="none",
        control_mode="pd_joint_pos",
    )
    made.reset(seed=0)
    return made


@pytest.fixture(params=[True, False])
def played(request: pytest.FixtureRequest) -> Iterator[tuple[Any, bool]]:
    made = blown(request.param)
    yield made, request.param
    made.close()


def test_in_an_episode_it_neither_drives_nor_turns_while_it_lies(played: tuple[Any, bool]) -> None:
    env, affected = played
    base = env.unwrapped
    state, agent = base.episode.states["wind"], base.agent
    action = agent.action(agent.build.forward_step, agent.build.turn_step, agent.tucked, True)
    state.speed[:], state.gust[:] = 1.0, 0.0
    for _ in range(5):
        *_, info = env.step(action)
    before = agent.base()
    state.lies[:], state.lain[:] = True, 0.0
    for _ in range(30):
        *_, info = env.step(action)
    after = agent.base()
    assert ("agent_fallen" in info) == affected
    assert (abs(after[2] - before[2]) < 0.05) == affected
    assert (math.dist(after[:2], before[:2]) < 0.02) == affected
    assert not affected or bool(info["agent_fallen"])
