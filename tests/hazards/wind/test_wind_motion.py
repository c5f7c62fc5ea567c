"""Free bodies in the wind, in real physics: W-1, W-2, W-4, W-5 and W-15 of docs/physics.md 2.3.

Expected values are the tables of docs/physics.md, or exact solutions of the equation of motion, or an integration in
small steps.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind.wind import Wind
from tests.worlds.wind_worlds import LAW, SHIPPED, STILL, Thing, Yard, apart, box

SI = Wind(gain=0.5 * 1.05, scale=1.0, **STILL)
RHO = 1.225


def free(k: float, u: float, t: float) -> tuple[float, float]:
    """Speed and way of a free body: dv/dt = k (u - v)^2."""
    return u - u / (1 + k * u * t), u * t - math.log(1 + k * u * t) / k


W1 = {
    1: (1.30347, 0.7455),
    2: (1.92780, 2.39244),
    5: (2.70524, 9.56402),
    10: (3.12538, 24.33079),
    30: (3.48634, 91.60076),
}
W2 = {1: 0.82185, 2: 1.34495, 5: 2.17595, 10: 2.74033}


@pytest.mark.parametrize(("rates", "until"), [((100, 100), 30), ((30, 120), 5), ((50, 200), 2)])
def test_a_free_body_is_carried_as_the_paper_says(rates: tuple[int, int], until: int) -> None:
    """W-1 of docs/physics.md."""
    yard, now = Yard(LAW, [box(0.06, 0.5)], rates=rates, gravity=False), 0
    for seconds, (speed, way) in W1.items():
        if seconds > until:
            return
        yard.run(seconds - now)
        now = seconds
        assert yard.speed[0] == pytest.approx(speed, rel=0.01)
        assert yard.path[0] == pytest.approx(way, rel=0.01)


def test_a_free_body_is_carried_with_aerodynamic_drag() -> None:
    """W-2: The last of the table, at 30 s, follows from the same law: it is left to W-1."""
    yard, now = Yard(SI, [box(0.06, 0.5)], gravity=False), 0
    for seconds, speed in W2.items():
        yard.run(seconds - now)
        now = seconds
        assert yard.speed[0] == pytest.approx(speed, rel=0.01)


@pytest.mark.parametrize("u", [0.7, 3.1, 12.0, 38.0])
def test_other_bodies_in_other_winds_follow_the_exact_solution(u: float) -> None:
    """W-1: From a sheet of paper to a crate, against the exact solution; the light ones reach the wind's speed and stay
    below.
    """
    cases = [(0.5, 0.005), (0.01, 0.02), (0.3, 0.4), (0.09, 3.0), (1.0, 40.0)]
    yard, now = Yard(LAW, apart([box(a, m) for a, m in cases]), (u, 0.0), (30, 120), gravity=False), 0.0
    for seconds in (0.2, 0.9, 4.0):
        yard.run(seconds - now)
        now = round(seconds * 30) / 30
        want = [free(RHO * a / m, u, now) for a, m in cases]
        assert yard.speed == pytest.approx([v for v, _ in want], rel=0.005)
        assert yard.path == pytest.approx([x for _, x in want], rel=0.02, abs=u / 120)
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
    assert yard.world.velocity[0, 0].numpy() == pytest.approx(
        want * np.array([math.cos(angle), math.sin(angle), 0.0]), rel=1e-3, abs=1e-5
    )


W4 = {
    0.06: {1: 1.006, 2: 1.540, 3: 1.883, 5: 2.308, 10: 2.807},
    0.2: {1: 3.354, 2: 3.383, 3: 3.408, 5: 3.447, 10: 3.509},
}


def test_speeds_follow_the_originals_map() -> None:
    """W-4 of docs/physics.md."""
    yard, now = Yard(SHIPPED, apart([box(a, 1.0) for a in W4]), gravity=False), 0
    for frame in (1, 2, 3, 5, 10):
        yard.run((frame - now) / 100)
        now = frame
        assert yard.speed == pytest.approx([W4[a][frame] for a in W4], rel=1e-3)


def test_the_implicit_step_is_monotone_where_the_explicit_one_blows_up() -> None:
    """W-5 of docs/physics.md."""
    yard = Yard(dataclasses.replace(SHIPPED, implicit=True), [box(0.6, 1.0)], gravity=False)
    for speed in (2.705, 3.125, 3.296, 3.388, 3.447):
        yard.run(0.01)
        assert yard.speed[0] == pytest.approx(speed, abs=6e-4)


def test_the_original_is_held_at_the_winds_speed() -> None:
    """W-5 of docs/physics.md."""
    yard = Yard(SHIPPED, [box(0.6, 1.0)], gravity=False)
    for _ in range(20):
        yard.run(0.01)
        assert 0.0 < yard.speed[0] <= 3.7 * (1 + 1e-6)


@pytest.mark.parametrize("angle", [0.3, 1.2, -0.8])
def test_a_free_plate_turns_broadside_on(angle: float) -> None:
    """Its normal, at first `angle` from the wind, comes into line with it; it overshoots, as nothing but its spin's own
    drag stops it.
    """
    real = dataclasses.replace(wind("realistic"), by_split=False, roughness=0.0, gust_intensity=0.0, scale=1.0)
    turned = (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))
    yard = Yard(real, [Thing((0.02, 0.5, 0.3), 0.4, rotation=turned)], (8.0, 0.0), (50, 200), gravity=False)
    seen = []
    while len(seen) < 100 and (not seen or seen[-1] > 0.0):
        yard.run(0.02)
        w, _, _, z = yard.world.rotation[0, 0].tolist()
        seen.append(2 * math.atan2(z, w) / angle)
    assert seen[-1] <= 0.0 and all(a > b for a, b in zip(seen, seen[1:], strict=False))


@pytest.mark.parametrize("rates", [(100, 100), (30, 120), (50, 200)])
def test_sideways_speed_is_a_random_walk_that_knows_no_frames(rates: tuple[int, int]) -> None:
    """W-15: 0.05 J sqrt(N) / m after N frames of 0.01 s: bodies so heavy that the force stays what it is at rest; the
    first frame is steady.
    """
    many, seconds = 600, 1.0
    yard = Yard(
        dataclasses.replace(wind("shipped"), torque=0.0),
        [dataclasses.replace(box(0.06, 5000.0), at=(0.0, 2.0 * k, 0.0)) for k in range(many)],
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
