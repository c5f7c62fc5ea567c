"""Things in the wind, in real physics: W-1, W-2, W-4 to W-7, W-9, W-15 and W-24 of physics.md 2.3, and what follows from them.

Expected values are the tables of physics.md, or exact solutions of the equation of motion, or an integration in small steps.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch
from wind_worlds import GRAVITY, STILL, Thing, Yard

from hazard_ms.assets import index
from hazard_ms.catalogue import CATEGORIES, WIND_POOL
from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind import Wind

LAW = Wind(gain=1.0, scale=1.0, **STILL)  # rho A v^2, the paper's without its gain
SHIPPED = dataclasses.replace(wind("shipped"), **STILL)
SI = Wind(gain=0.5 * 1.05, scale=1.0, **STILL)
RHO = 1.225
CREEP = 0.005  # by which PhysX lets a body slip that static friction should hold, in 3 s just below the threshold [m]


def apart(things: list[Thing]) -> list[Thing]:
    """Side by side, 10 m from one another across the wind."""
    return [dataclasses.replace(t, at=(0.0, 10.0 * k, t.at[2])) for k, t in enumerate(things)]


def box(area: float, mass: float, height: float = 0.2, **more: float) -> Thing:
    """A box whose side is `area` [m^2] across x and y."""
    return Thing((area / height, area / height, height), mass, **more)


def free(k: float, u: float, t: float) -> tuple[float, float]:
    """Speed and way of a free body: dv/dt = k (u - v)^2."""
    return u - u / (1 + k * u * t), u * t - math.log(1 + k * u * t) / k


W1 = {1: (1.30347, 0.7455), 2: (1.92780, 2.39244), 5: (2.70524, 9.56402), 10: (3.12538, 24.33079), 30: (3.48634, 91.60076)}
W2 = {1: 0.82185, 2: 1.34495, 5: 2.17595, 10: 2.74033}


@pytest.mark.parametrize(("rates", "until"), [((100, 100), 30), ((30, 120), 5), ((50, 200), 2)])
def test_w1_a_free_body_is_carried_as_the_paper_says(rates: tuple[int, int], until: int) -> None:
    yard, now = Yard(LAW, [box(0.06, 0.5)], rates=rates, gravity=False), 0
    for seconds, (speed, way) in W1.items():
        if seconds > until:
            return
        yard.run(seconds - now)
        now = seconds
        assert yard.speed[0] == pytest.approx(speed, rel=0.01)
        assert yard.way[0] == pytest.approx(way, rel=0.01)


def test_w2_with_aerodynamic_drag() -> None:
    """The last of the table, at 30 s, follows from the same law: it is left to W-1."""
    yard, now = Yard(SI, [box(0.06, 0.5)], gravity=False), 0
    for seconds, speed in W2.items():
        yard.run(seconds - now)
        now = seconds
        assert yard.speed[0] == pytest.approx(speed, rel=0.01)


@pytest.mark.parametrize("u", [0.7, 3.1, 12.0, 38.0])
def test_w1_other_bodies_and_winds(u: float) -> None:
    """From a sheet of paper to a crate, against the exact solution; the light ones reach the wind's speed and stay below."""
    cases = [(0.5, 0.005), (0.01, 0.02), (0.3, 0.4), (0.09, 3.0), (1.0, 40.0)]
    yard, now = Yard(LAW, apart([box(a, m) for a, m in cases]), (u, 0.0), (30, 120), gravity=False), 0.0
    for seconds in (0.2, 0.9, 4.0):
        yard.run(seconds - now)
        now = round(seconds * 30) / 30
        want = [free(RHO * a / m, u, now) for a, m in cases]
        assert yard.speed == pytest.approx([v for v, _ in want], rel=0.005)
        assert yard.way == pytest.approx([x for _, x in want], rel=0.02, abs=u / 120)
        assert (yard.speed <= u * (1 + 1e-6)).all()


@pytest.mark.parametrize("rate", [25, 50, 100, 200])
def test_the_speed_after_a_second_does_not_depend_on_the_step(rate: int) -> None:
    cases = [(0.06, 0.5), (0.2, 0.03), (0.9, 0.1)]
    yard = Yard(LAW, apart([box(a, m) for a, m in cases]), rates=(25, rate), gravity=False)
    yard.run(1.0)
    assert yard.speed == pytest.approx([free(RHO * a / m, 3.7, 1.0)[0] for a, m in cases], rel=1e-4)


