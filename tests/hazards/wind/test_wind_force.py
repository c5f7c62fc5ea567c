"""The force of the wind on bodies, by itself: W-10, W-11, W-16 and W-17 of docs/physics.md 2.3, in batches."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.presets import _WIND, wind
from hazard_ms.hazards.wind.wind import Wind
from tests.worlds.fire_worlds import about_z
from tests.worlds.wind_worlds import STILL, Block, Thing, begin, push, run, street

LAW = Wind(gain=1.0, scale=1.0, **STILL)
SHIPPED = dataclasses.replace(wind("shipped"), **STILL)
REAL = dataclasses.replace(
    wind("realistic"), by_split=False, scale=1.0, roughness=0.0, gust_intensity=0.0, sheltered=False
)
RHO = 1.225
HEAVY = 1e9  # so heavy that the step is of no account [kg]
EVERY = pytest.mark.parametrize("preset", _WIND)


@pytest.fixture(params=[1, 64])
def copies(request: pytest.FixtureRequest) -> int:
    return request.param


def test_the_force_at_rest_is_rho_a_v_squared(copies: int) -> None:
    world = street([Thing(mass=HEAVY)], (3.7, 0.0), copies=copies)
    got = push(LAW, world)
    want = torch.tensor([RHO * 0.06 * 3.7**2, 0.0, 0.0])
    assert torch.allclose(got.force, want.expand(copies, 1, 3), rtol=1e-5)
    assert got.torque is not None and (got.torque == 0).all()


@EVERY
@pytest.mark.parametrize("factor", [2.0, 3.0, 0.5])
def test_twice_the_wind_is_four_times_the_force(preset: str, factor: float) -> None:
    """W-10 of docs/physics.md."""
    things = [Thing((0.1, 0.4, 0.2), HEAVY), Thing((0.5, 0.1, 0.3), HEAVY, rotation=about_z(0.7), category="bottle")]
    law = dataclasses.replace(wind(preset), by_split=False)
    one, other = (push(law, street(things, (f * 2.1, f * 1.3))).force for f in (1.0, factor))
    assert torch.allclose(other, factor**2 * one, rtol=1e-5)
    assert (one.norm(dim=-1) > 0.1).all()


@pytest.mark.parametrize("law", [LAW, SHIPPED, REAL])
def test_twice_the_area_is_twice_the_force(law: Wind) -> None:
    """W-10 of docs/physics.md."""
    small, big = Thing((0.3, 0.3, 0.2), HEAVY), Thing((0.3, 0.3, 0.4), HEAVY)
    force = push(law, street([small, big])).force[0, :, 0]
    assert float(force[1] / force[0]) == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize("law", [LAW, SHIPPED])
def test_only_the_velocity_along_the_wind_counts(law: Wind) -> None:
    """W-10: Nothing at the wind's own speed, backwards beyond; what moves across the wind is not slowed."""
    world = street([Thing(mass=HEAVY)] * 4, (3.0, 4.0))
    state = begin(law, world)
    world.velocity[0] = torch.tensor([[3.0, 4.0, 0.0], [4.5, 6.0, 0.0], [4.0, -3.0, 2.0], [0.0, 0.0, 0.0]])
    force = law.force(state, world, 0.01).force[0]
    assert float(force[0].abs().max()) < 1e-3 * float(force[3].norm())
    assert torch.allclose(force[1], -0.25 * force[3], rtol=1e-5, atol=1e-6)
    assert torch.allclose(force[2], force[3], rtol=1e-5, atol=1e-6)


def test_the_realistic_wind_takes_all_of_the_relative_velocity() -> None:
    """Galilei: adding one velocity to wind and body changes nothing."""
    still = street([Thing((0.2, 0.2, 0.2), HEAVY)], (3.0, -4.0))
    moving = street([Thing((0.2, 0.2, 0.2), HEAVY)], (1.0, -2.0))
    moving.velocity[0, 0] = torch.tensor([-2.0, 2.0, 0.0])
    assert torch.allclose(push(REAL, still).force, push(REAL, moving).force, rtol=1e-5)
    falling = street([Thing((0.2, 0.2, 0.2), HEAVY)], (1e-2, 0.0))
    falling.velocity[0, 0, 2] = -5.0
    assert float(push(REAL, falling).force[0, 0, 2]) == pytest.approx(0.5 * RHO * 1.05 * 0.04 * 25.0, rel=3e-3)


