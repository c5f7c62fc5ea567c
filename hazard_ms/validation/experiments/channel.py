"""Experiments with water in straight channels and flumes, whose results hazard_ms.validation.flume_cases compares."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.validation.experiments.basin import GRAVITY, SMOOTH, Array, Basin

ENDS = 6  # cells at either end that are given what the experiment wants
BUMP = (0.2, 10.0, 2.0)  # height, middle and half width of the bump of Goutal and Maurel [m]


class Channel(Basin):
    """A channel one cell wide, along x, with closed ends."""

    def __init__(
        self,
        cells: int,
        ground: Array | float = 0.0,
        depth: Array | float = 0.0,
        speed: float = 0.0,
        rough: float = 0.0,
    ) -> None:
        """Of so many `cells`; `ground` and `depth` [m] of each; water of `speed` [m/s]; `rough`: Manning's n."""
        ground, depth = (np.broadcast_to(of, cells)[:, None] for of in (ground, depth))
        super().__init__((CELL * cells, CELL), ground, depth, replace(SMOOTH, roughness=rough))
        self.put("velocity_x", np.full((cells, 1), speed))
        self.put("discharge_x", speed * depth)

    def line(self, name: str) -> Array:
        """A quantity of all cells, [X]."""
        return self.get(name)[:, 0]

    def fix(self, over: slice, depth: float, speed: float) -> None:
        """Give the cells `over` water of this depth [m] and speed [m/s]."""
        for name, value in (("depth", depth), ("velocity_x", speed), ("discharge_x", depth * speed)):
            values = self.get(name)
            values[over] = value
            self.put(name, values)

    def copy(self, cell: int, over: slice) -> None:
        """Give the cells `over` the depth and the motion of `cell`."""
        for name in ("depth", "velocity_x", "discharge_x"):
            values = self.get(name)
            values[over] = values[cell]
            self.put(name, values)

    def between(self, seconds: float, discharge: float, level: float, dt: float = 1 / 120) -> None:
        """Run with `discharge` [m^2/s] let in at one end, and the surface at `level` [m] at the other."""
        for _ in range(round(seconds / dt)):
            self.run(dt, dt)
            self.copy(-ENDS - 1, slice(-ENDS, None))
            depth = self.get("depth")
            depth[:ENDS] += discharge * dt / (ENDS * CELL)
            depth[-ENDS:] = level - self.get("bed")[-ENDS:]
            self.put("depth", depth)


def middles(cells: int) -> Array:
    """Places of the middles of cells [m], [X]."""
    return np.array([CELL * (k + 0.5) for k in range(cells)])


def slowed(seconds: float = 5.0) -> float:
    """Speed [m/s] of water 0.1 m deep that ran at 1 m/s over a level floor of n = 0.012, after `seconds`."""
    channel = Channel(400, depth=0.1, speed=1.0, rough=0.012)
    channel.run(seconds)
    return float(channel.line("velocity_x")[200])


