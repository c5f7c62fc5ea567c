"""Blows in `realistic`: their energies by mechanics, what they break, and what is none."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
import torch

from hazard_ms.hazards.presets import wind
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.validation.experiments.yard import Yard
from tests.worlds.wind_worlds import Thing, begin, run, street

LAW = dataclasses.replace(wind("realistic"), by_split=False, scale=1.0, gust_intensity=0.0, sheltered=False)
PHONE = (0.15, 0.075, 0.01)  # [m]
RATES = (30, 120)  # frames and physics steps per second


def hardest(yard: Yard, seconds: float) -> tuple[list[float], list[bool]]:
    """Energy of the hardest blow that each thing takes [J], and whether it is damaged at the end."""
    worst = torch.zeros(len(yard.things))
    for _ in range(round(seconds * RATES[0])):
        yard.run(1 / RATES[0])
        worst = torch.maximum(worst, yard.episode.states["wind"].struck[0])
    return worst.tolist(), yard.episode.damage.damaged[0].tolist()


@pytest.mark.parametrize(("height", "breaks"), [(0.5, False), (0.9, False), (1.15, True), (2.0, True)])
def test_electronics_break_by_a_fall_from_more_than_a_metre(height: float, breaks: bool) -> None:
    """IEC 60068-2-31, hand-held equipment. The energy is m g h, less what belongs to the frame of the impact."""
    things = [Thing(PHONE, 0.2, (8.0, 8.0 + k, height), category=kind) for k, kind in enumerate(("phone", "soda_can"))]
    energies, damaged = hardest(Yard(LAW, things, (1.0, 0.0), RATES), 1.5)
    assert energies == pytest.approx([0.2 * 9.81 * height] * 2, rel=0.2)
    assert damaged == [breaks, False]


def test_a_missile_and_what_it_hits_share_its_velocity() -> None:
    """Equal masses, inelastic: each changes by half of 12 m/s, m (v / 2)^2 / 2 = 36 J."""
    things = [Thing((0.2, 0.2, 0.2), 2.0, (x, 8.0, 1.0), category="bottle") for x in (7.0, 8.0)]
    yard = Yard(dataclasses.replace(LAW, scale=1e-6), things, (1.0, 0.0), RATES, gravity=False)
    yard.world.handles.bodies[0].set_linear_velocity([12.0, 0.0, 0.0])  # type: ignore[union-attr]
    yard.run(1 / 30)
    yard.episode.states["wind"].struck.zero_()
    energies, damaged = hardest(yard, 0.5)
    assert energies == pytest.approx([36.0, 36.0], rel=0.05)
    assert damaged == [True, True]  # a bottle bears 30 J


def moved(thing: Thing, velocity: tuple[float, float, float], **world_has: bool) -> Any:
    """The state a frame after a `thing` at rest got a `velocity` [m/s]."""
    world = street([thing], (5.0, 0.0))
    state = begin(LAW, world)
    world.velocity[0, 0] = torch.tensor(velocity)
    for name, value in world_has.items():
        getattr(world, name)[:] = value
    run(LAW, state, world, 1)
    return state, world


def test_a_blow_has_the_energy_of_the_jump_and_lasts_one_frame() -> None:
    state, world = moved(Thing(PHONE, 0.2, category="phone"), (0.0, 6.0, 0.0))
    assert float(state.struck[0, 0]) == pytest.approx(3.6)
    assert LAW.damaged(state, world).tolist() == [[True]]
    run(LAW, state, world, 1)
    assert float(state.struck[0, 0]) == 0.0 and not LAW.damaged(state, world).any()


@pytest.mark.parametrize("what", ["held", "safe"])
def test_what_is_held_or_safe_takes_no_blow(what: str) -> None:
    assert float(moved(Thing(PHONE, 0.2), (0.0, 6.0, 0.0), **{what: True})[0].struck.max()) == 0.0


def test_weight_friction_and_wind_are_no_blows() -> None:
    """Not even for a sheet of paper in a gale, nor where it falls."""
    things = [Thing((0.3, 0.2, 0.001), 0.005, (8.0, 8.0, 30.0)), Thing(PHONE, 0.2, (8.0, 9.0, 30.0))]
    yard = Yard(dataclasses.replace(LAW, gust_intensity=0.172), things, (28.0, 0.0), RATES)
    assert hardest(yard, 1.5)[0] == [0.0, 0.0]


@pytest.mark.parametrize(("kind", "bears"), [("bottle", 30.0), ("mug", 1.5), ("phone", 9.81 * 0.5), ("suitcase", 1e9)])
def test_things_bear_what_their_kind_does(kind: str, bears: float) -> None:
    world = street([Thing(mass=0.5, category=kind)])
    assert float(begin(LAW, world).endurance[0, 0]) == pytest.approx(bears)


@pytest.mark.parametrize(("place", "told"), [((1.2, 1.0, 0.3), 3.6), ((4.0, 1.0, 0.3), 0.0), ((1.2, 1.0, 2.0), 0.0)])
def test_the_agent_is_told_of_blows_that_hit_it(place: tuple[float, float, float], told: float) -> None:
    state, world = moved(Thing(PHONE, 0.2, place), (0.0, 6.0, 0.0))
    world.agent_build = HazardFetch.build  # it stands at (1, 1)
    assert LAW.agent_info(state, world)["agent_struck"].tolist() == pytest.approx([told])


@pytest.mark.parametrize("preset", ["paper", "shipped"])
def test_nothing_breaks_in_paper_and_shipped(preset: str) -> None:
    law, world = wind(preset), street([Thing(PHONE, 0.2, category="phone")])
    state = begin(law, world)
    world.velocity[0, 0] = torch.tensor([0.0, 30.0, 0.0])
    run(law, state, world, 1)
    assert not law.damaged(state, world).any() and float(state.struck.max()) == 0.0
