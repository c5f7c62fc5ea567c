"""Doors and panes under load and in fire: they break at the force, and after the time, that their laws say."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch
from torch import Tensor

from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.twozone import leaves
from hazard_ms.simulation.openings import Strain
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Room
from hazard_ms.validation.experiments.basin import SMOOTH
from hazard_ms.validation.experiments.smoke_room import rooms
from tests.hazards.test_openings import DOOR, ONE, WALL, basin, seen
from tests.hazards.test_walls import burning_beside


def bear(world: World, *strains: Strain, seconds: float = 0.1) -> None:
    world.openings.bear(strains, torch.ones(world.num_envs, dtype=torch.bool), seconds)


def test_a_door_breaks_under_water_that_is_too_deep_on_one_side() -> None:
    """3 kN on 0.9 m: rho g w h^2 / 2 says 0.824 m; water on both sides counts by its difference."""
    depth = math.sqrt(2 * 3000.0 / (1000 * 9.81 * 0.9))
    assert 0.6 < depth < 1.0  # what doors hold in floods
    for first, second, breaks in ((depth - 0.01, 0.0, False), (depth + 0.01, 0.0, True), (depth + 0.1, 0.5, False)):
        for turned in (False, True):
            made = basin(DOOR)
            made.put("depth", np.where((np.arange(60)[:, None] < 30) ^ turned, first, second) * np.ones((60, 40)))
            made.world.openings.set_open(ONE, 0, 0.5)
            made.run(1e-3, 1e-3)  # the surface is read from it
            made.world.openings.set_open(ONE, 0, 0.0)
            bear(made.world, made.law.strain(made.state, made.world))
            assert bool(made.world.openings.state.broken[0, 0]) is breaks
            assert seen(made.world, 2.0) is breaks
            made.world.openings.set_open(ONE, 0, 0.0)
            assert seen(made.world, 2.0) is breaks  # nobody shuts what is gone


def test_panes_hold_water_to_their_own_strength_and_outdoors_it_stands_as_deep_as_the_flood() -> None:
    window = Opening("window", "south", 1.0, 1.0, 1.0, 0.4)
    for outside, force in ((0.4, 0.0), (0.8, 1000 * 9.81 * 0.4**2 / 2), (1.4, 1000 * 9.81 / 2)):
        made = basin(window, DOOR, law=dataclasses.replace(SMOOTH, outside=outside))
        strain = made.law.strain(made.state, made.world)
        assert float(strain.force[0, 0]) == pytest.approx(-force, abs=0.01)
        bear(made.world, strain)
        assert bool(made.world.openings.state.broken[0, 0]) is (force > 3500.0)


def test_pressure_of_smoke_breaks_a_door_and_adds_to_that_of_water() -> None:
    """dp over 0.9 x 2.05 m^2: 3 kN is 1,626 Pa."""
    room_of = Room((6.0, 4.0), openings=(DOOR,), partitions=(WALL,))
    for pressure, water, breaks in ((1600.0, 0.0, False), (1650.0, 0.0, True), (1600.0, 100.0, True)):
        state, world = rooms(room_of)
        state.zone_pressure[0, 0] = pressure
        cold = torch.zeros(1, 2 * world.openings.count)
        smoke = leaves.strain(state, world, cold, cold + 20.0, 20.0, 4.5)
        assert float(smoke.force[0, 0]) == pytest.approx(pressure * 0.9 * 2.05, rel=1e-4)
        none = torch.zeros_like(smoke.force)
        bear(world, smoke, Strain(none + water, none, none.bool()))
        assert bool(world.openings.state.broken[0, 0]) is breaks


def standard(minutes: Tensor | float) -> Tensor:
    """Heat [kW/m^2] in the furnace of ISO 834, by its formula, at 10 W/m^2 K."""
    warmth = 345.0 * torch.log10(8.0 * torch.as_tensor(minutes) + 1.0)
    return 5.67e-11 * ((warmth + 293.15) ** 4 - 293.15**4) + 0.010 * warmth


def test_a_leaf_under_the_standard_fire_lasts_as_long_as_its_resistance() -> None:
    spent = torch.zeros(1)
    for second in range(600):
        spent += leaves.ageing(standard(torch.tensor([second / 60])), spent)
    assert float(spent) == pytest.approx(600.0, rel=0.08)  # the first minute does not char
    assert leaves.ageing(torch.tensor([12.0, 13.0]), torch.zeros(2))[0] == 0.0
    twice = leaves.ageing(2.0 * standard(torch.tensor([8.0])), torch.tensor([480.0]))
    assert float(twice) == pytest.approx(2.0, rel=1e-5)


def test_a_door_burns_through_under_a_hot_layer_when_the_rule_says_so() -> None:
    """Under a black layer of 800 C: the integral of q_furnace(t) / q dt from 0 to 600 s, in seconds of fire."""
    world = burning_beside(DOOR)
    law = Blaze()
    state = law.state_type.allocate({"E": 1, "B": 1, **law.sizes(world)}, "cpu")
    law.reset(state, world, ONE)
    state.flame_age[:], state.flame_cell[:] = 0.0, -1
    state.zone_temperature[0, 1], state.zone_emissivity[0, 1], state.zone_height[0, 1] = 800.0, 1.0, 0.5
    hot = 5.67e-11 * (1073.15**4 - 293.15**4) + 0.010 * 780.0
    time = torch.arange(600) / 60 + 1 / 120
    expected = float((standard(time.clamp(min=1.0)) / hot).sum()) / law.time_scale
    passed = 0.0
    while not bool(world.openings.state.broken[0, 0]) and passed < 2 * expected:
        bear(world, law.strain(state, world), seconds=1 / 6)
        passed += 1 / 6
    assert passed == pytest.approx(expected, rel=0.02) and seen(world, 2.0)
