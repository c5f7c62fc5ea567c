"""The wind of `realistic` over the height of what stands in it, W-22 and W-25 of docs/physics.md 2.3.

Expected forces and torques are integrals over the written-out profile by scipy's quadrature, which shares nothing with
the package.
"""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
from scipy.integrate import quad

from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind.wind import Wind
from tests.worlds.fire_worlds import about_z
from tests.worlds.wind_worlds import Block, Thing, begin, push, street

LIFTS = dataclasses.replace(wind("realistic"), by_split=False, scale=1.0, gust_intensity=0.0, sheltered=False)
LAW = dataclasses.replace(LIFTS, lift=0.0)
RHO, BOX = 1.225, 1.05  # density of air [kg/m^3], drag coefficient of boxes [-]
HEAVY = 1e9  # so heavy that the step is of no account [kg]
PHONE = Thing((0.15, 0.075, 0.01), HEAVY, category="box")
BANKNOTE = Thing((0.12, 0.06, 0.0005), HEAVY, category="box")
CARTON = Thing((0.3, 0.3, 0.3), HEAVY, category="box")
DOOR = Thing((0.05, 0.9, 2.0), HEAVY, category="box")
THINGS = {"phone": PHONE, "banknote": BANKNOTE, "carton": CARTON, "door": DOOR}
STORMS = (17.0, 28.0, 40.0)


def air(u10: float, z: float) -> float:
    """Speed [m/s] at `z` [m]: z0 0.03 m above 1 m; below, asphalt of 1 mm counted from 3 mm below its surface."""
    at_join = u10 * math.log(1.0 / 0.03) / math.log(10.0 / 0.03)
    if z >= 1.0:
        return u10 * math.log(z / 0.03) / math.log(10.0 / 0.03)
    return at_join * math.log((z + 0.003) / 0.001) / math.log(1.003 / 0.001)


def load(u10: float, thing: Thing, velocity: float = 0.0) -> tuple[float, float]:
    """Force [N] along the wind and torque [N m] about the centre of an upright box that faces the wind."""
    _, width, height = thing.extent
    base = thing.at[2]
    knots = [z for z in (base, 1.0, base + height) if base <= z <= base + height]

    def per_height(z: float) -> float:
        slip = air(u10, z) - velocity
        return 0.5 * RHO * BOX * width * abs(slip) * slip

    def integral(arm: float, power: int) -> float:
        parts = zip(knots, knots[1:], strict=False)
        return sum(quad(lambda z: per_height(z) * (z - arm) ** power, a, b)[0] for a, b in parts)

    return integral(0.0, 0), integral(base + height / 2, 1)


@pytest.mark.parametrize("u10", STORMS)
@pytest.mark.parametrize("name", THINGS)
def test_force_and_torque_are_the_integrals_of_the_profile(name: str, u10: float) -> None:
    thing = THINGS[name]
    got = push(LAW, street([thing], (u10, 0.0)))
    force, torque = load(u10, thing)
    assert got.torque is not None
    assert float(got.force[0, 0, 0]) == pytest.approx(force, rel=0.01) and force > 0.0
    assert float(got.torque[0, 0, 1]) == pytest.approx(torque, rel=0.03, abs=1e-9)
    assert float(got.force[0, 0, 1:].abs().max()) < 1e-5 * force


@pytest.mark.parametrize("base", [0.2, 0.8, 3.0])
def test_what_flies_feels_the_wind_of_its_own_height(base: float) -> None:
    thing = dataclasses.replace(CARTON, at=(8.0, 8.0, base))
    force, torque = load(28.0, thing)
    got = push(LAW, street([thing], (0.0, 28.0)))
    assert got.torque is not None
    assert float(got.force[0, 0, 1]) == pytest.approx(force, rel=0.005)
    assert float(got.torque[0, 0, 0]) == pytest.approx(-torque, rel=0.02)


def test_a_thing_that_the_wind_carries_feels_what_is_left_at_each_height() -> None:
    """Its top may still be pushed while its base already drags through slower air."""
    speed = air(28.0, 0.15)
    world = street([CARTON], (28.0, 0.0))
    state = begin(LAW, world)
    world.velocity[0, 0, 0] = speed
    got = LAW.force(state, world, 0.01)
    force, torque = load(28.0, CARTON, speed)
    assert got.torque is not None
    still = load(28.0, CARTON)[0]
    assert float(got.force[0, 0, 0]) == pytest.approx(force, abs=0.006 * still) and abs(force) < 0.05 * still
    assert float(got.torque[0, 0, 1]) == pytest.approx(torque, abs=0.005 * still * 0.3) and torque > 0.01 * still * 0.3


def test_the_profile_has_a_limit_on_the_ground_and_no_step_anywhere() -> None:
    heights = [-1.0, 0.0, 1e-6, 0.001, 0.01, 0.1, 0.3, 0.999, 1.0, 1.001, 2.0, 10.0]
    world = street([Thing()], (40.0, 0.0))
    points = torch.tensor([[[8.0, 8.0, z] for z in heights]])
    got = LAW.image(begin(LAW, world), world, points)[0].tolist()
    assert got == pytest.approx([air(40.0, max(z, 0.0)) for z in heights], rel=1e-4)
    assert got[1] == pytest.approx(3.84, abs=0.01)  # 40 x 0.60363 x ln 3 / ln 1003 m/s
    assert got[0] == got[1] == pytest.approx(got[2], rel=1e-3)
    # 0.01 m: "one third" of the wind at 1 m, as the logarithm of 10 over that of 1,000, and the 3 mm
    assert got[4] / got[8] == pytest.approx(math.log(13) / math.log(1003), rel=1e-4)


