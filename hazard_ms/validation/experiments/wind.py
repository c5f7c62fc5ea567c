"""Experiments with wind, in tensors and in SAPIEN, whose results hazard_ms.validation.wind_cases compares."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.validation.experiments.yard import STILL, Block, Thing, Yard, push, run, street

LAW = Wind(gain=1.0, scale=1.0, **STILL)  # rho A v^2: the paper's, without its gain
SHIPPED = dataclasses.replace(wind("shipped"), **STILL)
REAL = dataclasses.replace(wind("realistic"), by_split=False)  # in the winds that cases give
HEAVY = 1e9  # mass of a box for which the length of the step does not matter [kg]
W1 = {1: (1.30347, 0.7455), 2: (1.92780, 2.39244), 5: (2.70524, 9.56402), 10: (3.12538, 24.33079)}
W9 = {
    0.01: (2.150, 0.300, 0, 0),
    0.02: (2.604, 0.754, 0.137, 0),
    0.06: (3.067, 1.217, 0.601, 0.292),
    0.1: (3.210, 1.360, 0.743, 0.435),
}
DRAWS = 100_000  # number of random vectors of turbulence


def box(area: float, mass: float, height: float = 0.2, friction: float = 0.5, resistance: float = 0.0) -> Thing:
    """A box whose side is `area` [m^2] across x and y."""
    return Thing((area / height, area / height, height), mass, friction=friction, resistance=resistance)


def apart(things: list[Thing]) -> list[Thing]:
    """The `things` side by side, 10 m from one another across the wind."""
    return [dataclasses.replace(t, at=(0.0, 10.0 * k, t.at[2])) for k, t in enumerate(things)]


@functools.cache
def carried(law: Wind) -> dict[int, tuple[float, float]]:
    """Speed [m/s] and path [m] of a free body of 0.5 kg and 0.06 m^2 by time [s], in SAPIEN."""
    yard, seen, now = Yard(law, [box(0.06, 0.5)], gravity=False), {}, 0
    for t in W1:
        yard.run(t - now)
        now = t
        seen[t] = float(yard.speed[0]), float(yard.path[0])
    return seen


@functools.cache
def by_frame(law: Wind, area: float) -> dict[int, float]:
    """Speed [m/s] of 1 kg by frame of 0.01 s, in SAPIEN."""
    yard, seen = Yard(law, [box(area, 1.0)], gravity=False), {}
    for frame in range(1, 11):
        yard.run(0.01)
        seen[frame] = float(yard.speed[0])
    return seen


@functools.cache
def threshold() -> dict[float, float]:
    """Whether 0.5 kg of 0.06 m^2 moves on a friction of 0.3, by share of the threshold of 4.474 m/s; in SAPIEN."""
    shares = (0.9, 0.98, 1.02, 1.1)
    things = apart([box(0.06, 0.5, friction=0.3, resistance=10.0 / (4.474 * s) - 1.0) for s in shares])
    yard = Yard(LAW, things, (10.0, 0.0))
    yard.run(1.0)
    start = yard.path
    yard.run(2.0)
    return dict(zip(shares, [float(moved > 0.02) for moved in yard.path - start], strict=True))


def sliding(speed: float) -> float:
    """Terminal speed [m/s] of the same on the ground, in SAPIEN."""
    yard = Yard(LAW, [box(0.06, 0.5, friction=0.3)], (speed, 0.0), (100, 200))
    yard.run(6.0)
    return float(yard.speed[0])


@functools.cache
def on_the_ground() -> dict[tuple[float, int], float]:
    """Speeds [m/s] of 1 kg in the original's wind by area [m^2] and resistance, in SAPIEN."""
    keys = [(a, r) for a in W9 for r in range(4)]
    yard = Yard(SHIPPED, apart([box(a, 1.0, math.sqrt(a), 0.3, float(r)) for a, r in keys]))
    yard.run(4.0)
    return dict(zip(keys, yard.speed.tolist(), strict=True))


def force(
    law: Wind,
    blows: tuple[float, float] = (3.7, 0.0),
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    area: float = 0.06,
) -> float:
    """Force [N] on a heavy box."""
    world = street([box(area, HEAVY)], blows)
    world.velocity[0, 0] = torch.tensor(velocity)
    return float(push(law, world).force.norm())


def resisting(resistance: float) -> float:
    """Force with a resistance over force without."""
    made = push(LAW, street([Thing(mass=HEAVY), Thing(mass=HEAVY, resistance=resistance)])).force[0, :, 0]
    return float(made[1] / made[0])


@functools.cache
def turbulence(preset: str) -> torch.Tensor:
    """Sideways force over the force along the wind [-], [DRAWS, 3]; the wind blows along x."""
    law = wind(preset)
    world = street([Thing()], copies=DRAWS)
    state = begin(law, world)
    run(law, state, world, 1, 0.01)
    return state.sway[:, 0]


@functools.cache
def twist() -> torch.Tensor:
    """Torque over the force along the wind [m], [DRAWS, 3], on the default Thing; the wind blows along x."""
    law = wind("shipped")
    world = street([Thing(mass=HEAVY)], copies=DRAWS)
    state = begin(law, world)
    run(law, state, world, 1, 0.01)
    made = law.force(state, world, 0.01)
    assert made.torque is not None
    return made.torque[:, 0] / made.force[:, 0, :1]


