"""Flood as in the HAZARD challenge: water rises at one wall, its surface falls away from it, things float off with the current.

    level(p) = H(t) - tan(slope) way(p),   way: from the source wall to p, through doorways (hazard_ms.hazards.surface)

H rises by 0.01 m every 10 frames, in `realistic` as fast by the second, to 1.5 m; from then on the slope lessens as the wetted
length grows, so no level ever falls. The current runs away from the source along the way. Lift and drag: hazard_ms.kernels.floating;
those of the original's code: hazard_ms.kernels.slab. Constants: physics.md 1.2 [C]; what the presets change: physics.md 1.5.

`gain` is the one number tuned for difficulty. The original's frame lasts 0.01 s, ours 1/30 s: of its current, 0.3 carries things as
far per frame as it did there, while the agent walks as far per frame as there. Measured in kitchen_a/00, mean way of its 60 bodies
after 250, 500, 750, 1,000 frames: `shipped` with bodies of 1 kg 0.07, 0.23, 0.32, 0.48 m; `paper` 0.08, 0.30, 0.42, 0.63 m (gain 1:
0.28, 0.65, 0.73, 1.08 m).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.catalogue import CATEGORIES
from hazard_ms.hazards import surface, wading
from hazard_ms.hazards.base import Hazard, Push, State, nobody, quantity
from hazard_ms.hazards.materials import ELECTRONIC, SHAPES, SOAKING, porosity
from hazard_ms.hazards.water import Water
from hazard_ms.kernels import flood as kernels
from hazard_ms.kernels.buoyancy import FILLS
from hazard_ms.world import World

ROUNDING = 1e-4  # of sums of the lengths of frames [s]


@dataclass
class FloodState(State):
    """W partitions and G doorways; what does not change over an episode is kept as it was worked out at its start."""

    time: Tensor = quantity("E", "s", "since the start of the episode")
    level: Tensor = quantity("E", "m", "height of the surface at the source wall")
    fall: Tensor = quantity("E", "", "descent of the surface along the way of the water, a tangent")
    fraction: Tensor = quantity("E B", "", "share of every thing's volume that is under water")
    under: Tensor = quantity("E B", "s", "for how long it has been under water enough to be damaged")
    soaked: Tensor = quantity("E B", "", "share of its pores that are full of water")
    volume: Tensor = quantity("E B", "m^3", "of water that a dry, wholly immersed thing displaces")
    shape: Tensor = quantity("E B", "", "what stands for it in water: 0 box, 1 upright cylinder, 2 ellipsoid", dtype="int")
    drag_coefficient: Tensor = quantity("E B", "", "of its drag")
    pores: Tensor = quantity("E B", "", "share of its volume that water takes in the end")
    soaking_time: Tensor = quantity("E B", "s", "until 1 / e of its pores are left dry", fill=1.0)
    endures: Tensor = quantity("E B", "s", "how long it may be under water; infinite for what is waterproof", fill=torch.inf)
    flow: Tensor = quantity("E 2", "", "direction in which water leaves the source wall")
    start: Tensor = quantity("E", "m", "way of the water to the room's origin, partitions apart")
    wall: Tensor = quantity("E W 2", "m", "partitions: across axis 0 (x) or 1 (y), and where")
    near: Tensor = quantity("E 2", "", "bits of parts along the source wall: which, and their values", dtype="int")
    gate: Tensor = quantity("E G 4", "m", "doorways: low x, y, high x, y")
    gate_way: Tensor = quantity("E G", "m", "way of the water to doorways")
    gate_part: Tensor = quantity("E G 2", "", "doorways: a part beside it, and the bit in which the other differs", dtype="int")

    @property
    def ways(self) -> surface.Ways:
        """The parts and doorways of the rooms."""
        return surface.Ways(self.flow, self.start, self.wall, self.near, self.gate, self.gate_way, self.gate_part)


@dataclass(frozen=True)
class Flood(Hazard):
    """Parameters; the defaults are those of the preset `paper`."""

    name: ClassVar[str] = "flood"
    state_type: ClassVar[type[State]] = FloodState
    provides: ClassVar[dict[str, str]] = {"water": "image"}

    rise: float = 0.01  # of the level at the source per update [m] [C utils.py:19-21]
    every: int = 10  # frames from update to update [C utils.py:19-21]
    rise_rate: float = 0.0  # [m/s]; 0: the level rises by updates, else smoothly
    cap: float = 1.5  # highest level [m] [C utils.py:19-21]
    slope: float = 3.0  # of the surface [degrees] [C utils.py:25]
    current: float = 0.9540568  # speed of the water [m/s]: 50 times the front's metres per frame [C object.py:284]
    gain: float = 0.3  # of the current: 30 frames a second in place of 100 [ours]
    water: Water = Water()
    drag_coefficient: float = 0.47  # of everything; 0: the category's own [C object.py:90] [physics.md R6]
    slabs: bool = False  # the original's lift and drag [physics.md R5, R6]
    spares_waterproof: bool = True  # what is waterproof is not damaged [physics.md R8]
    damage_fraction: float = 0.5  # of a thing under water that damages it; 0: any contact [physics.md R7]
    damage_time: float = 0.0  # for so long [s]
    electronic_time: float = 0.0  # the same for electronics [s]
    soaks: bool = False  # porous things lose their lift
    least_grip: float = 0.8  # share of its own motion that the agent keeps at least [ours]
    wader: wading.Wader = wading.Wader()

    def __post_init__(self) -> None:
        for name in ("rise", "every", "cap", "slope"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is {getattr(self, name)}; a positive number is allowed")
        for name in ("rise_rate", "current", "gain", "drag_coefficient", "damage_time", "electronic_time"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name} is {getattr(self, name)}; 0 or a positive number is allowed")
        for name in ("damage_fraction", "least_grip"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} is {getattr(self, name)}; a share from 0 to 1 is allowed")
        if not self.slope < 45:
            raise ValueError(f"slope is {self.slope}; less than 45 degrees is allowed")

    @property
    def speed(self) -> float:
        """Of the water [m/s]."""
        return self.current * self.gain

    def sizes(self, world: World) -> dict[str, int]:
        return surface.sizes(world.specs)

    def reset(self, state: FloodState, world: World, rows: Tensor) -> None:
        state.fall[rows] = math.tan(math.radians(self.slope))
        made = [surface.ways_of(world.specs[row], state.wall.shape[1], state.gate.shape[1]) for row in rows.tolist()]
        for name in surface.Ways._fields:
            target = getattr(state, name)
            entries = torch.tensor([ways[name] for ways in made], dtype=target.dtype, device=world.device)
            target[rows] = entries.reshape(len(made), *target.shape[1:])
        self._reset_materials(state, world, rows)

    def _reset_materials(self, state: FloodState, world: World, rows: Tensor) -> None:
        state.shape[rows] = _by_category(world, SHAPES, 0).long()[rows]
        box = world.extent.prod(-1) * torch.tensor(FILLS, device=world.device)[state.shape]
        density = world.lookup("density").clamp(min=1e-3)
        state.volume[rows] = torch.minimum(world.mass / density, box)[rows]  # cavities are not in the density: see catalogue
        own = world.lookup("drag_coefficient")
        state.drag_coefficient[rows] = (torch.full_like(own, self.drag_coefficient) if self.drag_coefficient else own)[rows]
        if self.soaks:
            state.pores[rows] = _by_category(world, {name: porosity(name) for name in SOAKING}, 0.0)[rows]
            state.soaking_time[rows] = _by_category(world, {name: s.time for name, s in SOAKING.items()}, 1.0)[rows]
        endures = _by_category(world, dict.fromkeys(ELECTRONIC, self.electronic_time), self.damage_time)
        spared = world.lookup("waterproof") > 0 if self.spares_waterproof else torch.zeros_like(world.exists)
        state.endures[rows] = torch.where(spared, torch.inf, endures)[rows]

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: FloodState, world: World, dt: float) -> None:
        state.time.add_(dt)
        self._rise(state, world)
        world.launches.run(
            kernels.immerse,
            tuple(world.exists.shape),
            dt,
            self.slabs,
            self.damage_fraction,
            state.level,
            state.fall,
            *state.ways,
            world.exists,
            world.position,
            world.rotation,
            world.extent,
            state.shape,
            state.pores,
            state.soaking_time,
            state.fraction,
            state.under,
            state.soaked,
        )

    def _rise(self, state: FloodState, world: World) -> None:
        """The level at the source and the descent of the surface, by the frame or by the second."""
        updates = state.time * (self.rise_rate / self.rise) if self.rise_rate else world.frame // self.every
        full = math.ceil(self.cap / self.rise - 1e-6)  # updates until the cap is reached
        state.level.copy_((self.rise * updates).clamp(max=self.cap))
        beyond = (updates - full + (0 if self.rise_rate else 1)).clamp(min=0)  # by the frame: the first is the one that reaches it
        steep = math.tan(math.radians(self.slope))
        length = self.cap / steep + self.rise / steep * beyond
        state.fall.copy_(torch.where(beyond > 0, self.cap / length, steep))

    def _surface(self, state: FloodState, world: World, points: Tensor) -> tuple[Tensor, Tensor]:
        """Level of the water at `points` [m], [E, P, 3]: [E, P], below the floor where it is dry; and its direction there, [E, P, 2]."""
        far, toward = surface.ways_to(state.ways, points, world.launches)
        return state.level[:, None] - state.fall[:, None] * far, toward

    @torch.inference_mode()
    def force(self, state: FloodState, world: World, dt: float) -> Push | None:
        if nobody(state.level > 0):
            return None
        made = world.launches.results(kernels.push, world.position, world.position)
        world.launches.run(
            kernels.push,
            tuple(world.exists.shape),
            dt,
            self.slabs,
            *self.water.numbers,
            self.speed,
            state.level,
            state.fall,
            *state.ways,
            world.exists,
            world.movable,
            world.position,
            world.rotation,
            world.velocity,
            world.angular_velocity,
            world.extent,
            world.mass,
            state.shape,
            state.volume,
            state.pores,
            state.soaked,
            state.drag_coefficient,
            *made,
        )
        force, torque = made
        return Push(force.clone(), None if self.slabs else torque.clone())

    def damaged(self, state: FloodState, world: World) -> Tensor:
        return (state.under > 0) & (state.under >= state.endures - ROUNDING) & world.exists & ~world.held

    def image(self, state: FloodState, world: World, points: Tensor) -> Tensor:
        return self._surface(state, world, points)[0].clamp(min=0)

    def at_agent(self, state: FloodState, world: World) -> tuple[Tensor, Tensor, Tensor]:
        """Where the agent stands: depth [m], [E], velocity of the water [m/s], [E, 2], and the share of its own motion it keeps, [E]."""
        place = world.agent_position[:, None]
        level, toward = self._surface(state, world, place)
        depth = (level - place[..., 2]).clamp(min=0)
        flow = torch.where(depth > 0, self.speed * toward[:, 0], 0.0)
        grip = wading.grip(depth, self.speed, self.wader, self.water.density, self.water.gravity)
        return depth[:, 0], flow, grip[:, 0].clamp(min=self.least_grip)

    def slow(self, state: FloodState, world: World) -> Tensor:
        """What is left of the agent's motion, [E, 3]: the share of its own velocity, and the velocity x, y [m/s] that comes on top.

        The two are a weighted mean of its own velocity and the water's, so it is carried no faster than the water, and never toppled.
        """
        _, flow, grip = self.at_agent(state, world)
        return torch.cat([grip[:, None], (1 - grip[:, None]) * flow], 1)

    def agent_info(self, state: FloodState, world: World) -> dict[str, Tensor]:
        depth, flow, _ = self.at_agent(state, world)
        speed = flow.norm(dim=-1)
        return {
            "water_depth": depth,
            "flow_speed": speed,
            "hazard_class": wading.hazard_class(depth, speed),
            "agent_traction": wading.traction(depth, self.wader, self.water.density),
        }


def _by_category(world: World, table: dict[str, float] | dict[str, int], default: float) -> Tensor:
    """The entry of `table` for every thing's category, [E, B], float32; `default` where it has none."""
    row = torch.tensor([float(table.get(name, default)) for name in CATEGORIES], device=world.device)
    return torch.where(world.exists, row[world.category.clamp(min=0)], default)
