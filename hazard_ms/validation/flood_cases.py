"""Floods: cases L of physics.md 2.2, laws in tensors and motion in SAPIEN, and the facts I-1 to I-3 of its integrator."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator

import numpy as np
import torch

from hazard_ms.hazards import wading
from hazard_ms.hazards.presets import flood
from hazard_ms.hazards.water import Water
from hazard_ms.kernels.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.validation.cases import Case, table
from hazard_ms.validation.probes import Immersion, drag, immersion, slab_push
from hazard_ms.validation.tank import Tank, Thing, begin, frames, room

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
SUNK = {0.1: 0.02402, 0.2: 0.09068, 0.5: 0.42981, 1.0: 1.10319}
DRIFT = {(0, 0.1): 0.19106, (0, 0.5): 0.53040, (0, 1.0): 0.68176, (0, 2.0): 0.79522, (0, 5.0): 0.88344}
DRIFT |= {(1, 0.1): 0.13648, (1, 0.5): 0.43404, (1, 1.0): 0.59663, (1, 2.0): 0.73413, (1, 5.0): 0.85194}
ARMS = {2: 0.002911, 5: 0.007307, 10: 0.014831, 15: 0.022807, 20: 0.031522}
TILTED = {0: 0.3, 10: 0.29691, 30: 0.32125, 60: 0.37978, 90: 0.39555}
DEPTHS = {100: 0.0, 500: 0.39518, 1000: 0.89518, 1500: 1.39588}  # at 1500 the slope is 2.98017 degrees already: 1.5 - 2 tan
WET = {0.5: 30, 1.0: 60, 2.0: 110, 3.0: 160, 4.0: 210, 4.74: 250}
CLASSES = {(0.2, 1.0): 1, (0.4, 0.5): 2, (0.6, 0.5): 3, (0.5, 1.5): 4, (1.25, 0.954): 5, (2.5, 0.2): 5, (1.0, 4.5): 6}


def apart(things: list[Thing]) -> list[Thing]:
    """The things, 3 m from each other."""
    return [dataclasses.replace(t, at=(3.0 * k, 10.0, t.at[2])) for k, t in enumerate(things)]


@functools.cache
def floating_depths() -> dict[tuple[int, float], float]:
    """Share of the height that is under water, by shape and density; means over the last 2 of 7 s, in SAPIEN."""
    shapes = {BOX: (0.2, 0.2, 0.2), CYLINDER: (0.3, 0.3, 0.2), BALL: (0.3, 0.3, 0.3)}
    things = apart([Thing(size, 1000 * s, shape=shape) for shape, size in shapes.items() for s in (0.2, 0.5, 0.9)])
    mean = np.array(Tank(STILL, things).run(7.0))[500:, :, 2].mean(0)
    return {(t.shape, t.density / 1000): float((1.0 - z + t.size[2] / 2) / t.size[2]) for t, z in zip(things, mean, strict=True)}


@functools.cache
def heaving() -> dict[float, np.ndarray]:
    """Height above the level at rest [m] of boxes released 1 cm off it, every 0.01 s, by density; in SAPIEN."""
    boxes = apart([Thing((0.2, 0.2, 0.2), 1000 * s, (0.0, 0.0, 1.01 + 0.1 - 0.2 * s)) for s in HEAVE])
    seen = np.array(Tank(STILL, boxes).run(2.6))[:, :, 2]
    return {s: z - (1.1 - 0.2 * s) for s, z in zip(HEAVE, seen.T, strict=True)}


def period(density: float) -> float:
    """Of heaving [s]."""
    off = heaving()[density]
    up = np.nonzero((off[:-1] < 0) & (off[1:] >= 0))[0]
    crossing = up - off[up] / (off[up + 1] - off[up])
    return float(np.diff(crossing)[:2].mean() * 0.01)


@functools.cache
def terminal() -> dict[tuple[float, int, float], float]:
    """Speeds [m/s] after 3 s of sinking or rising, in SAPIEN."""
    things = [Thing((0.1,) * 3, rho, (0.0, 0.0, 50.0 if rho > 1000 else 10.0), shape=shape) for rho, shape, _ in TERMINAL]
    tank = Tank(STILL, apart(things), level=100.0)
    tank.state.drag_coefficient[0] = torch.tensor([c for _, _, c in TERMINAL])
    tank.run(3.0)
    return dict(zip(TERMINAL, tank.world.velocity[0].norm(dim=-1).tolist(), strict=True))


@functools.cache
def sinking() -> dict[float, tuple[float, float]]:
    """Speed [m/s] and way [m] of a cube of 2000 kg/m^3 by time, in SAPIEN in steps of 5 ms."""
    tank = Tank(CUBES, [Thing((0.1,) * 3, 2000.0, (10.0, 10.0, 50.0))], level=100.0, step=0.005)
    seen, done = {}, 0.0
    for t in SINKING:
        tank.run(t - done)
        done = t
        speed = -float(tank.world.velocity[0, 0, 2])
        seen[t] = speed, 50.0 - float(tank.world.position[0, 0, 2]) - speed * 0.0025  # the integrator is half a step ahead, see I-1
    return seen


def first_acceleration(added: float) -> float:
    """Of a ball of 2000 kg/m^3 [m/s^2], in SAPIEN."""
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
    """Of a box turned about an axis, the surface `height` [m] above its centre."""
    turn = torch.tensor(axis) / torch.tensor(axis).norm() * math.sin(math.radians(degrees) / 2)
    rotation = torch.cat([torch.tensor([math.cos(math.radians(degrees) / 2)]), turn])[None]
    return immersion(torch.tensor([height]), torch.zeros(1, 2), rotation, 2 * torch.tensor([half]), torch.tensor([BOX]))


def turning(degrees: float) -> float:
    """Righting torque [N m] of the beam of L-22 at an angle."""
    return 1000.0 * 9.81 * 0.4 * 0.2 * 0.6 * 0.5 * abs(float(wet((0.2, 0.3, 0.1), (0.0, 1.0, 0.0), degrees, 0.0).arm[0, 0]))


def depth_after(count: int) -> float:
    """Water [m] 2 m from the source after so many frames, as the original shows it."""
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
    """Angle of the surface [degrees] so many updates after the cap."""
    world = room([Thing((0.2,) * 3)])
    state = begin(SHIPPED, world)
    world.chance.frame[:] = 1490 + 10 * updates
    SHIPPED.advance(state, world, 0.01)
    return math.degrees(math.atan(float(state.fall)))


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
def fall() -> float:
    """Way [m] of a free fall of 1 s in steps of 0.01 s, in SAPIEN."""
    tank = Tank(STILL, [Thing((0.2,) * 3, 500.0, (10.0, 10.0, 500.0))], level=-1000.0)
    return 500.0 - float(tank.run(1.0)[-1][0, 2])


def of_levels() -> Iterator[Case]:
    """The integrator, and how the original's water rises and carries."""
    yield Case("I-1", "free fall of 1 s in SAPIEN", 4.95405, 1e-4, fall, "m")
    yield Case("L-1", "tangent of the slope", 0.0524078, 1e-5, lambda: math.tan(math.radians(SHIPPED.slope)))
    yield Case("L-1", "current", 0.9540568, 1e-5, lambda: SHIPPED.speed, "m/s")
    yield from table("L-2", "depth 2 m from the source, frame {}", DEPTHS, 2e-5, depth_after, unit="m", absolute=True)
    yield from table("L-3, L-30", "first wet frame {} m from the source", WET, 0, lambda d: first_wet().get(d, -1))
    slopes = {1: 2.98017, 2: 2.96060, 3: 2.94128}
    yield from table("L-4", "slope at update {} of the cap", slopes, 1e-5, slope_after, unit="deg")
    drifts = {(0.01, 1.0): 50, (0.06, 1.0): 8, (0.12, 1.0): 4, (0.06, 5.0): 42}
    yield from table("L-5", "frames to 63 % of the current, (m2, kg) {}", drifts, 0, shipped_frames)