@functools.cache
def wandering(rate: int) -> float:
    """Standard deviation of the sideways speed [m/s] of 5 t after 1 s at `rate` frames a second in the original."""
    law = dataclasses.replace(wind("shipped"), torque=0.0)
    world = street([box(0.06, 5000.0)], copies=DRAWS // 5)
    state, speed = begin(law, world), torch.zeros(DRAWS // 5)
    for _ in range(rate):
        run(law, state, world, 1, 1 / rate)
        speed += law.force(state, world, 1 / rate).force[:, 0, 1] / (5000.0 * rate)
    return float(speed.std())


def in_cart(thing: int) -> float:
    """Force and torque [N, N m] on a `thing` after two frames: 0 lies in a cart, 1 on it, 2 beside the cart."""
    heap = [Thing((0.1, 0.1, 0.1), at=at) for at in ((9.0, 12.0, 0.5), (9.0, 12.0, 0.59), (11.0, 12.0, 0.0))]
    law, world = wind("paper"), street(heap, blocks=[Block("cart", (9.0, 12.0, 0.0), (0.53, 0.93, 1.03))])
    state = begin(law, world)
    run(law, state, world, 2)
    made = law.force(state, world, 0.01)
    assert made.torque is not None
    return float((made.force.norm(dim=-1) + made.torque.norm(dim=-1))[0, thing])


def slip_lost(law: Wind) -> float:
    """Share of its slip that 0.1 g of 0.06 m^2 loses in a step of 1 s."""
    world = street([box(0.06, 1e-4)])
    return float(push(law, world, 1.0).force[0, 0, 0]) / 1e-4 / 3.7


def at_height(roughness: float, height: float, pavement: float = 0.0) -> float:
    """Wind at a height [m] over ground of a roughness [m], or on a pavement of one, over that at 10 m."""
    law = dataclasses.replace(REAL, roughness=roughness, pavement=pavement, gust_intensity=0.0, sheltered=False)
    world = street([Thing()])
    return float(law.image(begin(law, world), world, torch.tensor([[[8.0, 8.0, height]]]))) / float(
        math.hypot(*world.specs[0].wind) * law.scale
    )


def in_street(extent: tuple[float, float, float], speed: float) -> float:
    """Force [N] along a storm of a mean `speed` [m/s] at 10 m on a box that stands on the pavement."""
    law = dataclasses.replace(REAL, scale=1.0, gust_intensity=0.0, sheltered=False)
    return float(push(law, street([Thing(extent, HEAVY)], (speed, 0.0))).force[0, 0, 0])


@functools.cache
def gusty(time: float, intensity: float, dt: float = 0.2) -> np.ndarray:
    """Wind at 10 m over the mean one in 200 streets for 600 s [-], [3000, 200]."""
    law = dataclasses.replace(REAL, scale=1.0, gust_time=time, gust_intensity=intensity, sheltered=False)
    world = street([Thing()], (1.0, 0.0), copies=200)
    state, made, point = begin(law, world), [], torch.tensor([[[8.0, 8.0, 10.0]]]).expand(200, 1, 3)
    for _ in range(round(600 / dt)):
        run(law, state, world, 1, dt)
        made.append(law.speed_at(state, world, point)[:, 0].numpy())
    return np.array(made)


def three_seconds(wind: np.ndarray, dt: float = 0.2) -> np.ndarray:
    """Means over 3 s of a series, [N, 200], in its unit, taken every `dt` [s]."""
    total, many = np.cumsum(np.vstack([np.zeros((1, wind.shape[1])), wind]), axis=0), round(3 / dt)
    return np.asarray((total[many:] - total[:-many]) / many)


def gust_factor(case: tuple[float, float]) -> float:
    """Mean over 200 streets of the largest 3-s mean over the 600-s mean; correlation time [s] and intensity given."""
    blown = gusty(*case)
    return float((three_seconds(blown).max(0) / blown.mean(0)).mean())


@functools.cache
def slides(share: float) -> float:
    """Whether 0.6 kg of cardboard slides in a share of its threshold (W-24), in SAPIEN."""
    law = dataclasses.replace(REAL, roughness=0.0, gust_intensity=0.0, scale=1.0)
    thing = Thing((0.4, 0.3, 0.3), 0.6, friction=0.4)
    yard = Yard(law, [thing], (share * 6.3773, 0.0), (30, 120))  # sqrt(2 mu m g / (rho Cd A)), Cd 1.05, A 0.09 m^2
    yard.run(0.5)
    start = yard.path
    yard.run(2.0)
    return float((yard.path - start)[0] > 0.03)


@functools.cache
def topples(share: float) -> float:
    """Whether a slim carton on rough ground topples in a share of its threshold (W-24), in SAPIEN."""
    law = dataclasses.replace(REAL, roughness=0.0, gust_intensity=0.0, scale=1.0)
    # sqrt(2 m g b / (rho Cd A h))
    yard = Yard(law, [Thing((0.1, 0.3, 0.4), 0.8, friction=1.0)], (share * 5.0421, 0.0), (30, 120))
    yard.run(4.0)
    return float(1 - 2 * float(yard.world.rotation[0, 0, 1:3].square().sum()) < 0.5)
