"""Floods in SAPIEN: things float, sink, drift, heave and turn as L-10 to L-17 and L-23 of docs/physics.md say."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.buoyancy import BALL, CYLINDER
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.flood.water import Water
from hazard_ms.hazards.presets import flood
from tests.worlds.flood_worlds import GRAVITY, Tank, Thing, on_a_plane

PAPER = flood("paper")
STILL = dataclasses.replace(PAPER, gain=0.0)
CUBES = dataclasses.replace(STILL, drag_coefficient=1.05)
REAL = dataclasses.replace(on_a_plane(flood("realistic")), gain=0.0, drag_coefficient=1.05, soaks=False)


def row(things: list[Thing]) -> list[Thing]:
    """The things, 3 m from each other."""
    return [dataclasses.replace(t, at=(3.0 * k, 10.0, t.at[2])) for k, t in enumerate(things)]


# So flat that they float upright: a cube of 0.37 turns on its edge after some seconds, from whatever rounds its first
# torque.
BOXES = [Thing(size, 1000 * s) for size in ((0.4, 0.4, 0.2), (0.5, 0.4, 0.12)) for s in (0.2, 0.37, 0.5, 0.9)]
ROUND = [Thing((0.3, 0.3, 0.2), 1000 * s, shape=CYLINDER) for s in (0.2, 0.37, 0.5, 0.9)]
BALLS = [Thing((d, d, d), 1000 * s, shape=BALL) for d in (0.08, 0.3) for s in (0.2, 0.5, 0.9)]


def test_bodies_float_as_archimedes_says() -> None:
    """L-10, L-11: Depth over height is s for boxes and cylinders; .287141, .5, .804200 for spheres of s = .2,
    .5, .9.
    """
    things = row(BOXES + ROUND + BALLS)
    tank = Tank(STILL, things)
    seen = np.array(tank.run(9.0))[600:, :, 2].mean(0)
    spheres = {0.2: 0.287141, 0.5: 0.5, 0.9: 0.804200}
    for thing, z in zip(things, seen, strict=True):
        s, size = thing.density / 1000, thing.size[2]
        assert (1.0 - z + size / 2) / size == pytest.approx(spheres[s] if thing.shape == BALL else s, rel=0.01), thing


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_boxes_heave_with_the_period_of_a_spring(step: float) -> None:
    """L-13: 2 pi sqrt(s H / g), without added mass; released 1 cm off the level."""
    cases = [(0.2, 0.2), (0.5, 0.2), (0.9, 0.2), (0.4, 0.5)]
    tank = Tank(
        STILL, row([Thing((0.2, 0.2, h), 1000 * s, (0.0, 0.0, 1.01 + h / 2 - s * h)) for s, h in cases]), step=step
    )
    seen = np.array(tank.run(3.2))[:, :, 2]
    for (s, high), z in zip(cases, seen.T, strict=True):
        off = z - (1.0 + high / 2 - s * high)
        up = np.nonzero((off[:-1] < 0) & (off[1:] >= 0))[0]
        crossing = up - off[up] / (off[up + 1] - off[up])
        assert np.diff(crossing)[:2].mean() * step == pytest.approx(
            2 * math.pi * math.sqrt(s * high / GRAVITY), rel=0.03
        )


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_bodies_sink_and_rise_at_their_terminal_speed(step: float) -> None:
    """L-14 of docs/physics.md."""
    steel = math.sqrt(2 * 6.85 * 0.2 * GRAVITY / 0.8)
    cases = [
        (Thing((0.1,) * 3, 2000.0, (0.0, 0.0, 50.0)), 1.05, 1.3670),
        (Thing((0.1,) * 3, 2700.0, (0.0, 0.0, 50.0)), 1.05, 1.7823),
        (Thing((0.1,) * 3, 2000.0, (0.0, 0.0, 50.0), shape=BALL), 0.47, 1.6682),
        (Thing((0.1,) * 3, 500.0, (0.0, 0.0, 10.0), shape=BALL), 0.47, 1.1796),
        (Thing((0.1,) * 3, 500.0, (0.0, 0.0, 10.0)), 1.05, 0.9666),
        (Thing((0.05, 0.08, 0.2), 7850.0, (0.0, 0.0, 80.0)), 0.8, steel),
    ]
    tank = Tank(STILL, row([thing for thing, _, _ in cases]), level=100.0, step=step)
    tank.state.drag_coefficient[0] = torch.tensor([c for _, c, _ in cases])
    tank.run(3.0)
    assert tank.world.velocity[0].norm(dim=-1).tolist() == pytest.approx([v for _, _, v in cases], rel=5e-3)


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_a_cube_sinks_from_rest_as_the_exact_solution(step: float) -> None:
    """L-15: v = v_t tanh(g_eff t / v_t); the simulator's scheme puts the place half a step's way ahead (I-1)."""
    tank = Tank(CUBES, [Thing((0.1,) * 3, 2000.0, (10.0, 10.0, 50.0))], level=100.0, step=step)
    fastest, pull, t = 1.3670, 4.905, 0.0
    for span in (0.1, 0.1, 0.3, 0.5):
        tank.run(span)
        t += span
        speed, way = (
            fastest * math.tanh(pull * t / fastest),
            fastest**2 / pull * math.log(math.cosh(pull * t / fastest)),
        )
        assert -float(tank.world.velocity[0, 0, 2]) == pytest.approx(speed, rel=0.01)
        assert 50.0 - float(tank.world.position[0, 0, 2]) == pytest.approx(way + speed * step / 2, rel=0.01)


@pytest.mark.parametrize(("added", "want"), [(0.0, 4.905), (0.5, 3.924)])
def test_added_mass_lessens_the_first_acceleration(added: float, want: float) -> None:
    """L-16 of docs/physics.md."""
    water = dataclasses.replace(STILL, water=Water(added_mass=added))
    tank = Tank(water, [Thing((0.1,) * 3, 2000.0, (10.0, 10.0, 50.0), shape=BALL)], level=100.0)
    tank.run(0.01)
    assert -float(tank.world.velocity[0, 0, 2]) / 0.01 == pytest.approx(want, rel=1e-3)


@pytest.mark.parametrize("step", [0.02, 0.01, 0.005])
def test_floating_cubes_drift_with_the_current(step: float) -> None:
    """L-17: Upright cubes (held so: these would capsize), U = 0.954: v = U - U / (1 + k U t), k = rho Cd A_wet / (2 m)
    = Cd / (2 edge).
    """
    cubes = [
        Thing((a,) * 3, rho, (0.0, 0.0, 1.0 + a / 2 - rho / 1000 * a))
        for a, rho in ((0.2, 500.0), (0.3, 200.0), (0.1, 700.0))
    ]
    tank = Tank(dataclasses.replace(CUBES, gain=1.0), row(cubes), step=step)
    for body in tank.world.handles.bodies:  # type: ignore[union-attr]
        body.set_locked_motion_axes([False, False, False, True, True, True])
    speed, t = 0.9540568, 0.0
    for span in (0.1, 0.4, 0.5, 1.0, 2.0):
        tank.run(span)
        t += span
        want = [speed - speed / (1 + 1.05 / (2 * cube.size[0]) * speed * t) for cube in cubes]
        assert (-tank.world.velocity[0, :, 0]).tolist() == pytest.approx(want, rel=0.01)


@pytest.mark.parametrize("preset", [STILL, REAL], ids=["paper", "realistic"])
def test_logs_find_their_side(preset: Flood) -> None:
    """L-23: Square logs are stable flat for s < .2113 or s > .7887, on an edge at s = .5; released at 2 degrees.

    Rafts right themselves.
    """
    logs = [
        Thing((1.0, 0.2, 0.2), 1000 * s, (0.0, 0.0, 1.1 - 0.2 * s), (math.radians(2.0), 0.0, 0.0))
        for s in (0.15, 0.5, 0.85)
    ]
    rafts = [Thing((0.5, 0.4, 0.1), rho, (0.0, 0.0, 1.0), (0.5, 0.0, 0.0)) for rho in (60.0, 900.0)]
    tank = Tank(preset, row(logs + rafts), step=0.02)
    tank.run(16.0)
    w, x = tank.world.rotation[0, :, 0].abs(), tank.world.rotation[0, :, 1].abs()
    assert torch.rad2deg(2 * torch.atan2(x, w)).tolist() == pytest.approx([0.0, 45.0, 0.0, 0.0, 0.0], abs=2.0)


LIGHT = [
    Thing((0.3, 0.2, 0.003), 60.0, (0.6 * (k % 4), 0.6 * (k // 4), 0.7 + 0.1 * (k % 5)), (0.4 * k, 0.3, 0.1 * k))
    for k in range(12)
]


@pytest.mark.parametrize("step", [1 / 120, 1 / 30])
@pytest.mark.parametrize("preset", ["paper", "realistic"])
def test_sheets_lighter_than_cardboard_come_to_rest(preset: str, step: float) -> None:
    """Lift on 11 g accelerates with 16 g: in steps this long it is a spring too stiff for the simulator's scheme."""
    tank = Tank(dataclasses.replace(on_a_plane(flood(preset)), gain=0.0), LIGHT, step=step)
    heights = np.array([at[:, 2] for at in tank.run(6.0)])
    assert 0.3 < heights.min() and heights.max() < 1.6
    assert np.ptp(heights[-len(heights) // 6 :], axis=0).max() < 0.03


@pytest.mark.parametrize("step", [1 / 100, 1 / 30, 0.1, 1.0])
@pytest.mark.parametrize("preset", ["paper", "shipped", "realistic"])
def test_nothing_blows_up_at_any_step(preset: str, step: float) -> None:
    """Neither sheets nor a body that feels a strong current; the original's law is explicit and needs its limit."""
    flowing = dataclasses.replace(on_a_plane(flood(preset)), gain=5.0)
    tank = Tank(flowing, [*LIGHT, Thing((0.5, 0.5, 0.5), 60.0, (4.0, 4.0, 0.9))], step=step)
    tank.run(100 * step)
    gained = GRAVITY * step * 20
    assert tank.world.position.isfinite().all() and tank.world.velocity.norm(dim=-1).max() < 6.0 + gained


CROWD = [
    Thing(
        (0.15 + 0.02 * (k % 5), 0.2, 0.1 + 0.03 * (k % 3)),
        100.0 + 60.0 * k,
        (8.2 + 0.17 * (k % 3), 9.8 + 0.15 * (k % 4), 0.6 + 0.16 * k),
        (0.3 * k, 0.2, 0.0),
    )
    for k in range(20)
]


@pytest.mark.parametrize("preset", ["paper", "realistic"])
def test_twenty_colliding_bodies_give_the_same_bits_twice(preset: str) -> None:
    runs = []
    for _ in range(2):
        tank = Tank(on_a_plane(flood(preset)), CROWD, floor=True, step=1 / 120)
        tank.run(2.5)
        runs.append((tank.world.position.clone(), tank.world.rotation.clone(), tank.world.velocity.clone()))
    for one, other in zip(*runs, strict=True):
        assert torch.equal(one, other) and one.isfinite().all()
    moved = runs[0][0][0, :, 2]
    assert (moved[:10] > 0.8).all() and (moved[-4:] < 0.6).all()  # the light float, the heavy lie on the floor


def test_what_rests_on_the_floor_floats_up_when_the_water_is_high_enough() -> None:
    for level, floats in ((0.15, False), (0.25, True)):
        tank = Tank(PAPER, [Thing((0.4, 0.4, 0.4), 500.0, (12.0, 10.0, 0.2))], level=level, floor=True, step=1 / 120)
        tank.flood = dataclasses.replace(PAPER, gain=0.0)
        tank.run(3.0)
        assert (float(tank.world.position[0, 0, 2]) > 0.21) == floats
