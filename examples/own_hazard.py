"""A hazard from outside the package: an earthquake, with its task, its looks and its validation cases.

    python examples/own_hazard.py --video quake.mp4
    hazard-ms validate --load examples/own_hazard.py --hazard earthquake

Seen from the ground, everything loose feels -m a(t). The ground's acceleration a(t) is a sum of sines (Shinozuka and
Deodatis, Applied Mechanics Reviews 44, 1991) with the spectrum of Kanai and Tajimi for firm soil, under the envelope of
Amin and Ang (Journal of the Engineering Mechanics Division 94, 1968). Things that fall break.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from sys import argv
from typing import Any, ClassVar

import torch
from torch import Tensor

import hazard_ms
from hazard_ms import AgentStart, Body, Case, Hazard, Level, Push, Room, SceneSpec, State, World, quantity, rescue

PEAK = 8.18  # largest acceleration [m/s^2]: Kobe 1995, record of the Japan Meteorological Agency
SOIL, DAMPING = 15.6, 0.6  # frequency [rad/s] and damping of firm soil (Kanai 1957, Tajimi 1960)
FREQUENCIES = torch.linspace(1.0, 50.0, 99)  # of the sines [rad/s]: 8 Hz at most, so that a frame sees all of them
RISE, STRONG, DECAY = 2.0, 12.0, 0.3  # envelope: rises until [s], strong until [s], then falls at this rate [1/s]
RECORD = (torch.arange(900) + 0.5) / 30.0  # times at which the record is scaled to its peak [s]
FALL = 0.3  # things that end up lower than they stood by this much are broken [m] [ours]
GRIP = 0.5 * 9.81  # shaken harder than this, things slide: friction times gravity [m/s^2]


@dataclass
class Shaking(State):
    """S sines."""

    time: Tensor = quantity("E", "s", "since the start of the episode")
    phase: Tensor = quantity("E 2 S", "rad", "of the sines")
    scale: Tensor = quantity("E", "m/s^2", "acceleration over that of the bare sum of sines")
    acceleration: Tensor = quantity("E 2", "m/s^2", "of the ground, x and y, in the coming frame")
    shaken: Tensor = quantity("E", "m/s", "integral of the magnitude of the acceleration")
    height: Tensor = quantity("E B", "m", "of the base of things where they stood, or were let go")


@dataclass(frozen=True)
class Earthquake(Hazard):
    """Shakes the ground under everything that stands loose."""

    name: ClassVar[str] = "earthquake"
    state_type: ClassVar[type[State]] = Shaking
    level: ClassVar[Level] = Level("ground acceleration", "m/s2", 0.0, 10.0, "plasma", (214, 168, 92))
    fills: ClassVar[bool] = True  # with dust

    peak: float = PEAK  # [m/s^2], where the scene gives none

    def sizes(self, world: World) -> dict[str, int]:
        return {"S": len(FREQUENCIES)}

    def reset(self, state: Shaking, world: World, rows: Tensor) -> None:
        state.phase[rows] = 2.0 * math.pi * world.chance.uniform("earthquake.phase", 2, len(FREQUENCIES))[rows]
        state.scale[rows] = 1.0
        peaks = [world.specs[row].parameter(self.name, "peak", self.peak) for row in rows.tolist()]
        largest = ground(state, RECORD.to(world.device)).norm(dim=-1).amax(1)[rows]
        state.scale[rows] = torch.tensor(peaks, device=world.device) / largest
        state.height[rows] = base_height(world)[rows]

    def force(self, state: Shaking, world: World, dt: float) -> Push:
        pull = torch.nn.functional.pad(-state.acceleration, (0, 1))
        return Push(world.mass[..., None] * pull[:, None])

    def advance(self, state: Shaking, world: World, dt: float) -> None:
        state.time += dt
        state.acceleration.copy_(ground(state, state.time[:, None] + dt / 2)[:, 0])
        state.shaken += state.acceleration.norm(dim=-1) * dt
        state.height.copy_(torch.where(world.held, base_height(world), state.height))

    def damaged(self, state: Shaking, world: World) -> Tensor:
        return world.movable & (base_height(world) < state.height - FALL)

    def image(self, state: Shaking, world: World, points: Tensor) -> Tensor:
        return state.acceleration.norm(dim=-1)[:, None].expand(points.shape[:2])

    def threatens(self, target: Any, level: float, height: float) -> bool:
        return level > GRIP and height > FALL


def base_height(world: World) -> Tensor:
    """Height of the bases of all things [m], [E, B]."""
    return world.base_of(world.position, world.rotation, world.extent)[..., 2]


def ground(state: Shaking, time: Tensor) -> Tensor:
    """Acceleration of the ground [m/s^2], [E, T, 2], at `time` [s], [E, T] or [T]."""
    time = time.expand(len(state.scale), -1)
    envelope = (time / RISE).clamp(max=1.0) ** 2 * torch.exp(-DECAY * (time - STRONG).clamp(min=0.0))
    ratio = (FREQUENCIES.to(time) / SOIL) ** 2
    power = (1.0 + 4.0 * DAMPING**2 * ratio) / ((1.0 - ratio) ** 2 + 4.0 * DAMPING**2 * ratio)
    waves = torch.cos(time[..., None, None] * FREQUENCIES.to(time) + state.phase[:, None])
    return (state.scale[:, None] * envelope)[..., None] * (power.sqrt() * waves).sum(-1)


@dataclass
class Dust:
    """Dust that the shaking raises: haze in the whole room."""

    around: list[Any]
    layer: ClassVar[int] = 1

    @classmethod
    def build(cls, scenes: Any, specs: Any, world: World, mode: str, around: list[Any]) -> "Dust":
        return cls(around)

    def update(self, world: World, state: Shaking, frame: Tensor) -> None:
        for air, shaken in zip(self.around, state.shaken.tolist(), strict=False):
            air.haze(0.04 * (1.0 - math.exp(-shaken / 10.0)), (0.0, 0.0))


def shaken(seeds: int) -> Tensor:
    """The ground's acceleration [m/s^2] at `RECORD`, [E, T, 2], in as many scenes with a book."""
    law, books = Earthquake(), (Body("book_1", "book", "book_1", (2.0, 2.0, 0.0)),)
    spec = SceneSpec("floor", Room((5.0, 5.0)), (), books, (), (), AgentStart((1.0, 1.0)))
    world = World.of((spec,) * seeds, [[(0.2, 0.1, 0.3)]] * seeds, [[1.0]] * seeds)
    world.chance.seed += torch.arange(seeds)
    state = Shaking.allocate({"E": seeds, "B": 1, **law.sizes(world)}, "cpu")
    law.reset(state, world, torch.arange(seeds))
    return ground(state, RECORD)


def cases() -> Iterator[Case]:
    """What the law must give: the peak, and how much of the power lies below the soil's frequency."""
    yield Case("E-1", "peak acceleration", PEAK, 1e-5, lambda: float(shaken(5).norm(dim=-1).max()), "m/s2")
    power = torch.fft.rfft(shaken(200)[:, 60:360], dim=1).abs().square().sum((0, 2))
    low = power[torch.fft.rfftfreq(300, 1.0 / 30.0) * 2.0 * math.pi < SOIL].sum() / power.sum()
    # the spectrum's integral from 1 to 15.6 rad/s over that from 1 to 50 rad/s (scipy.integrate.quad)
    yield Case("E-2", "share of power below the soil's frequency", 0.519, 0.03, lambda: float(low))


if __name__ == "__main__":
    raise SystemExit(hazard_ms.main(["play", "--load", __file__, "-e", "HazardEarthquake-v1", *argv[1:]]))

hazard_ms.register_hazard("earthquake", lambda preset: Earthquake(), looks=Dust, cases=cases)
hazard_ms.register_task("HazardEarthquake-v1", lambda physics: rescue([Earthquake()]), max_frames=900)