def test_a_turned_box_feels_its_shadow_over_its_own_height() -> None:
    """A yaw of 45 degrees: the shadow is as wide as the diagonal; upright, so the integral is exact."""
    turned = dataclasses.replace(CARTON, rotation=about_z(math.pi / 4))
    force = push(LAW, street([turned, CARTON], (28.0, 0.0))).force[0, :, 0]
    assert float(force[0] / force[1]) == pytest.approx(math.sqrt(2.0), rel=1e-4)


@pytest.mark.parametrize("dt", [1 / 120, 0.1, 1.0])
def test_no_step_makes_a_light_thing_faster_than_the_air_that_meets_it(dt: float) -> None:
    """From any velocity: the new one is a weighted mean of its own and of those of the air from base to top."""
    things = [Thing((0.3, 0.3, h), m) for h in (0.001, 0.1, 0.5) for m in (1e-4, 1e-2, 1.0)]
    world = street(things, (40.0, 0.0), copies=50)
    state = begin(LAW, world)
    world.velocity.copy_(torch.randn(world.velocity.shape, generator=torch.Generator().manual_seed(3)) * 30.0)
    change = LAW.force(state, world, dt).force * dt / world.mass[..., None]
    after = world.velocity + change
    fastest = torch.tensor([air(40.0, t.extent[2]) for t in things])
    assert (after[..., 0] <= torch.maximum(world.velocity[..., 0], fastest) * (1 + 1e-4) + 1e-3).all()
    assert (after[..., 1:].abs() <= world.velocity[..., 1:].abs() * (1 + 1e-4) + 1e-4).all()
    assert (after.norm(dim=-1) <= torch.maximum(world.velocity.norm(dim=-1), fastest) * (1 + 1e-4) + 1e-3).all()


def test_a_lee_counts_at_each_height() -> None:
    """A wall of 1 m takes 3/4 of the wind up to 0.5 m and nothing at its top: a tall box behind it feels the rest."""
    law = dataclasses.replace(LAW, sheltered=True)
    wall = Block("house", (6.0, 8.0, 0.0), (0.5, 6.0, 1.0))
    tall = Thing((0.2, 0.2, 1.6), HEAVY, (7.0, 8.0, 0.0))
    world = street([tall], (28.0, 0.0), [wall])
    state = begin(law, world)
    got = float(law.force(state, world, 0.01).force[0, 0, 0])
    heights = torch.linspace(0.0005, 1.5995, 1600)
    points = torch.stack([torch.full_like(heights, 7.0), torch.full_like(heights, 8.0), heights], 1)[None]
    speeds = law.image(state, world, points)[0]
    assert got == pytest.approx(0.5 * RHO * BOX * 0.2 * 1.6 * float(speeds.square().mean()), rel=0.03)
    assert got < 0.85 * load(28.0, tall)[0]


def test_a_profile_needs_the_whole_relative_velocity() -> None:
    with pytest.raises(ValueError, match="roughness must be 0 without implicit, projected and crossflow, got 0.03"):
        Wind(roughness=0.03)


@pytest.mark.parametrize("u10", STORMS)
@pytest.mark.parametrize("name", THINGS)
def test_air_over_what_lies_on_the_ground_lifts_it(name: str, u10: float) -> None:
    """0.4 rho u^2 / 2 on its area from above, u at its top; at half its height above the ground half of it, and none
    from its own height on. It neither pushes nor turns.
    """
    length, width, height = THINGS[name].extent
    lying = push(LIFTS, street([THINGS[name]], (0.0, u10)))
    plain = push(LAW, street([THINGS[name]], (0.0, u10)))
    want = 0.4 * 0.5 * RHO * length * width * air(u10, height) ** 2
    assert float(lying.force[0, 0, 2]) == pytest.approx(want, rel=1e-3)
    assert torch.equal(lying.force[..., :2], plain.force[..., :2])
    assert lying.torque is not None and plain.torque is not None and torch.equal(lying.torque, plain.torque)
    for gap, share in ((0.5, 0.5), (1.0, 0.0), (3.0, 0.0)):
        raised = dataclasses.replace(THINGS[name], at=(8.0, 8.0, gap * height))
        got = float(push(LIFTS, street([raised], (0.0, u10))).force[0, 0, 2])
        top = 0.4 * 0.5 * RHO * length * width * air(u10, (1 + gap) * height) ** 2
        assert got == pytest.approx(share * top, rel=5e-3, abs=1e-5 * top)


def test_a_banknote_takes_off_in_a_severe_storm_and_not_in_a_moderate_one() -> None:
    """1 g of 0.12 x 0.06 m, 0.5 mm high as it never lies flat, of which the air must lift the weight."""
    for u10, flies in ((17.0, False), (28.0, True)):
        note = dataclasses.replace(BANKNOTE, mass=1e-3)
        assert (float(push(LIFTS, street([note], (u10, 0.0))).force[0, 0, 2]) > 1e-3 * 9.81) == flies