def of_motion() -> Iterator[Case]:
    """How things float, heave, sink and drift."""
    boxes = {(shape, s): s for shape in (BOX, CYLINDER) for s in (0.2, 0.5, 0.9)}
    yield from table("L-10", "share under water of (0 box, 1 cylinder; density) {}", boxes, 0.01, lambda k: floating_depths()[k])
    balls = {0.2: 0.287141, 0.5: 0.5, 0.9: 0.8042}
    yield from table("L-11", "a ball of {} floats at", balls, 0.01, lambda s: floating_depths()[BALL, s])
    yield from table("L-13", "heave period of a box, s = {}", HEAVE, 0.03, period, unit="s")
    yield from table("L-14", "terminal speed (kg/m3, shape, Cd) {}", TERMINAL, 5e-3, lambda k: terminal()[k], unit="m/s")
    yield from table("L-15", "speed of a sinking cube after {} s", SINKING, 0.01, lambda t: sinking()[t][0], unit="m/s")
    yield from table("L-15", "its way after {} s", SUNK, 0.01, lambda t: sinking()[t][1], unit="m")
    yield from table("L-16", "first acceleration of a ball, added mass {}", {0.0: 4.905, 0.5: 3.924}, 1e-3, first_acceleration, unit="m/s2")
    yield from table("L-17", "drift with the current (cube, s) {}", DRIFT, 0.01, lambda k: drifting()[k], unit="m/s", slow=True)