def uniform(case: tuple[float, float], rough: float = 0.012) -> float:
    """Speed [m/s] at which water of a depth [m] runs down a slope for ever; it starts at half of that of n = 0.01."""
    deep, slope = case
    cells = 40
    channel = Channel(cells, slope * (CELL * cells - middles(cells)), deep, 50.0 * deep ** (2 / 3) * slope**0.5, rough)
    for _ in range(round(30 * 6.0 * deep ** (2 / 3) / (rough * 2.0 * GRAVITY * slope**0.5))):  # 6 times of relaxation
        channel.run(1 / 30)
        for end in (slice(0, ENDS), slice(-ENDS, None)):
            channel.copy(cells // 2, end)
    return float(channel.line("velocity_x")[cells // 2])


def reflected(seconds: float = 5.0) -> tuple[float, float]:
    """Stoker's bore, 0.5 m of water into 0.05 m, comes back from a wall 4 m behind the dam.

    Returns the depth behind it [m], and its speed over the floor [m/s].
    """
    cells, dam = 160, 120
    channel = Channel(cells, 0.0, np.where(np.arange(cells) < dam, 0.5, 0.05))
    channel.run(seconds - 1.0, 1 / 120)
    first, start = _bore(channel.line("depth"), 0.34), channel.now
    channel.run(1.0, 1 / 120)
    now = channel.line("depth")
    return float(now[-5:].mean()), (first - _bore(now, 0.34)) / (channel.now - start)


def surge(seconds: float = 6.0) -> tuple[float, float]:
    """Water 0.3 m deep runs at 1 m/s against a closed gate: depth at the gate, and speed of the surge upstream."""
    channel = Channel(400, depth=0.3, speed=1.0)
    channel.run(seconds / 2, 1 / 120)
    first, start = _bore(channel.line("depth"), 0.4), channel.now
    channel.run(seconds / 2, 1 / 120)
    now = channel.line("depth")
    return float(now[-5:].mean()), (first - _bore(now, 0.4)) / (channel.now - start)


def _bore(depth: Array, level: float) -> float:
    """Place of the last depth below `level`, from the closed end back [m]."""
    last = int(np.nonzero(depth < level)[0].max())
    return CELL * (last + 0.5 + float((level - depth[last]) / (depth[last + 1] - depth[last])))


def parabola(half: float = 5.0, deep: float = 0.5, swing: float = 0.3) -> tuple[float, float]:
    """Water with a plane surface that swings in a parabola: period [s], and the swing left after two periods [-]."""
    cells = 160
    x = middles(cells) - 0.5 * CELL * cells
    ground = deep * x * x / half**2
    channel = Channel(cells, ground, np.maximum(deep * (1.0 - (x / half - swing) ** 2), 0.0))
    places, times = [], []
    period = 2.0 * math.pi * half / math.sqrt(2.0 * GRAVITY * deep)
    for _ in range(round(120 * 2.0 * period)):
        channel.run(1 / 120, 1 / 120)
        depth = channel.line("depth")
        places.append(float((depth * x).sum() / depth.sum()))
        times.append(channel.now)
    at, sign = np.array(places), np.sign(places)
    turns = [times[k] + (times[k + 1] - times[k]) * at[k] / (at[k] - at[k + 1]) for k in np.nonzero(np.diff(sign))[0]]
    return (turns[-1] - turns[0]) / (0.5 * (len(turns) - 1)), places[-1] / (swing * half)


def dish(share: float, radius: float = 6.0, shore: float = 4.8, deep: float = 0.6) -> float:
    """Depth [m] in the middle of a round dish in which water heaves, after a `share` of a period [Thacker 1981]."""
    cells = 170
    along = middles(cells) - 0.5 * CELL * cells
    x, y = np.meshgrid(along, along, indexing="ij")
    out = (x * x + y * y) / radius**2
    part = (radius**2 - shore**2) / (radius**2 + shore**2)
    level = deep * (
        math.sqrt(1.0 - part * part) / (1.0 - part) - 1.0 - out * ((1.0 - part**2) / (1.0 - part) ** 2 - 1.0)
    )
    ground = deep * (out - 1.0)
    basin = Basin((CELL * cells, CELL * cells), ground + deep, np.maximum(level - ground, 0.0))
    basin.run(share * 2.0 * math.pi * radius / math.sqrt(8.0 * GRAVITY * deep), 1 / 120)
    return float(basin.get("depth")[84:86, 84:86].mean())


def run_up(high: float = 0.0185, deep: float = 1.0, slope: float = 1 / 19.85, seconds: float = 20.0) -> float:
    """Height [m] over the still water, `deep` [m], that a solitary wave `high` [m] climbs on a beach [Synolakis 1987].

    It starts 14 m before the beach. What is less than 0.1 mm deep is not seen.
    """
    shore, start = 30.0, 16.0
    cells = round((shore + 1.3 * deep / slope) / CELL)
    x, sides = middles(cells), CELL * np.arange(cells)
    ground = np.maximum((x - shore) * slope, 0.0)
    wave, there = (high / np.cosh(math.sqrt(0.75 * high / deep) / deep * (at - start)) ** 2 for at in (x, sides))
    channel = Channel(cells, ground, np.maximum(deep + wave - ground, 0.0))
    speed = np.where(sides < shore, math.sqrt(GRAVITY * (deep + high)) * there / (deep + there), 0.0)
    channel.put("velocity_x", speed[:, None])
    channel.put("discharge_x", (speed * (deep + there))[:, None])
    highest = 0.0
    for _ in range(round(30 * seconds)):
        channel.run(1 / 30)
        depth = channel.line("depth")
        wet = int(np.nonzero(depth > 1e-4)[0].max())
        highest = max(highest, float(ground[wet] + depth[wet]) - deep)
    return highest


def flood_wave(deep: float = 0.05, slope: float = 0.002, rough: float = 0.012) -> float:
    """Speed [m/s] of the middle of a long, low wave on a uniform flow down a slope [Lighthill & Whitham 1955]."""
    cells, speed = 5000, deep ** (2 / 3) * slope**0.5 / rough
    x = middles(cells)
    start = deep * (1.0 + 0.02 * np.exp(-0.5 * ((x - 120.0) / 20.0) ** 2))
    channel = Channel(cells, slope * (CELL * cells - x), start, speed, rough)
    seen = []
    for seconds in (30.0, 120.0):
        for _ in range(round(30 * seconds)):
            channel.run(1 / 30)
            for end in (slice(0, ENDS), slice(-ENDS, None)):
                channel.fix(end, deep, speed)
        more = channel.line("depth") - deep
        seen.append((float((more * x).sum() / more.sum()), channel.now))
    return (seen[1][0] - seen[0][0]) / (seen[1][1] - seen[0][1])


def over_bump(discharge: float, level: float, seconds: float = 150.0) -> tuple[Array, Array]:
    """Depth and speed, [X], of a steady flow over a bump in a channel 25 m long, with the `level` [m] at its end."""
    cells = 250 + 2 * ENDS
    x = middles(cells) - CELL * ENDS
    high, middle, half = BUMP
    ground = np.maximum(high * (1.0 - ((x - middle) / half) ** 2), 0.0)
    channel = Channel(cells, ground, np.maximum(level - ground, 0.05))
    channel.between(seconds, discharge, level)
    kept = slice(ENDS, -ENDS)
    return channel.line("depth")[kept], channel.line("velocity_x")[kept]


def jump_behind_bump() -> float:
    """Place of the jump [m]: behind the last cell that is faster than its waves."""
    depth, speed = over_bump(0.18, 0.33)
    mean = 0.18 / depth
    return CELL * (1 + int(np.nonzero((mean > np.sqrt(GRAVITY * depth)) & (np.arange(250) > 90))[0].max()))


def backwater(places: tuple[float, ...], rough: float = 0.033, discharge: float = 2.0) -> tuple[float, ...]:
    """Depths [m] at `places` [m] of a flow with friction over ground made for a known depth [MacDonald 1997]."""
    cells, fine = 1000 + 2 * ENDS, 20
    x = (np.arange(cells * fine) + 0.5) * CELL / fine - CELL * ENDS
    form = 0.5 * np.exp(-16.0 * (x / 100.0 - 0.5) ** 2)
    scale = (4.0 / GRAVITY) ** (1 / 3)
    depth, rate = scale * (1.0 + form), scale * form * -0.32 * (x / 100.0 - 0.5)
    slope = (discharge**2 / (GRAVITY * depth**3) - 1.0) * rate - (rough * discharge) ** 2 / depth ** (10 / 3)
    ground = np.cumsum(slope) * CELL / fine
    ground, depth = (of.reshape(cells, fine).mean(1) for of in (ground - ground.min(), depth))
    channel = Channel(cells, ground, depth, discharge / float(depth.mean()), rough)
    channel.between(120.0, discharge, float(ground[-1] + depth[-1]), 1 / 60)
    found = channel.line("depth")
    return tuple(float(found[round(place / CELL) + ENDS]) for place in places)


def swashing(seconds: float = 14.0) -> float:
    """Period [s] of the diagonal seiche of a room of 5 x 4 m with 0.3 m of water, of an amplitude of 2 mm."""
    x, y = np.meshgrid(middles(50), middles(40), indexing="ij")
    basin = Basin((5.0, 4.0), 0.0, 0.3 + 0.002 * np.cos(math.pi * x / 5.0) * np.cos(math.pi * y / 4.0))
    turns, before = [], (0.002, 0.0)
    for _ in range(round(120 * seconds)):
        basin.run(1 / 120, 1 / 120)
        now = (float(basin.get("depth")[0, 0]) - 0.3, basin.now)
        if now[0] * before[0] < 0.0:
            turns.append(before[1] + (now[1] - before[1]) * before[0] / (before[0] - now[0]))
        before = now
    return 2.0 * (turns[-1] - turns[0]) / (len(turns) - 1)