@pytest.mark.parametrize("angle", [0.4, 2.0, -1.7, math.pi])
def test_wind_from_any_side(angle: float) -> None:
    """A turned box shows |cos| of one side and |sin| of the other; it moves along the wind and nowhere else."""
    x, y, z = 0.5, 0.2, 0.3
    blows = (6.0 * math.cos(angle), 6.0 * math.sin(angle))
    yard = Yard(LAW, [Thing((x, y, z), 0.7)], blows, gravity=False)
    yard.run(2.0)
    area = z * (y * abs(math.cos(angle)) + x * abs(math.sin(angle)))
    want, _ = free(RHO * area / 0.7, 6.0, 2.0)
    assert yard.world.velocity[0, 0].numpy() == pytest.approx(want * np.array([math.cos(angle), math.sin(angle), 0.0]), rel=1e-3, abs=1e-5)


W4 = {0.06: {1: 1.006, 2: 1.540, 3: 1.883, 5: 2.308, 10: 2.807}, 0.2: {1: 3.354, 2: 3.383, 3: 3.408, 5: 3.447, 10: 3.509}}


def test_w4_the_originals_map() -> None:
    yard, now = Yard(SHIPPED, apart([box(a, 1.0) for a in W4]), gravity=False), 0
    for frame in (1, 2, 3, 5, 10):
        yard.run((frame - now) / 100)
        now = frame
        assert yard.speed == pytest.approx([W4[a][frame] for a in W4], rel=1e-3)


def test_w5_the_implicit_step_is_monotone_where_the_explicit_one_blows_up() -> None:
    yard = Yard(dataclasses.replace(SHIPPED, implicit=True), [box(0.6, 1.0)], gravity=False)
    for speed in (2.705, 3.125, 3.296, 3.388, 3.447):
        yard.run(0.01)
        assert yard.speed[0] == pytest.approx(speed, abs=6e-4)


def test_w5_the_original_is_held_at_the_winds_speed() -> None:
    yard = Yard(SHIPPED, [box(0.6, 1.0)], gravity=False)
    for _ in range(20):
        yard.run(0.01)
        assert 0.0 < yard.speed[0] <= 3.7 * (1 + 1e-6)


def threshold(thing: Thing, gain: float = 1.0) -> float:
    return math.sqrt(thing.friction * thing.mass * GRAVITY / (gain * RHO * thing.extent[1] * thing.extent[2]))


@pytest.mark.parametrize("rates", [(100, 100), (30, 120)])
def test_w6_wind_below_the_threshold_moves_nothing(rates: tuple[int, int]) -> None:
    """4.474 m/s for 0.5 kg, 0.06 m^2 and a friction of 0.3; felt winds of 0.98 and of 1.02 times that, by resistance."""
    thing = box(0.06, 0.5, friction=0.3)
    assert threshold(thing) == pytest.approx(4.474, abs=5e-4)
    felt = np.array([0.5, 0.9, 0.98, 1.02, 1.1]) * 4.474
    things = apart([dataclasses.replace(thing, resistance=10.0 / f - 1.0) for f in felt])
    yard = Yard(LAW, things, (10.0, 0.0), rates)
    yard.run(1.0)
    start = yard.way
    yard.run(3.0)
    moved = yard.way - start
    assert (moved[:3] < CREEP).all() and (moved[3:] > 0.05).all()


@pytest.mark.parametrize("case", [(1.0, 0.06, 0.3), (2.0, 0.1, 0.5), (0.2, 0.02, 0.15), (0.05, 0.01, 0.8)])
def test_w6_other_bodies(case: tuple[float, float, float]) -> None:
    mass, area, friction = case
    thing = box(area, mass, 0.05, friction=friction)
    u = threshold(thing)
    things = apart([dataclasses.replace(thing, resistance=20.0 / f - 1.0) for f in (0.97 * u, 1.03 * u)])
    yard = Yard(dataclasses.replace(LAW, resistances=False), things, (20.0, 0.0), (30, 120))
    yard.run(0.5)
    start = yard.way
    yard.run(3.0)
    assert (yard.way - start)[0] < CREEP < 0.02 < (yard.way - start)[1]


