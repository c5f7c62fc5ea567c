"""Experiments with gusts, lees, flight and falls, whose results hazard_ms.validation.storm_cases compares."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
import torch

from hazard_ms.hazards.base import begin
from hazard_ms.spec.registry import ROBOTS, find, load
from hazard_ms.validation.experiments.wind import REAL, gusty, three_seconds
from hazard_ms.validation.experiments.yard import Block, Thing, Yard, run, street

CALM_AIR = dataclasses.replace(REAL, scale=1.0, gust_intensity=0.0)
STREETS = 20_000  # in which gusts are counted
HIGH = 2.0  # height of obstacles [m]
SIDE, PLATE, BLOWS, ALOFT = 0.3, 0.2, 20.0, 60.0  # a plate's edge [m] and mass [kg], wind at 10 m, start [m]
AIR_ALOFT = BLOWS * math.log(ALOFT / 1e-9) / math.log(10.0 / 1e-9)  # wind at the start [m/s]
NEAR = 0.3  # height at which their lee is looked at [m]


@functools.cache
def intensity(height: float) -> float:
    """Deviation of the wind's speed over its mean at a height [m]."""
    law, world = dataclasses.replace(REAL, sheltered=False), street([Thing()], copies=STREETS)
    point = torch.tensor([[[8.0, 8.0, height]]]).expand(STREETS, 1, 3)
    seen = law.speed_at(begin(law, world), world, point)
    return float(seen.std() / seen.mean())


def gust_factor() -> float:
    """Mean over 200 streets of the largest 3-s mean over the 600-s mean at 10 m."""
    blown = gusty(REAL.gust_time, REAL.gust_intensity)
    return float((three_seconds(blown).max(0) / blown.mean(0)).mean())


def behind(category: str, size: tuple[float, float], distance: float, high: float = HIGH) -> float:
    """Share of the wind that is left behind a fixture.

    It is `size` long along the wind and across it, `high`, and `distance` behind its rear, all [m].
    """
    block = Block(category, (8.0, 30.25, 0.0), (*size, high))
    point = torch.tensor([[[8.0 + size[0] / 2 + distance, 30.35, NEAR]]])
    shelter, open_ground = (street([Thing()], (10.0, 0.0), blocks, size=60.0) for blocks in ([block], []))
    left, all_of_it = (float(CALM_AIR.speed_at(begin(CALM_AIR, w), w, point)) for w in (shelter, open_ground))
    return left / all_of_it


@functools.cache
def flights() -> list[tuple[np.ndarray, np.ndarray]]:
    """Paths [m] and speeds [m/s] along the wind, [240] each, after each 1/120 s, of plates at rest at many angles."""
    law, made = dataclasses.replace(CALM_AIR, sheltered=False, roughness=1e-9, pavement=0.0), []
    for angle in range(0, 180, 15):
        turn = math.cos(math.radians(angle) / 2), 0.0, math.sin(math.radians(angle) / 2), 0.0
        plate = Thing((SIDE, SIDE, 0.004), PLATE, (0.0, 8.0, ALOFT), turn, category="plate")
        yard = Yard(law, [plate], (BLOWS, 0.0), (120, 120))
        seen = []
        for _ in range(240):
            yard.run(1 / 120)
            seen.append((float(yard.path[0]), float(yard.speed[0])))
        made.append((np.array([x for x, _ in seen]), np.array([u for _, u in seen])))
    return made


def speed_after(distance: float) -> float:
    """Speed of plates over that of the wind after a `distance` K x*, in 2 m / (rho A)."""
    at = distance * 2.0 * PLATE / (1.225 * SIDE**2)
    return float(np.mean([np.interp(at, path, speed) for path, speed in flights()])) / AIR_ALOFT


def distance_after(time: float) -> float:
    """Distance of plates K x*, in 2 m / (rho A), after a `time` K t*, in 2 m / (rho A U)."""
    unit = 2.0 * PLATE / (1.225 * SIDE**2)
    frame = time * unit / AIR_ALOFT * 120 - 1
    return float(np.mean([np.interp(frame, np.arange(len(path)), path) for path, _ in flights()])) / unit


def topples_at(robot: str) -> float:
    """Steady wind [m/s] at a standing robot's chest that throws it over, to 1 cm/s."""
    world, low, high = street([Thing()], (10.0, 0.0)), 0.0, 100.0
    world.agent_build = load(find(ROBOTS, robot, "robot").robot).build
    law = dataclasses.replace(CALM_AIR, sheltered=False)
    while high - low > 0.01:
        middle, state = 0.5 * (low + high), begin(law, world)
        state.speed *= middle / float(law.agent_info(state, world)["agent_wind"])
        run(law, state, world, 1)
        low, high = (low, middle) if bool(state.lies) else (middle, high)
    return high


def behind_wall(heights: float) -> float:
    """Share of the wind `heights` times its height behind a long, thin, solid wall."""
    return behind("house", (0.3, 60.0), heights * HIGH)


def behind_hedge(heights: float) -> float:
    """Share of the wind `heights` times its height behind a long hedge."""
    return behind("hedge", (0.6, 60.0), heights * HIGH)


def behind_cube(heights: float) -> float:
    """Share of the wind `heights` times its height behind a solid cube."""
    return behind("house", (3.0, 3.0), heights * 3.0, 3.0)


def behind_house(heights: float) -> float:
    """Share of the wind `heights` times its height behind a solid block, four times as wide as high and deep."""
    return behind("house", (3.0, 12.0), heights * 3.0, 3.0)