def of_forces() -> Iterator[Case]:
    """Drag and lift as functions, and the classes of danger."""
    yield Case("L-18", "drag at rest in the flow", 0.0, 0, lambda: dragged(0.0, 0.04), "N")
    yield Case("L-18", "drag is odd: sum of both ways", 0.0, 1e-4, lambda: dragged(0.7, 0.04) + dragged(-0.7, 0.04), "N", absolute=True)
    yield Case("L-19", "twice the slip: force times", 4.0, 1e-3, lambda: dragged(0.8, 0.04) / dragged(0.4, 0.04))
    yield Case("L-19", "twice the area: force times", 2.0, 1e-3, lambda: dragged(0.8, 0.08) / dragged(0.8, 0.04))
    box, axis = (0.2, 0.1, 0.05), (1.0, 0.3, 0.0)
    shares = table(
        "L-20", "immersed share of a box at {} degrees", TILTED, 5e-3, lambda a: float(wet(box, axis, a, -0.02).fraction), absolute=True
    )
    yield from shares
    beam, upright = (0.2, 0.3, 0.1), (0.0, 1.0, 0.0)
    arms = table(
        "L-22",
        "righting arm at {} degrees",
        ARMS,
        1e-4,
        lambda a: abs(float(wet(beam, upright, a, 0.0).arm[0, 0])),
        unit="m",
        absolute=True,
    )
    yield from arms
    torques = {2: 0.685, 5: 1.721, 10: 3.492, 15: 5.370, 20: 7.422}
    yield from table("L-22", "righting torque at {} degrees", torques, 0.025, turning, unit="N m")
    yield from table(
        "L-23",
        "a square log of {} rests at",
        {0.15: 0.0, 0.5: 45.0, 0.85: 0.0},
        2.0,
        lambda s: logs()[s],
        unit="deg",
        absolute=True,
        slow=True,
    )
    yield Case(
        "L-25",
        "sideways arm of a level box",
        0.0,
        1e-6,
        lambda: float(wet(beam, upright, 0.0, 0.03).arm[0, :2].abs().max()),
        "m",
        absolute=True,
    )

    def danger(case: tuple[float, float]) -> float:
        return float(wading.hazard_class(torch.tensor([case[0]]), torch.tensor([case[1]])))

    yield from table("3.2", "hazard class at (m, m/s) {}", CLASSES, 0, danger)


def cases() -> Iterator[Case]:
    """All of them."""
    yield from of_levels()
    yield from of_motion()
    yield from of_forces()
