"""The course of a gale: the pressures that it puts on things, against the hazard's own forces, and what things bear."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from hazard_ms.agents.gale.course import Course, Front, Lees, kept
from hazard_ms.agents.gale.truth import course_of
from hazard_ms.hazards.presets import gale, wind
from hazard_ms.hazards.wind.endurance import endurance, of_models
from hazard_ms.hazards.wind.gale import WINDS, Gale
from hazard_ms.hazards.wind.gale_state import GaleState
from hazard_ms.spec.catalogue import WIND_POOL
from tests.worlds.wind_worlds import STILL, Block, Thing, begin, push, street

LAW = Gale(**STILL)
AIR = 1.225  # density [kg/m^3]
OPEN = Lees(np.array([-100.0, -100.0]), np.zeros((3, 1, 1)), np.zeros((3, 1, 1)))
FRONT = Front(onset=30.0, way=(1.0, 0.0), pace=0.5, middle=(8.0, 8.0), rise=3.0, turning=40.0)
FLOWS = np.array([[0.5, 0.0], [0.0, 1.0], [-1.0, 0.0]])  # [m/s]
HERE = np.array([[8.0, 8.0, 0.1]])


@pytest.mark.parametrize(
    ("now", "end", "squared"),
    [
        (0.0, 29.0, 0.25),  # before the front: 0.5 m/s
        (0.0, 31.0, math.hypot(2 / 3 * 0.25, 1 / 3)),  # a third of the rise, at right angles
        (0.0, 33.0, 1.0),  # the second wind alone
        (53.0, 53.0, math.sqrt(0.5)),  # halfway between two of equal speed, at right angles
        (0.0, 100.0, 1.0),
    ],
)
def test_the_greatest_pressure_is_that_of_the_mean_force(now: float, end: float, squared: float) -> None:
    assert Course(FLOWS, OPEN, FRONT, end).pressure(HERE, now) == pytest.approx([squared], rel=1e-6)


def test_the_front_comes_later_where_it_moves_to() -> None:
    """At 0.5 m/s it is 10 s later 5 m farther on."""
    there = HERE + [5.0, -3.0, 0.0]
    for late in (-1.0, 1.0, 20.0):
        times = np.array([30.0 + late])
        assert FRONT.shares(there, times + 10.0) == pytest.approx(FRONT.shares(HERE, times))


def test_pressures_are_those_of_the_forces_on_a_cube_behind_a_house_and_beside_it() -> None:
    """All three winds blow along x, so they meet the same face of 0.04 m^2 of a cube that feels all of the wind."""
    cubes = tuple(Thing(extent=(0.2, 0.2, 0.2), mass=1e6, at=at) for at in ((8.0, 8.0, 0.0), (8.0, 14.0, 0.0)))
    world = street(cubes, (4.0, 0.0), blocks=(Block("house", (5.0, 8.0, 0.0), (2.0, 4.0, 3.0)),))
    state = begin(LAW, world)
    assert isinstance(state, GaleState)
    for name in list(WINDS)[1:]:
        for part in ("heading", "loss", "cause"):
            getattr(state, f"{name}_{part}").copy_(getattr(state, f"first_{part}"))
    state.way.copy_(state.first_heading)
    course = course_of(LAW, state, world, 100.0)
    most = torch.zeros(2)
    for time in np.arange(0.0, 100.5, 0.5):
        state.time[:] = float(time)
        force = LAW.force(state, world, 1e-6).force[0, :2].norm(dim=-1)
        most = torch.maximum(most, force / (LAW.gain * AIR * 0.04))
    found = course.pressure(world.position[0, :2].numpy().astype(float), 0.0)
    assert found == pytest.approx(most.tolist(), rel=1e-3)
    assert found[0] < 0.5 * found[1] == pytest.approx(0.5 * 1.44, rel=1e-3)  # 1.2 m/s in the open


def test_a_thing_withstands_the_wind_whose_force_on_its_diagonal_is_that_of_friction() -> None:
    """A box that was turned by 45 degrees shows its whole diagonal to a steady wind; 0.5 is its friction."""
    law, size, mass = wind("paper"), (0.3, 0.3, 0.2), 0.7
    turned = (math.cos(math.pi / 8), 0.0, 0.0, math.sin(math.pi / 8))
    pressure = endurance(mass, size, law.gain, 1.0)
    speed = math.sqrt(pressure) / law.scale  # as scenes give it
    world = street((Thing(extent=size, mass=mass, rotation=turned),), (speed, 0.0))
    still = type(law)(**{**vars(law), **STILL})
    force = float(push(still, world, 1e-6).force[0, 0].norm())
    assert force == pytest.approx(0.5 * 9.81 * mass, rel=1e-3)
    assert kept(np.array([0.8, 1.1]) * pressure, pressure).tolist() == [True, False]


def test_what_feels_less_of_the_wind_withstands_more() -> None:
    """A third of the wind is a ninth of its force; the catalogue's resistance 2 leaves a third to a suitcase."""
    assert endurance(3.0, (0.3, 0.2, 0.4), 1400.0, 1 / 3) == pytest.approx(
        9 * endurance(3.0, (0.3, 0.2, 0.4), 1400.0, 1)
    )
    assert endurance(3.0, (0.3, 0.2, 0.4), 1400.0, 0.0) == math.inf
    law = gale("paper")
    assert max(of_models(law, "basket")) < min(of_models(law, "suitcase")) < min(of_models(law, "phone"))
    assert all(law.withstands(category) for category in WIND_POOL) and wind("paper").withstands("bag") == ()