@pytest.mark.parametrize(("u", "final"), [(5, 0.526), (10, 5.526), (15, 10.526), (20, 15.526)])
def test_w7_terminal_speed_on_the_ground(u: float, final: float) -> None:
    """At 200 steps a second: the step is exact for a free body, and of first order beside friction."""
    yard = Yard(LAW, [box(0.06, 0.5, friction=0.3)], (u, 0.0), (100, 200))
    yard.run(6.0)
    assert yard.speed[0] == pytest.approx(final, rel=0.02)


def sliding(k: float, u: float, friction: float, seconds: float) -> float:
    """Speed after `seconds` from rest on rough ground, in steps of 10 microseconds, in double precision."""
    v, dt = 0.0, 1e-5
    for _ in range(round(seconds / dt)):
        v = max(v + dt * (k * (u - v) * abs(u - v) - friction * GRAVITY), 0.0)
    return v


@pytest.mark.parametrize("case", [(1.3, 0.09, 0.45, 9.0), (0.3, 0.05, 0.6, 7.5)])
def test_w7_on_the_way_to_the_terminal_speed(case: tuple[float, float, float, float]) -> None:
    mass, area, friction, u = case
    yard = Yard(LAW, [box(area, mass, 0.1, friction=friction)], (u, 0.0), (100, 200))
    for seconds in (0.5, 1.5):
        yard.run(seconds if seconds == 0.5 else 1.0)
        assert yard.speed[0] == pytest.approx(sliding(RHO * area / mass, u, friction, seconds), rel=0.03, abs=0.01)


W9 = {0.01: (2.150, 0.300, 0, 0), 0.02: (2.604, 0.754, 0.137, 0), 0.06: (3.067, 1.217, 0.601, 0.292), 0.1: (3.210, 1.360, 0.743, 0.435)}


def test_w9_the_originals_speeds_on_the_ground() -> None:
    things = [box(a, 1.0, math.sqrt(a), friction=0.3, resistance=float(r)) for a in W9 for r in range(4)]
    yard = Yard(SHIPPED, apart(things))
    yard.run(4.0)
    want = np.array([v for row in W9.values() for v in row])
    assert yard.speed == pytest.approx(want, rel=0.05, abs=0.002)


def pool() -> list[tuple[Thing, float]]:
    """Cubes as heavy and as wide as the models of the wind tasks, each in three winds, and how far the original blows 1 kg of such a size
    in a frame [m] (W-9's law). Cubes, since they do not topple.
    """
    made = []
    for kind in (a for a in index().values() if a.category in WIND_POOL):
        resistance, (_, y, z) = CATEGORIES[kind.category].wind_resistance, kind.extent
        for w in (2.5, 3.7, 5.0):
            felt = w / (1 + resistance)
            pace = max(felt - math.sqrt(0.3 * GRAVITY / (100 * RHO * y * z)), 0.0) / 100
            made.append((box(y * z, kind.mass, math.sqrt(y * z), resistance=5.0 / felt - 1), pace))
    return made


def test_w9_the_gain_keeps_the_pace_of_the_original() -> None:
    """Per frame, the models of the wind tasks go as far as 1 kg does in the original: in the mean within a tenth."""
    things, original = zip(*pool(), strict=True)
    paper = dataclasses.replace(wind("paper"), resistances=False, **STILL)
    yard = Yard(paper, apart(list(things)), (5.0, 0.0), rates=(30, 120))
    yard.run(3.0)
    start = yard.way
    yard.run(1.0)
    assert ((yard.way - start) / 30).mean() == pytest.approx(np.mean(original), rel=0.1)
    assert (yard.way - start > 0.02).mean() == pytest.approx(np.mean(np.array(original) > 0), abs=0.1)


def test_w24_sliding_in_the_realistic_wind() -> None:
    """slide at U = sqrt(2 mu m g / (rho Cd A)): 0.6 kg of cardboard, 0.3 m wide and high, friction 0.4; its Cd is 1.05."""
    real = dataclasses.replace(wind("realistic"), roughness=0.0, gust_intensity=0.0, scale=1.0)
    thing = Thing((0.4, 0.3, 0.3), 0.6, friction=0.4)
    u = math.sqrt(2 * 0.4 * 0.6 * GRAVITY / (RHO * 1.05 * 0.09))
    shares = (0.9, 0.98, 1.02, 1.1)
    yard = Yard(real, apart([dataclasses.replace(thing, resistance=2 / s - 1) for s in shares]), (2 * u, 0.0), (30, 120))
    yard.run(0.5)
    start = yard.way
    yard.run(3.0)
    assert ((yard.way - start)[:2] < CREEP).all() and ((yard.way - start)[2:] > 0.05).all()


