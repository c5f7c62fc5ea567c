"""Experiments with floods, in tensors and in SAPIEN, whose results hazard_ms.validation.flood_cases compares."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.flood.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.hazards.flood.water import Water
from hazard_ms.hazards.presets import flood
from hazard_ms.validation.experiments.probes import Immersion, drag, immersion, slab_push
from hazard_ms.validation.experiments.tank import Tank, Thing, frames, room

PAPER, SHIPPED = flood("paper"), flood("shipped")
STILL = dataclasses.replace(PAPER, gain=0.0)
CUBES = dataclasses.replace(STILL, drag_coefficient=1.05)
HEAVE = {0.2: 0.4012, 0.5: 0.6344, 0.9: 0.8511}
TERMINAL = {  # edge or diameter, density, shape, Cd: m/s
    (2000.0, BOX, 1.05): 1.3670,
    (2700.0, BOX, 1.05): 1.7823,
    (2000.0, BALL, 0.47): 1.6682,
    (500.0, BALL, 0.47): 1.1796,
    (500.0, BOX, 1.05): 0.9666,
}
SINKING = {0.1: 0.47048, 0.2: 0.84130, 0.5: 1.29341, 1.0: 1.36487}
WET = {0.5: 30, 1.0: 60, 2.0: 110, 3.0: 160, 4.0: 210, 4.74: 250}


def apart(things: list[Thing]) -> list[Thing]:
    """The things, 3 m from each other."""
    return [dataclasses.replace(t, at=(3.0 * k, 10.0, t.at[2])) for k, t in enumerate(things)]


@functools.cache
def floating_depths() -> dict[tuple[int, float], float]:
    """Share of the height that is under water, by shape and density; means over the last 2 of 7 s, in SAPIEN."""
    shapes = {BOX: (0.2, 0.2, 0.2), CYLINDER: (0.3, 0.3, 0.2), BALL: (0.3, 0.3, 0.3)}
    things = apart([Thing(size, 1000 * s, shape=shape) for shape, size in shapes.items() for s in (0.2, 0.5, 0.9)])
    mean = np.array(Tank(STILL, things).run(7.0))[500:, :, 2].mean(0)
    return {
        (t.shape, t.density / 1000): float((1.0 - z + t.size[2] / 2) / t.size[2])
        for t, z in zip(things, mean, strict=True)
    }


@functools.cache
def heaving() -> dict[float, np.ndarray]:
    """Height above the level at rest [m], [T], every 0.01 s, of boxes released 1 cm off it, by density; in SAPIEN."""
    boxes = apart([Thing((0.2, 0.2, 0.2), 1000 * s, (0.0, 0.0, 1.01 + 0.1 - 0.2 * s)) for s in HEAVE])
    seen = np.array(Tank(STILL, boxes).run(2.6))[:, :, 2]
    return {s: z - (1.1 - 0.2 * s) for s, z in zip(HEAVE, seen.T, strict=True)}


def period(density: float) -> float:
    """Period of heaving [s] of a box of this relative density."""
    off = heaving()[density]
    up = np.nonzero((off[:-1] < 0) & (off[1:] >= 0))[0]
    crossing = up - off[up] / (off[up + 1] - off[up])
    return float(np.diff(crossing)[:2].mean() * 0.01)


@functools.cache
def rolling(added: float) -> float:
    """Period [s] of rolling of a box 0.4 m wide and 0.8 m long that floats 0.16 m deep, with `added` mass; in SAPIEN.

    It is as high as makes its radius of gyration that of a ship, 0.35 of its width: 0.2744 m.
    """
    box = Thing(
        (0.4, 0.8, 0.2744), 1000 * 0.16 / 0.2744, (10.0, 10.0, 1.0 - 0.16 + 0.1372), (0.0, math.radians(5.0), 0.0)
    )
    tank = Tank(dataclasses.replace(STILL, water=Water(added_mass=added)), [box])
    angles = []
    for _ in range(500):
        tank.run(0.01)
        angles.append(float(torch.atan2(tank.world.rotation[0, 0, 2], tank.world.rotation[0, 0, 0])))
    angle = np.array(angles)
    turns = np.nonzero(np.diff(np.sign(angle)))[0]
    crossing = turns + angle[turns] / (angle[turns] - angle[turns + 1])
    return float(np.diff(crossing).mean()) * 2 * 0.01


@functools.cache
def terminal() -> dict[tuple[float, int, float], float]:
    """Speeds [m/s] after 3 s of sinking or rising, in SAPIEN."""
    things = [
        Thing((0.1,) * 3, rho, (0.0, 0.0, 50.0 if rho > 1000 else 10.0), shape=shape) for rho, shape, _ in TERMINAL
    ]
    tank = Tank(STILL, apart(things), level=100.0)
    tank.state.drag_coefficient[0] = torch.tensor([c for _, _, c in TERMINAL])
    tank.run(3.0)
    return dict(zip(TERMINAL, tank.world.velocity[0].norm(dim=-1).tolist(), strict=True))


@functools.cache
def sinking() -> dict[float, tuple[float, float]]:
    """Speed [m/s] and path [m] of a cube of 2000 kg/m^3 by time, in SAPIEN in steps of 5 ms."""
    tank = Tank(CUBES, [Thing((0.1,) * 3, 2000.0, (10.0, 10.0, 50.0))], level=100.0, step=0.005)
    seen, done = {}, 0.0
    for t in SINKING:
        tank.run(t - done)
        done = t
        speed = -float(tank.world.velocity[0, 0, 2])
        # the integrator is half a step ahead, see I-1
        seen[t] = speed, 50.0 - float(tank.world.position[0, 0, 2]) - speed * 0.0025
    return seen


def first_acceleration(added: float) -> float:
    """First acceleration of a ball of 2000 kg/m^3 [m/s^2], in SAPIEN, with a coefficient of added mass."""
    water = dataclasses.replace(STILL, water=Water(added_mass=added))
    tank = Tank(water, [Thing((0.1,) * 3, 2000.0, (10.0, 10.0, 50.0), shape=BALL)], level=100.0)
    tank.run(0.01)
    return -float(tank.world.velocity[0, 0, 2]) / 0.01


@functools.cache
def drifting() -> dict[tuple[int, float], float]:
    """Speed [m/s] of two upright cubes by number and time, in SAPIEN; they are kept from capsizing."""
    cubes = [Thing((a,) * 3, rho, (0.0, 0.0, 1.0 + a / 2 - rho / 1000 * a)) for a, rho in ((0.2, 500.0), (0.3, 200.0))]
    tank = Tank(dataclasses.replace(CUBES, gain=1.0), apart(cubes))
    for body in tank.world.handles.bodies:  # type: ignore[union-attr]
        body.set_locked_motion_axes([False, False, False, True, True, True])
    seen, done = {}, 0.0
    for t in (0.1, 0.5, 1.0, 2.0, 5.0):
        tank.run(t - done)
        done = t
        for k in range(2):
            seen[k, t] = -float(tank.world.velocity[0, k, 0])
    return seen


@functools.cache
def logs() -> dict[float, float]:
    """Angle [degrees] at which square logs come to rest, by density, 16 s after a release at 2 degrees; in SAPIEN."""
    turned = (math.radians(2.0), 0.0, 0.0)
    things = apart([Thing((1.0, 0.2, 0.2), 1000 * s, (0.0, 0.0, 1.1 - 0.2 * s), turned) for s in (0.15, 0.5, 0.85)])
    tank = Tank(STILL, things, step=0.02)
    tank.run(16.0)
    w, x = tank.world.rotation[0, :, 0].abs(), tank.world.rotation[0, :, 1].abs()
    return dict(zip((0.15, 0.5, 0.85), torch.rad2deg(2 * torch.atan2(x, w)).tolist(), strict=True))


def wet(half: tuple[float, float, float], axis: tuple[float, float, float], degrees: float, height: float) -> Immersion:
    """Immersion of a box of half edges `half` [m] turned about an axis, the surface `height` [m] above its centre."""
    turn = torch.tensor(axis) / torch.tensor(axis).norm() * math.sin(math.radians(degrees) / 2)
    rotation = torch.cat([torch.tensor([math.cos(math.radians(degrees) / 2)]), turn])[None]
    return immersion(torch.tensor([height]), torch.zeros(1, 2), rotation, 2 * torch.tensor([half]), torch.tensor([BOX]))


def turning(degrees: float) -> float:
    """Righting torque [N m] of the beam of L-22 at an angle."""
    lift = 1000.0 * 9.81 * 0.4 * 0.2 * 0.6 * 0.5  # half of it is under water [N]
    return lift * abs(float(wet((0.2, 0.3, 0.1), (0.0, 1.0, 0.0), degrees, 0.0).arm[0, 0]))


def depth_after(count: int) -> float:
    """Water [m] 2 m from the source after this many frames, as the original shows it."""
    world = room([Thing((0.2,) * 3)])
    state = begin(SHIPPED, world)
    world.chance.frame[:] = count
    SHIPPED.advance(state, world, 0.01)
    return float(SHIPPED.image(state, world, torch.tensor([[[18.0, 5.0, 0.0]]])))


@functools.cache
def first_wet() -> dict[float, int]:
    """Frame of the first contact, by distance from the source [m]."""
    world = room([Thing((0.1, 0.1, 0.1), at=(20.0 - d, 10.0, 0.05)) for d in WET])
    state = begin(SHIPPED, world)
    seen: dict[float, int] = {}
    for frame in range(1, 271):
        frames(SHIPPED, state, world, 1)
        for d, damaged in zip(WET, SHIPPED.damaged(state, world)[0].tolist(), strict=True):
            if damaged:
                seen.setdefault(d, frame)
    return seen


def slope_after(updates: int) -> float:
    """Angle of the surface [degrees] this many updates after the cap."""
    world = room([Thing((0.2,) * 3)])
    state = begin(SHIPPED, world)
    world.chance.frame[:] = 1490 + 10 * updates
    SHIPPED.advance(state, world, 0.01)
    return math.degrees(math.atan(float(state.surface_slope)))


def dragged(slip: float, area: float) -> float:
    """Force [N] over a step so short that it is that of the moment."""
    pull = torch.full((1, 3), 0.5 * 1000.0 * 1.05 * area)
    upright, box = torch.tensor([[1.0, 0.0, 0.0, 0.0]]), torch.tensor([False])
    return float(drag(torch.tensor([[slip, 0.0, 0.0]]), upright, pull, torch.tensor([1.0]), box, 1e-7)[0, 0])


def shipped_frames(case: tuple[float, float]) -> float:
    """Frames until a floating thing of an area [m^2] and a mass [kg] has 63 % of the original's current."""
    area, mass = case
    velocity, frame = torch.zeros(1, 3), 0
    one, box, flow = torch.tensor([1.0]), torch.full((1, 3), math.sqrt(area)), torch.tensor([[1.0, 0.0]])
    while float(velocity[0, 0]) < (1 - math.exp(-1)):
        slip = torch.tensor([[1.0, 0.0, 0.0]]) - velocity
        made = slab_push(one, box, slip, flow, torch.tensor([mass]), 9.81, 0.01)
        velocity[0, 0] += made[0, 0] * 0.01 / mass
        frame += 1
    return frame


@functools.cache
def free_fall() -> float:
    """Length [m] of a free fall of 1 s in steps of 0.01 s, in SAPIEN."""
    tank = Tank(STILL, [Thing((0.2,) * 3, 500.0, (10.0, 10.0, 500.0))], level=-1000.0)
    return 500.0 - float(tank.run(1.0)[-1][0, 2])
