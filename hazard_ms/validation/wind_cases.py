"""Wind: cases W of physics.md 2.3, laws in tensors and motion in SAPIEN."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator

import numpy as np
import torch

from hazard_ms.hazards import gusts
from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind import Wind
from hazard_ms.validation.cases import Case, table
from hazard_ms.validation.yard import STILL, Thing, Yard, begin, push, run, street

LAW = Wind(gain=1.0, scale=1.0, **STILL)  # rho A v^2: the paper's, without its gain
SHIPPED = dataclasses.replace(wind("shipped"), **STILL)
AERODYNAMIC = Wind(gain=0.5 * 1.05, scale=1.0, **STILL)
REAL = wind("realistic")
HEAVY = 1e9  # so heavy that the step is of no account [kg]
W1 = {1: (1.30347, 0.7455), 2: (1.92780, 2.39244), 5: (2.70524, 9.56402), 10: (3.12538, 24.33079)}
W2 = {1: 0.82185, 2: 1.34495, 5: 2.17595, 10: 2.74033}
W4 = {(0.06, 1): 1.006, (0.06, 2): 1.540, (0.06, 3): 1.883, (0.06, 5): 2.308, (0.06, 10): 2.807}
W4 |= {(0.2, 1): 3.354, (0.2, 2): 3.383, (0.2, 3): 3.408, (0.2, 5): 3.447, (0.2, 10): 3.509}
W5 = {1: 2.705, 2: 3.125, 3: 3.296, 4: 3.388, 5: 3.447}
W7, W7_SLOW = {5: 0.526}, {10: 5.526, 15: 10.526, 20: 15.526}
W9 = {0.01: (2.150, 0.300, 0, 0), 0.02: (2.604, 0.754, 0.137, 0), 0.06: (3.067, 1.217, 0.601, 0.292), 0.1: (3.210, 1.360, 0.743, 0.435)}
W21, W21_SLOW = {(5.0, 0.1): 1.25, (5.0, 0.15): 1.39, (5.0, 0.2): 1.51, (5.0, 0.3): 1.76}, {(2.0, 0.2): 1.47, (10.0, 0.2): 1.50}
W22 = {(0.005, z): u for z, u in zip((0.1, 0.3, 0.5, 1.0, 2.0), (0.394, 0.539, 0.606, 0.697, 0.788), strict=True)}
W22 |= {(0.03, z): u for z, u in zip((0.1, 0.3, 0.5, 1.0, 2.0), (0.207, 0.396, 0.484, 0.604, 0.723), strict=True)}
W22 |= {(0.1, z): u for z, u in zip((0.3, 0.5, 1.0, 2.0), (0.239, 0.349, 0.500, 0.651), strict=True)}
DRAWS = 100_000


def box(area: float, mass: float, height: float = 0.2, friction: float = 0.5, resistance: float = 0.0) -> Thing:
    """A box whose side is `area` [m^2] across x and y."""
    return Thing((area / height, area / height, height), mass, friction=friction, resistance=resistance)


def apart(things: list[Thing]) -> list[Thing]:
    """Side by side, 10 m from one another across the wind."""
    return [dataclasses.replace(t, at=(0.0, 10.0 * k, 0.0)) for k, t in enumerate(things)]


@functools.cache
def carried(law: Wind) -> dict[int, tuple[float, float]]:
    """Speed [m/s] and way [m] of a free body of 0.5 kg and 0.06 m^2 by time [s], in SAPIEN."""
    yard, seen, now = Yard(law, [box(0.06, 0.5)], gravity=False), {}, 0
    for t in W1:
        yard.run(t - now)
        now = t
        seen[t] = float(yard.speed[0]), float(yard.way[0])
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
    start = yard.way
    yard.run(2.0)
    return dict(zip(shares, [float(moved > 0.02) for moved in yard.way - start], strict=True))


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
    law: Wind, blows: tuple[float, float] = (3.7, 0.0), velocity: tuple[float, float, float] = (0.0, 0.0, 0.0), area: float = 0.06
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
    """Sideways force over the force along the wind, [DRAWS, 3]; the wind blows along x."""
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
    """Standardised gusts of 200 streets over 600 s, [6000, 200]."""
    law = dataclasses.replace(REAL, gust_time=time, sheltered=False)
    world = street([Thing()], copies=200)
    state, made = begin(law, world), []
    for _ in range(round(600 / dt)):
        world.chance.tick()
        state.gust.copy_(gusts.gust(state.gust, dt, time, world.chance.normal("wind.gust")))
        made.append(state.gust.numpy().copy())
    return np.array(made)


def three_seconds(time: float) -> np.ndarray:
    """Means over 3 s, [N, 200]."""
    total = np.cumsum(np.vstack([np.zeros((1, 200)), gust_series(time)]), axis=0)
    return np.asarray((total[30:] - total[:-30]) / 30)


def gust_factor(case: tuple[float, float]) -> float:
    """Mean over 200 streets of the largest 3-s mean over the 600-s mean, for a correlation time [s] and an intensity."""
    time, intensity = case
    return float(((1 + intensity * three_seconds(time).max(0)) / (1 + intensity * gust_series(time).mean(0))).mean())


@functools.cache
def slides(share: float) -> float:
    """Whether 0.6 kg of cardboard slides in a share of its threshold (W-24), in SAPIEN."""
    law = dataclasses.replace(REAL, roughness=0.0, gust_intensity=0.0, scale=1.0)
    thing = Thing((0.4, 0.3, 0.3), 0.6, friction=0.4)
    yard = Yard(law, [thing], (share * 6.3773, 0.0), (30, 120))  # sqrt(2 mu m g / (rho Cd A)), Cd 1.05, A 0.09 m^2
    yard.run(0.5)
    start = yard.way
    yard.run(2.0)
    return float((yard.way - start)[0] > 0.03)


@functools.cache
def topples(share: float) -> float:
    """Whether a slim carton on rough ground topples in a share of its threshold (W-24), in SAPIEN."""
    law = dataclasses.replace(REAL, roughness=0.0, gust_intensity=0.0, scale=1.0)
    yard = Yard(law, [Thing((0.1, 0.3, 0.4), 0.8, friction=1.0)], (share * 5.0421, 0.0), (30, 120))  # sqrt(2 m g b / (rho Cd A h))
    yard.run(4.0)
    return float(1 - 2 * float(yard.world.rotation[0, 0, 1:3].square().sum()) < 0.5)


def of_motion() -> Iterator[Case]:
    """How things move in the wind."""
    yield from table(
        "W-1", "speed of a free body after {} s", {t: v for t, (v, _) in W1.items()}, 0.01, lambda t: carried(LAW)[t][0], unit="m/s"
    )
    yield from table("W-1", "its way after {} s", {t: x for t, (_, x) in W1.items()}, 0.01, lambda t: carried(LAW)[t][1], unit="m")
    yield from table("W-2", "the same with Cd / 2, after {} s", W2, 0.01, lambda t: carried(AERODYNAMIC)[t][0], unit="m/s", slow=True)
    yield from table("W-4", "the original's map (m2, frame) {}", W4, 1e-3, lambda k: by_frame(SHIPPED, k[0])[k[1]], unit="m/s")
    implicit = dataclasses.replace(SHIPPED, implicit=True)
    yield from table("W-5", "implicit step, 0.6 m2, frame {}", W5, 6e-4, lambda n: by_frame(implicit, 0.6)[n], unit="m/s", absolute=True)
    starts = {0.9: 0.0, 0.98: 0.0, 1.02: 1.0, 1.1: 1.0}
    yield from table("W-6", "moves at {} of the threshold", starts, 0, lambda s: threshold()[s])
    yield from table("W-7", "terminal speed on the ground in {} m/s", W7, 0.02, sliding, unit="m/s")
    yield from table("W-7", "terminal speed on the ground in {} m/s", W7_SLOW, 0.02, sliding, unit="m/s", slow=True)
    ground = {(a, r): v for a, row in W9.items() for r, v in enumerate(row)}
    more = {k: v for k, v in ground.items() if v}
    yield from table("W-9", "the original's speed (m2, resistance) {}", more, 0.05, lambda k: on_the_ground()[k], unit="m/s")
    rest = {k: v for k, v in ground.items() if not v}
    yield from table("W-9", "does not move (m2, resistance) {}", rest, 2e-3, lambda k: on_the_ground()[k], unit="m/s", absolute=True)


def of_laws() -> Iterator[Case]:
    """Scaling, turbulence, gusts, profile, thresholds."""
    yield Case("W-10", "twice the wind: force times", 4.0, 1e-5, lambda: force(LAW, (7.4, 0.0)) / force(LAW))
    yield Case("W-10", "no force at the wind's speed", 0.0, 1e-6, lambda: force(LAW, velocity=(3.7, 0.0, 0.0)), "N", absolute=True)
    yield Case("W-10", "moving across changes the force by", 1.0, 1e-6, lambda: force(LAW, velocity=(0.0, 2.0, 0.0)) / force(LAW))
    yield from table("W-11", "share of the force at resistance {}", {1.0: 1 / 4, 2.0: 1 / 9, 3.0: 1 / 16, 11.0: 0.0}, 1e-5, resisting)
    yield Case("W-12", "turbulence: deviation across", 0.05, 0.01, lambda: float(turbulence("shipped")[:, 1].std()))
    yield Case("W-12", "turbulence: mean magnitude", 0.06267, 0.01, lambda: float(turbulence("shipped").norm(dim=1).mean()))
    yield Case("W-12", "turbulence along the wind", 0.0, 0, lambda: float(turbulence("shipped")[:, 0].abs().max()))
    yield Case("W-13", "fixed length: mean magnitude", 0.06802, 0.01, lambda: float(turbulence("paper").norm(dim=1).mean()))
    yield Case("W-13", "fixed length: largest", 0.0866, 1e-3, lambda: float(turbulence("paper").norm(dim=1).max()))
    yield Case("W-20", "variance of 3-s means", 0.8267, 0.05, lambda: float(three_seconds(5.0).var()))
    yield from table("W-21", "gust factor (s, intensity) {}", W21, 0.03, gust_factor, absolute=True)
    yield from table("W-21", "gust factor (s, intensity) {}", W21_SLOW, 0.03, gust_factor, absolute=True, slow=True)
    yield from table("W-22", "profile u / u10 (z0, z) {}", W22, 1e-3, lambda k: at_height(*k), absolute=True)
    yield from table("W-24", "cardboard slides at {} of its threshold", {0.95: 0.0, 1.05: 1.0}, 0, slides, slow=True)
    yield from table("W-24", "a carton topples at {} of its threshold", {0.97: 0.0, 1.03: 1.0}, 0, topples, slow=True)


def cases() -> Iterator[Case]:
    """All of them."""
    yield from of_motion()
    yield from of_laws()
