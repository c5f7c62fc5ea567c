"""Wind and water act on a robot with its own mass, width, drag area and friction."""

from __future__ import annotations

import math

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.hazards.flood import wading
from hazard_ms.hazards.presets import flood, wind
from hazard_ms.hazards.wind.sweeping import sweeping_speed
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.spec import Build
from tests.worlds import flood_worlds, wind_worlds

AIR, WATER, GRAVITY = 1.225, 1000.0, 9.81  # [kg/m^3], [kg/m^3], [m/s^2]
# Mass [kg], width [m], drag area [m^2] and friction [-] as docs/physics.md 3.2 and the robots' makers give them.
FETCH, G1 = (115.0, 0.51, 0.7, 0.6), (35.0, 0.13, 0.31, 0.6)
EVERY = pytest.mark.parametrize("preset", ["paper", "shipped", "realistic"])


def limit(mass: float, drag_area: float, friction: float) -> float:
    """Speed of the air [m/s] whose drag equals the friction of a robot on dry ground."""
    return math.sqrt(2.0 * friction * mass * GRAVITY / (AIR * drag_area))


def kept_in_wind(preset: str, build: Build, speed: float) -> float:
    """Share of its own motion that a robot keeps in a steady wind of `speed` [m/s] at the height where it acts."""
    law = wind(preset)
    world = wind_worlds.street([wind_worlds.Thing()], (5.0, 0.0))
    world.agent_build = build
    state = wind_worlds.begin(law, world)
    state.gust[:] = 0.0
    state.speed[:] *= speed / float(law.image(state, world, law._chest(world)))
    return float(law.slow(state, world)[0, 0])


def drifts_at(preset: str, build: Build) -> float:
    """Least wind [m/s] in which a robot keeps nothing of its own motion, by bisection."""
    low, high = 0.0, 100.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if kept_in_wind(preset, build, middle) == 0.0 else (middle, high)
    return high


def test_builds_have_the_published_numbers() -> None:
    for build, want in ((HazardFetch.build, FETCH), (HazardG1.build, G1)):
        assert (build.mass, build.width, build.drag_area, build.friction) == want


@EVERY
def test_g1_is_swept_at_a_lower_wind_than_fetch(preset: str) -> None:
    ratio = limit(G1[0], G1[2], G1[3]) / limit(FETCH[0], FETCH[2], FETCH[3])
    assert ratio == pytest.approx(0.829, abs=1e-3)
    found = drifts_at(preset, HazardG1.build) / drifts_at(preset, HazardFetch.build)
    assert found == pytest.approx(ratio, rel=1e-3)


@pytest.mark.parametrize(("preset", "speed"), [("paper", 3.354), ("shipped", 11.18), ("realistic", 39.7)])
def test_fetch_drifts_at_the_documented_wind(preset: str, speed: float) -> None:
    """docs/physics.md 1.4 gives the speeds for Fetch."""
    assert drifts_at(preset, HazardFetch.build) == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("build", [HazardFetch.build, HazardG1.build])
def test_friction_holds_a_standing_robot_below_the_wind_that_slides_it(build: Build) -> None:
    """Coulomb: nothing moves before the drag outdoes the friction, then at what the wind is faster than that."""
    law, holds = wind("realistic"), sweeping_speed(build)
    world = wind_worlds.street([wind_worlds.Thing()], (5.0, 0.0))
    world.agent_build = build
    state = wind_worlds.begin(law, world)
    state.gust[:] = 0.0
    for share in (0.3, 0.9, 0.99, 1.2):
        state.speed[:] *= share * holds / float(law.image(state, world, law._chest(world)))
        kept, *drift = law.slow(state, world)[0].tolist()
        assert math.hypot(*drift) == pytest.approx(max(share - 1.0, 0.0) * holds, abs=1e-3)
        assert kept == pytest.approx(max(1.0 - share**2, 0.0), abs=1e-4)


def test_a_robot_slides_where_drag_equals_friction() -> None:
    for build, (mass, _, area, friction) in ((HazardFetch.build, FETCH), (HazardG1.build, G1)):
        speed = sweeping_speed(build)
        assert 0.5 * AIR * area * speed**2 == pytest.approx(friction * mass * GRAVITY)


@pytest.mark.parametrize("depth", [0.1, 0.4, 0.9, 1.4])
def test_grip_in_water_follows_the_robots_own_numbers(depth: float) -> None:
    for build, (mass, width, _, friction) in ((HazardFetch.build, FETCH), (HazardG1.build, G1)):
        weight = max((mass - WATER * width**2 * depth) * GRAVITY, 0.0)
        speed = 0.5
        dragged = 0.5 * WATER * 1.1 * width * depth * speed**2
        want = max(0.0, 1.0 - dragged / (friction * weight)) if weight else 0.0
        found = wading.grip(torch.tensor(depth), speed, build, WATER, GRAVITY)
        assert float(found) == pytest.approx(want, abs=1e-5)


def test_the_robot_of_the_world_is_the_one_that_wades() -> None:
    law, found = flood_worlds.on_a_plane(flood("realistic")), []
    for build in (HazardFetch.build, HazardG1.build):
        world = flood_worlds.room([flood_worlds.Thing((0.2, 0.2, 0.2))], agent=(19.0, 10.0))
        world.agent_build = build
        state = flood_worlds.begin(law, world)
        state.level[:] = 0.5
        found.append((float(law.slow(state, world)[0, 0]), float(law.agent_info(state, world)["agent_traction"][0])))
    (fetch_kept, fetch_traction), (g1_kept, g1_traction) = found
    assert fetch_traction == 0.0 and fetch_kept == 0.0  # half a metre of water floats Fetch's wide base
    assert g1_traction == pytest.approx(1.0 - WATER * 0.13**2 * (0.5 - 0.0524078) / 35.0, abs=1e-4)
    assert g1_kept > 0.8


def test_a_world_without_an_agent_says_so() -> None:
    law, world = flood("paper"), flood_worlds.room([flood_worlds.Thing((0.2, 0.2, 0.2))])
    with pytest.raises(ValueError, match="agent_build must be the build of a robot, got None"):
        law.slow(flood_worlds.begin(law, world), world)


def test_an_environment_tells_the_hazards_which_robot_plays() -> None:
    made = gym.make("HazardFlood-v1", robot_uids="g1", affects_agent=True, render_backend="none", obs_mode="none")
    made.reset(seed=0)
    assert made.unwrapped.world.robot is HazardG1.build
    made.close()