@pytest.mark.parametrize(("share", "falls"), [(0.97, False), (1.03, True)])
def test_w24_toppling_in_the_realistic_wind(share: float, falls: bool) -> None:
    """topple at U = sqrt(2 m g b / (rho Cd A h)): a slim carton on rough ground."""
    real = dataclasses.replace(wind("realistic"), roughness=0.0, gust_intensity=0.0, scale=1.0)
    thing = Thing((0.1, 0.3, 0.4), 0.8, friction=1.0)
    u = math.sqrt(2 * 0.8 * GRAVITY * 0.1 / (RHO * 1.05 * 0.12 * 0.4))
    yard = Yard(real, [thing], (share * u, 0.0), (30, 120))
    yard.run(4.0)
    up = 1 - 2 * float(yard.world.rotation[0, 0, 1:3].square().sum())
    assert (up < 0.5) == falls


@pytest.mark.parametrize("angle", [0.3, 1.2, -0.8])
def test_a_free_plate_turns_broadside_on(angle: float) -> None:
    """Its normal, at first `angle` from the wind, comes into line with it; it overshoots, as nothing but its spin's own drag stops it."""
    real = dataclasses.replace(wind("realistic"), roughness=0.0, gust_intensity=0.0, scale=1.0)
    turned = (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))
    yard = Yard(real, [Thing((0.02, 0.5, 0.3), 0.4, rotation=turned)], (8.0, 0.0), (50, 200), gravity=False)
    seen = []
    while len(seen) < 100 and (not seen or seen[-1] > 0.0):
        yard.run(0.02)
        w, _, _, z = yard.world.rotation[0, 0].tolist()
        seen.append(2 * math.atan2(z, w) / angle)
    assert seen[-1] <= 0.0 and all(a > b for a, b in zip(seen, seen[1:], strict=False))


@pytest.mark.parametrize("rates", [(100, 100), (30, 120), (50, 200)])
def test_w15_sideways_speed_is_a_random_walk_that_knows_no_frames(rates: tuple[int, int]) -> None:
    """0.05 J sqrt(N) / m after N frames of 0.01 s: bodies so heavy that the force stays what it is at rest; the first frame is steady."""
    many, seconds = 600, 1.0
    yard = Yard(
        dataclasses.replace(wind("shipped"), torque=0.0),
        [box(0.06, 5000.0, at=(0.0, 2.0 * k, 0.0)) for k in range(many)],
        rates=rates,
        gravity=False,
    )
    yard.run(seconds)
    impulse = RHO * 0.06 * 3.7**2  # per 0.01 s
    want = 0.05 * impulse * math.sqrt((seconds - 1 / rates[0]) / 0.01) / 5000.0
    for axis in (1, 2):
        got = yard.world.velocity[0, :, axis]
        assert float(got.std()) == pytest.approx(want, rel=4 * math.sqrt(0.5 / many))
        assert abs(float(got.mean())) < 4 * want / math.sqrt(many)


def storm(seed: int) -> torch.Tensor:
    """20 light things blown into one another in a walled square for three seconds."""
    rng = np.random.default_rng(5)
    places = [(7.4 + 0.3 * (k % 5), 7.2 + 0.3 * (k // 5), 0.0) for k in range(20)]
    things = [Thing(tuple(rng.uniform(0.08, 0.25, 3).tolist()), float(rng.uniform(0.05, 1.0)), at=p) for p in places]
    yard = Yard(wind("paper"), things, (4.0, 2.0), (30, 120), walls=1.5, seed=seed)
    yard.run(3.0)
    assert bool(torch.isfinite(yard.world.position).all()) and float((yard.world.position[0, :, :2] - 8.0).abs().max()) < 1.5
    assert float(np.abs(yard.way).max()) > 0.5
    return torch.cat([yard.world.position, yard.world.rotation, yard.world.velocity], -1)


def test_a_heap_of_blown_things_is_bit_exact() -> None:
    first = storm(3)
    assert torch.equal(first, storm(3))
    assert not torch.equal(first, storm(4))