@pytest.mark.parametrize("resistance", [0.0, 0.4, 1.0, 2.0, 3.0, 10.0])
def test_resistance_lessens_the_force(copies: int, resistance: float) -> None:
    """W-11 of docs/physics.md."""
    force = push(LAW, street([Thing(mass=HEAVY), Thing(mass=HEAVY, resistance=resistance)], copies=copies)).force[
        ..., 0
    ]
    assert torch.allclose(force[:, 1] / force[:, 0], torch.tensor(1.0 / (resistance + 1.0) ** 2), rtol=1e-5)


def test_a_resistance_above_ten_feels_no_wind_and_scenes_overrule_the_catalogue() -> None:
    """W-11 of docs/physics.md."""
    things = [
        Thing(resistance=r, category=c)
        for r, c in ((10.01, "bottle"), (None, "bag"), (None, "phone"), (0.5, "phone"), (None, "rescue_bag"))
    ]
    state = begin(LAW, street(things))
    assert state.felt[0].tolist() == pytest.approx([0.0, 1 / 2, 1 / 4, 1 / 1.5, 0.0])
    state = begin(wind("realistic"), street(things))  # true masses and areas: only what a scene says counts
    assert state.felt[0].tolist() == pytest.approx([0.0, 1.0, 1.0, 1 / 1.5, 0.0])


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.5, 0.0), (1.2, 0.9), (-0.4, 2.2)])
def test_the_area_is_that_of_the_boxs_shadow(angles: tuple[float, float]) -> None:
    """Against the area of the convex hull of the corners as seen along the wind, and the box that the original
    takes.
    """
    turn = rotation_of(*angles)
    x, y, z = 0.5, 0.2, 0.3
    corners = torch.tensor(
        [[a * x / 2, b * y / 2, c * z / 2] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)], dtype=torch.float64
    )
    seen = corners @ turn.T
    world = street([Thing((x, y, z), HEAVY)], (2.0, 0.0))
    world.rotation[0, 0] = quaternion_of(*angles)
    assert float(push(LAW, world).force[0, 0, 0]) == pytest.approx(RHO * 4.0 * hull_area(seen[:, 1:]), rel=1e-4)
    side = (seen[:, 0].max() - seen[:, 0].min()) * (seen[:, 2].max() - seen[:, 2].min())
    assert float(push(SHIPPED, world).force[0, 0, 0]) == pytest.approx(100 * RHO * 4.0 * float(side), rel=1e-4)


def rotation_of(about_z_: float, about_x: float) -> torch.Tensor:
    (c, s), (d, t) = ((math.cos(a), math.sin(a)) for a in (about_z_, about_x))
    first = torch.tensor([[1, 0, 0], [0, d, -t], [0, t, d]], dtype=torch.float64)
    return torch.tensor([[c, -s, 0], [s, c, 0], [0, 0, 1]], dtype=torch.float64) @ first


def quaternion_of(about_z_: float, about_x: float) -> torch.Tensor:
    (c, s), (d, t) = ((math.cos(a / 2), math.sin(a / 2)) for a in (about_z_, about_x))
    return torch.tensor([c * d, c * t, s * t, s * d])


def hull_area(points: torch.Tensor) -> float:
    from scipy.spatial import ConvexHull

    return float(ConvexHull(points.numpy()).volume)


@settings(max_examples=60, deadline=None)
@given(
    preset=st.sampled_from(["paper", "shipped"]),
    edges=st.tuples(*[st.floats(0.005, 2.0)] * 3),
    mass=st.floats(1e-4, 100.0),
    speed=st.floats(-20.0, 20.0),
    u=st.floats(0.5, 60.0),
    dt=st.sampled_from([0.002, 0.01, 0.1, 1.0]),
)
def test_a_step_never_overshoots_the_flow(
    preset: str, edges: Any, mass: float, speed: float, u: float, dt: float
) -> None:
    """W-17 of docs/physics.md."""
    law = dataclasses.replace(wind(preset), by_split=False, scale=1.0, **STILL)
    world = street([Thing(edges, mass)], (u, 0.0))
    state = begin(law, world)
    world.velocity[0, 0, 0] = speed
    change = float(law.force(state, world, dt).force[0, 0, 0]) * dt / mass
    slip = float(state.speed[0]) - float(world.velocity[0, 0, 0])
    assert abs(change) <= abs(slip) * (1 + 1e-5) and change * slip >= 0.0


