"""Experiments with water that flows over a floor, whose results hazard_ms.validation.shallow_cases compares."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.flood.buoyancy import CYLINDER
from hazard_ms.hazards.flood.realistic import floor_plan, shallow_water
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition
from hazard_ms.validation.experiments.tank import Thing, room

GRAVITY = 9.81  # [m/s^2]
SMOOTH = Inundation(outside=0.0, roughness=0.0)
Array = NDArray[np.float64]


class Basin:
    """A room whose floor and water are given cell by cell."""

    def __init__(
        self,
        size: tuple[float, float],
        ground: Array | float = 0.0,
        depth: Array | float = 0.0,
        law: Inundation = SMOOTH,
        things: tuple[Thing, ...] = (Thing((0.1,) * 3, at=(0.05, 0.05, 50.0)),),
        openings: tuple[Opening, ...] = (),
        partitions: tuple[Partition, ...] = (),
    ) -> None:
        """Fill a room of `size` [m]; `ground` and `depth`, [X, Y] [m], of cells of floor_plan.CELL."""
        self.law = law
        self.world: World = room(list(things), "south", size, 1, (0.5 * size[0], 0.5 * size[1]), partitions, openings)
        self.state: InundationState = begin(law, self.world)
        if not openings:
            self.state.inlet[:] = -1  # closed on all sides
        self.cells = floor_plan.size_of([spec.room for spec in self.world.specs])
        self.put("bed", np.broadcast_to(ground, self.cells))
        self.put("depth", np.broadcast_to(depth, self.cells))
        self.state.signal[:] = shallow_water.wave(max(float(np.max(depth)), law.outside, 0.01))

    def put(self, name: str, values: Array) -> None:
        """Set a quantity of all cells, [X, Y]."""
        held = getattr(self.state, name)[0].view(self.cells[0] + 2, self.cells[1] + 2)
        held[1:-1, 1:-1] = torch.from_numpy(np.array(values)).to(held)

    def get(self, name: str) -> Array:
        """A quantity of all cells, [X, Y]."""
        held = getattr(self.state, name)[0].view(self.cells[0] + 2, self.cells[1] + 2)
        found: Array = held[1:-1, 1:-1].numpy().astype(np.float64)
        return found

    def run(self, seconds: float, dt: float = 1 / 30) -> None:
        """Let time pass in frames of `dt` [s]."""
        for _ in range(round(seconds / dt)):
            self.world.chance.tick()
            self.law.advance(self.state, self.world, dt)

    @property
    def now(self) -> float:
        """The time that the water is at [s]: it may be ahead of its frame."""
        return float(self.state.time + self.state.ahead)

    @property
    def volume(self) -> float:
        """All of the water [m^3]."""
        return float((self.get("depth") + self.get("depth_rest")).sum()) * floor_plan.CELL**2


@functools.lru_cache(maxsize=2)
def dam_break(behind: float, before: float, seconds: float = 2.0) -> tuple[float, float, float, float]:
    """A dam breaks in a channel 24 m long, with water of the depths `behind` and `before` it [m].

    Returns depth [m] and discharge [m^2/s] at the dam, depth [m] and speed [m/s] a metre downstream, after `seconds`.
    """
    cells = 240
    depth = np.where(np.arange(cells) < cells // 2, behind, before)[:, None]
    basin = Basin((24.0, 0.1), depth=depth)
    basin.run(seconds, 1 / 120)
    dam, ahead = cells // 2, cells // 2 + 10
    depths, speeds = basin.get("depth")[:, 0], basin.get("velocity_x")[:, 0]
    flow = float(basin.get("discharge_x")[dam, 0])
    return float(depths[dam - 1 : dam + 1].mean()), flow, float(depths[ahead]), float(speeds[ahead])


def front(behind: float, before: float, level: float, seconds: float = 2.0, dt: float = 1 / 120) -> float:
    """Speed at which the depth `level` [m] runs downstream after a dam break, in frames of `dt` [s] [m/s]."""
    cells = 240
    depth = np.where(np.arange(cells) < cells // 2, behind, before)[:, None]
    basin = Basin((24.0, 0.1), depth=depth)
    basin.run(seconds, dt)
    depths = basin.get("depth")[:, 0]
    last = int(np.nonzero(depths > level)[0].max())
    beyond = (depths[last] - level) / (depths[last] - depths[last + 1])  # share of a cell
    return (last + 0.5 + beyond - cells // 2) * floor_plan.CELL / basin.now


def refined() -> float:
    """Error of the depth after a dam break onto a dry bed (Ritter), of cells of 0.1 m over that of cells of 0.05 m.

    No length is given in this flow, so after twice the time it is as on cells half as wide.
    """
    coarse, fine = (_ritter_error(0.5, seconds, round(120 * seconds)) for seconds in (2.0, 4.0))
    return coarse / fine


def _ritter_error(behind: float, seconds: float, cells: int) -> float:
    """Sum over the cells of what the depth is off Ritter's solution after `seconds`, over that time [m^2/s]."""
    basin = Basin((floor_plan.CELL * cells, 0.1), depth=np.where(np.arange(cells) < cells // 2, behind, 0.0)[:, None])
    basin.run(seconds, 1 / 120)
    speed = floor_plan.CELL * (np.arange(cells) + 0.5 - cells // 2) / seconds
    wave = math.sqrt(GRAVITY * behind)
    exact = np.where(speed < 2.0 * wave, (2.0 * wave - speed) ** 2 / (9.0 * GRAVITY), 0.0)
    exact = np.where(speed < -wave, behind, exact)
    return float(np.abs(basin.get("depth")[:, 0] - exact).sum()) * floor_plan.CELL / seconds


@functools.lru_cache(maxsize=1)
def bowl(radius: float = 6.0, deep: float = 0.6, swing: float = 0.3) -> tuple[float, float]:
    """Thacker's water with a plane surface that goes round in a paraboloid bowl, after three periods.

    `radius` of the shore and greatest depth at rest [m]; `swing`: share of the radius that the middle goes round at.
    Returns how far out the middle of the mass is, as a share of the start, and its angle [degrees].
    """
    side = 2.0 * 1.4 * radius
    count = math.ceil(side / floor_plan.CELL - 1e-6)
    along = floor_plan.CELL * (np.arange(count) + 0.5) - 0.5 * side
    x, y = np.meshgrid(along, along, indexing="ij")
    ground = deep * (x * x + y * y) / radius**2
    rate = math.sqrt(2.0 * GRAVITY * deep) / radius
    level = deep + swing * deep / radius * (2.0 * x - swing * radius)
    depth = np.maximum(level - ground, 0.0)
    basin = Basin((side, side), ground, depth)
    wet = depth > 0
    speed = swing * radius * rate
    sides = np.zeros_like(depth)
    sides[:, 1:] = speed * (wet[:, 1:] | wet[:, :-1])
    basin.put("velocity_y", sides)
    start = float((depth * x).sum() / depth.sum())
    basin.run(3 * 2.0 * math.pi / rate, 1 / 60)
    now = basin.get("depth")
    out = [float((now * a).sum() / now.sum()) for a in (x, y)]
    return math.hypot(*out) / start, math.degrees(math.atan2(out[1], out[0]))


def at_rest() -> float:
    """Fastest water in a room of plinths of many heights, under a level surface, after 10 s [m/s]."""
    chance = np.random.default_rng(0)
    ground = np.where(chance.random((60, 60)) < 0.3, chance.uniform(0.0, 1.2, (60, 60)), 0.0)
    depth = np.maximum(0.7 - ground, 0.0)
    basin = Basin((6.0, 6.0), ground, depth)
    basin.run(10.0)
    return float(max(np.abs(basin.get(f"velocity_{axis}")).max() for axis in "xy"))


def filled(outside: float, seconds: float) -> tuple[float, float]:
    """A furnished room with a door, with water `outside` [m]: what came in [m^3], and the relative error of mass."""
    chance = np.random.default_rng(1)
    ground = np.where(chance.random((64, 60)) < 0.1, 0.8, 0.0)
    ground[20:30, :3] = 0.0
    basin = Basin((6.4, 6.0), ground, 0.0, Inundation(outside=outside), openings=(door(),))
    basin.run(seconds)
    came = float(basin.state.inflow) + float(basin.state.inflow_rest)
    return came, basin.volume / came - 1.0


def door() -> Opening:
    """A door in the southern wall."""
    return Opening("door", "south", 2.5, 0.9, 2.0)


def inflow(outside: float) -> float:
    """Discharge through an open door into a dry room [m^3/s], in the first frame."""
    basin = Basin((6.4, 6.0), law=replace(SMOOTH, outside=outside), openings=(door(),))
    basin.run(1 / 3000, 1 / 3000)
    return float(basin.state.inflow) * 3000.0


def levelled(fall: float = 0.3) -> tuple[float, float]:
    """Two rooms of 20 m^2, whose levels differ by `fall` [m], joined by a slot of 0.5 m^2 under water along their wall.

    Returns when they are level [s], and the relative error of mass. The root of the difference falls steadily, so nine
    tenths of that time are over when 1 % of it is left.
    """
    wall, slot = Partition("middle", "y", 1.0), Opening("doorway", "middle", 10.0, 20.0, 0.025)
    depth = np.where(np.arange(20) < 10, 1.0 + fall, 1.0)[:, None]
    basin = Basin((2.0, 20.0), depth=depth, openings=(slot,), partitions=(wall,))
    basin.state.inlet[:] = -1
    start, dt, now, left = basin.volume, 1 / 60, 0.0, fall
    while left > 0.01 * fall:
        basin.run(dt, dt)
        depths = basin.get("depth")
        now, before, left = now + dt, left, float(depths[:10].mean() - depths[10:].mean())
    over = (0.01 * fall - left) / (before - left)
    return (now - over * dt) / 0.9, basin.volume / start - 1.0


def gap_under_door(seconds: float) -> float:
    """Depth in a room of 20 m^2 [m], `seconds` after water stands 0.5 m high before its door with a gap of 0.02 m."""
    gap = Opening("door", "south", 2.5, 0.9, 0.02)
    basin = Basin((5.0, 4.0), law=replace(SMOOTH, outside=0.5), openings=(gap,))
    basin.run(seconds)
    return basin.volume / 20.0


def lying(density: float) -> float:
    """Depth under water of the lowest point of a log that lies and floats, in units of its diameter.

    `density`: over that of water. Where its push equals the weight is found by bisection.
    """
    log = Thing((0.2, 0.2, 0.6), 1000.0 * density, (1.55, 0.55, 0.5), (0.5 * math.pi, 0.0, 0.0), CYLINDER)
    basin = Basin((3.0, 1.0), depth=0.5, things=(log,))
    basin.put("surface", np.full(basin.cells, 0.5))
    basin.state.shape[:] = CYLINDER
    basin.state.volume[:] = 0.25 * math.pi * 0.2**2 * 0.6
    weight = log.kilograms * GRAVITY
    low, high = 0.4, 0.6  # heights of the axis
    for _ in range(40):
        middle = 0.5 * (low + high)
        basin.world.position[0, 0, 2] = middle
        push = basin.law.force(basin.state, basin.world, 1e-3)
        assert push is not None
        low, high = (middle, high) if float(push.force[0, 0, 2]) > weight else (low, middle)
    return (0.5 - low + 0.1) / 0.2
