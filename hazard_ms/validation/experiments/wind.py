"""Experiments with wind, in tensors and in SAPIEN, whose results hazard_ms.validation.wind_cases compares."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
import torch

from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind import gusts
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.validation.experiments.yard import STILL, Thing, Yard, begin, push, run, street

LAW = Wind(gain=1.0, scale=1.0, **STILL)  # rho A v^2: the paper's, without its gain
SHIPPED = dataclasses.replace(wind("shipped"), **STILL)
REAL = wind("realistic")
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


def at_height(roughness: float, height: float) -> float:
    """Wind at a height [m] over ground of a roughness [m] over that at 10 m."""
    law, world = dataclasses.replace(REAL, roughness=roughness, gust_intensity=0.0, sheltered=False), street([Thing()])
    return float(law.image(begin(law, world), world, torch.tensor([[[8.0, 8.0, height]]]))) / float(
        math.hypot(*world.specs[0].wind) * law.scale
    )


@functools.cache
def gust_series(time: float, dt: float = 0.1) -> np.ndarray:
    """Gusts of 200 streets over 600 s in standard deviations [-], [6000, 200]."""
    law = dataclasses.replace(REAL, gust_time=time, sheltered=False)
    world = street([Thing()], copies=200)
    state, made = begin(law, world), []
    for _ in range(round(600 / dt)):
        world.chance.tick()
        state.gust.copy_(gusts.gust(state.gust, dt, time, world.chance.normal("wind.gust")))
        made.append(state.gust.numpy().copy())
    return np.array(made)


def three_seconds(time: float) -> np.ndarray:
    """Means of `gust_series` over 3 s [-], [N, 200]."""
    total = np.cumsum(np.vstack([np.zeros((1, 200)), gust_series(time)]), axis=0)
    return np.asarray((total[30:] - total[:-30]) / 30)


def gust_factor(case: tuple[float, float]) -> float:
    """Mean over 200 streets of the largest 3-s mean over the 600-s mean; correlation time [s] and intensity given."""
    time, intensity = case
    return float(((1 + intensity * three_seconds(time).max(0)) / (1 + intensity * gust_series(time).mean(0))).mean())


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