@EVERY
def test_nothing_touches_what_is_held_safe_settled_fixed_or_absent(preset: str) -> None:
    """W-16 of docs/physics.md."""
    world = street(
        [Thing(at=(8.0, float(k), 0.0)) for k in range(6)],
        blocks=[Block("house", (2.0, 2.0, 0.0), (2.0, 2.0, 3.0))],
        copies=3,
    )
    law = wind(preset)
    state = begin(law, world)
    run(law, state, world, 3)
    world.velocity.normal_(), world.angular_velocity.normal_()
    world.held[:, 1], world.safe[:, 2], state.settled[:, 3], world.exists[:, 4] = True, True, True, False
    got = law.force(state, world, 0.01)
    felt = [0, 5]
    assert got.torque is not None
    assert (got.force[:, felt].norm(dim=-1) > 0).all()
    others = [1, 2, 3, 4, 6]
    assert (got.force[:, others] == 0).all() and (got.torque[:, others] == 0).all()


@pytest.mark.parametrize("angles", [(0.5, 0.0), (1.3, 0.0), (0.4, 1.1), (2.0, -0.6)])
def test_the_pressure_of_the_realistic_wind_acts_upwind_of_the_centre(angles: tuple[float, float]) -> None:
    """By a fifth of each edge, times how far the wind goes along it; square to the wind, or for a cube, that is no
    torque.
    """
    extent = torch.tensor([0.6, 0.1, 0.4], dtype=torch.float64)
    world = street([Thing(tuple(extent.tolist()), HEAVY)] * 2 + [Thing((0.3, 0.3, 0.3), HEAVY)], (0.0, 3.0))
    world.rotation[0, 1] = world.rotation[0, 2] = quaternion_of(*angles)
    got = push(REAL, world)
    assert got.torque is not None
    size = float(got.force[0, 1].norm())
    assert float(got.torque[0, [0, 2]].abs().max()) < 1e-6 * size
    turn = rotation_of(*angles)
    wind_b = turn.T @ torch.tensor([0.0, 1.0, 0.0], dtype=torch.float64)
    want = torch.linalg.cross(turn @ (-0.2 * extent * wind_b), got.force[0, 1].double())
    assert torch.allclose(got.torque[0, 1].double(), want, rtol=1e-3, atol=1e-6 * size)
    assert float(want.norm()) > 0.01 * size


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_the_realistic_air_slows_turning(angle: float) -> None:
    """MuJoCo's box: torque rho b_i (b_j^4 + b_k^4) w^2 / 64 about each axis of the box, against its turning."""
    world = street([Thing((0.4, 0.3, 0.2), HEAVY, rotation=about_z(angle))], (2e-3, 0.0))
    state = begin(REAL, world)
    world.angular_velocity[0, 0] = torch.tensor([0.0, 0.0, 9.0])
    got = REAL.force(state, world, 0.01).torque
    assert got is not None
    assert got[0, 0].tolist() == pytest.approx(
        [0.0, 0.0, -RHO * 0.2 * (0.4**4 + 0.3**4) * 81.0 / 64], rel=1e-3, abs=1e-7
    )


@pytest.mark.parametrize(("preset", "dt", "steps"), [("shipped", 0.01, 1), ("paper", 1 / 120, 4)])
def test_only_along_the_wind_does_nothing_outrun_it_in_paper_and_shipped(preset: str, dt: float, steps: int) -> None:
    """A feather that something holds back along the wind: each step turns the whole slip U into a push of m U / dt, of
    which the share r goes sideways, where nothing brakes it. After N frames that is 0.05 sqrt(0.01 s / frame) U per
    step, times sqrt(N): more than the wind itself after 400 frames or fewer.
    """
    law = dataclasses.replace(wind(preset), torque=0.0)
    world = street([Thing((0.2, 0.3, 0.2), 1e-6)], (2.85, 0.0), copies=400)
    state, frames = begin(law, world), 450
    for _ in range(frames):
        run(law, state, world, 1, steps * dt)
        for _ in range(steps):
            force = law.force(state, world, dt).force
            assert float(force[..., 0].max()) * dt / 1e-6 <= 2.85 * law.scale * (1 + 1e-5)
            world.velocity[..., 1:] += force[..., 1:] * dt / 1e-6
    across = world.velocity[..., 1:].std()
    want = 0.05 * math.sqrt(0.01 / (steps * dt)) * steps * 2.85 * law.scale * math.sqrt(frames)
    assert float(across) == pytest.approx(want, rel=4 * math.sqrt(0.5 / 800))
    assert float(across) > 2.85 * law.scale
