"""Robots that the water of `realistic` carries off or throws over: L-60 to L-62 of docs/physics.md 2.2."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, cast

import pytest
import torch

from hazard_ms.hazards.flood.realistic import footing
from hazard_ms.hazards.presets import flood, wind
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.spec import Build
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.rewards import told
from hazard_ms.tasks.episode.situation import Situation
from hazard_ms.validation.experiments.basin import Basin

LAW = dataclasses.replace(flood("realistic"), outside=0.0, roughness=0.0)
WATER, GRAVITY, DRAG = 1000.0, 9.81, 1.1  # [kg/m^3], [m/s^2], [-]
G1 = (35.0, 0.13, 0.19)  # mass [kg], width [m], stance [m]
FETCH = (115.0, 0.51, 0.51)


def stream(build: Build, depth: float, speed: float) -> Basin:
    """A closed basin 6 m square whose water runs eastwards past a robot in its middle."""
    basin = Basin((6.0, 6.0), depth=depth, law=LAW)
    for name, value in (("surface", depth), ("velocity_x", speed), ("discharge_x", speed * depth)):
        basin.put(name, torch.full(basin.cells, value).numpy())
    basin.state.signal[:] = 10.0  # of waves that run this fast: steps are short enough
    basin.world.agent_build = build
    return basin


def falls(build: Build, depth: float, speed: float) -> bool:
    basin = stream(build, depth, speed)
    basin.run(1 / 30)
    fell = LAW.agent_info(basin.state, basin.world)["agent_fallen"]
    assert fell.tolist() == basin.state.lies[:, 0].tolist()
    return bool(fell[0])


def by_moments(depth: float) -> float:
    """Speed [m/s] whose drag on a G1, at half the depth, has the moment of its weight less its lift."""
    mass, width, stance = G1
    weight = (mass - WATER * width**2 * depth) * GRAVITY
    return math.sqrt(0.5 * stance * weight / (0.5 * WATER * DRAG * width * depth * 0.5 * depth))


@pytest.mark.parametrize(("depth", "speed"), [(0.4, 2.14), (0.5, 1.66), (0.8, 0.935)])
def test_a_g1_topples_where_the_moment_of_the_drag_is_that_of_its_weight(depth: float, speed: float) -> None:
    assert by_moments(depth) == pytest.approx(speed, abs=0.01)
    assert not falls(HazardG1.build, depth, 0.98 * by_moments(depth))
    assert falls(HazardG1.build, depth, 1.02 * by_moments(depth))


def test_what_slides_before_it_topples_does_not_fall_where_friction_is_too_little() -> None:
    """A G1 in water shallower than its stance over its friction, 0.317 m, slides, however fast the water is."""
    assert G1[2] / 0.6 == pytest.approx(0.317, abs=1e-3)
    for depth, fell in ((0.30, False), (0.33, True)):
        found = footing.topples(torch.tensor([depth]), torch.tensor([9.0]), HazardG1.build, WATER, GRAVITY)
        assert bool(found) == fell


def test_a_fetch_slides_until_it_floats_and_then_keels_over() -> None:
    mass, width, _ = FETCH
    afloat = mass / (WATER * width**2)
    metacentre = afloat / 2 + width**4 / 12 / (width**2 * afloat)  # above the floor: of buoyancy, and I / V
    assert afloat == pytest.approx(0.442, abs=1e-3) and metacentre == pytest.approx(0.270, abs=1e-3)
    assert metacentre < HazardFetch.build.drag_height  # below its middle: it cannot stay upright
    assert not falls(HazardFetch.build, 0.99 * afloat, 3.0)
    assert falls(HazardFetch.build, 1.01 * afloat, 0.0)
    steady = dataclasses.replace(HazardFetch.build, stance=math.inf)
    assert not falls(steady, 1.5, 3.0)


def test_a_g1_gets_up_after_eight_seconds_where_the_water_has_calmed() -> None:
    basin = stream(HazardG1.build, 0.5, 2.5)
    basin.run(1 / 30)
    assert bool(basin.state.lies[0])
    for name in ("velocity_x", "discharge_x"):
        getattr(basin.state, name)[:] = 0.0
    basin.run(7.9)
    assert bool(basin.state.lies[0])
    basin.run(0.2)
    assert not bool(basin.state.lies[0]) and float(basin.state.lain[0]) == 0.0


@pytest.mark.parametrize("lies", [False, True])
def test_friction_holds_a_robot_until_the_water_outdoes_it(lies: bool) -> None:
    """0.3 m of water slides a Fetch at sqrt(2 mu (m - rho w^2 d) g / (rho Cd w d)): at what it is faster than that."""
    mass, width, _ = FETCH
    depth = 0.3
    holds = math.sqrt(2 * 0.6 * (mass - WATER * width**2 * depth) * GRAVITY / (WATER * DRAG * width * depth))
    assert holds == pytest.approx(1.62, abs=0.03)  # docs/physics.md 3.2
    for speed in (0.5 * holds, 0.95 * holds, 1.25 * holds, 2.0 * holds):
        basin = stream(HazardFetch.build, depth, speed)
        basin.state.lies[:] = lies
        own, *drift = LAW.slow(basin.state, basin.world)[0].tolist()
        assert drift == pytest.approx([max(speed - holds, 0.0), 0.0], abs=2e-3)
        assert own == pytest.approx(0.0 if lies else min(holds / speed, 1.0), abs=1e-3)


def test_a_person_falls_where_people_did_in_flumes() -> None:
    """70 kg on 0.25 m of feet, legs that displace 0.2 m square: at 0.7 to 2.12 m^2/s [Abt et al. 1989]."""
    person = dataclasses.replace(HazardG1.build, mass=70.0, width=0.2, stance=0.25)
    speeds = torch.arange(0.0, 5.0, 0.01)
    for depth in (0.5, 0.7, 0.9, 1.1):
        fell = footing.topples(torch.tensor([depth]), speeds, person, WATER, GRAVITY)
        assert 0.70 <= depth * float(speeds[fell][0]) <= 2.12


def test_an_episode_tells_of_falls_in_water_and_wind() -> None:
    """Whichever threw it over; water comes before wind, which does not undo what it told."""
    basin = stream(HazardG1.build, 0.5, 2.5)
    basin.world.chance.restart(torch.tensor([0]), torch.tensor([0]))
    episode = Episode(basin.world, (flood("realistic"), wind("realistic")))
    for water, air in ((True, False), (False, True), (False, False)):
        episode.states["flood"].lies[:], episode.states["wind"].lies[:] = water, air
        info = told(Situation(episode, cast(Any, None), affects_agent=True))
        assert info["agent_fallen"].tolist() == [water or air]


@pytest.mark.parametrize("preset", ["paper", "shipped"])
def test_nobody_falls_in_the_water_of_paper_and_shipped(preset: str) -> None:
    law, basin = flood(preset), stream(HazardG1.build, 0.5, 2.5)
    assert (
        law.fallen(law.state_type.allocate({"E": 1, "B": 1, **law.sizes(basin.world)}, basin.world.device), basin.world)
        is None
    )
