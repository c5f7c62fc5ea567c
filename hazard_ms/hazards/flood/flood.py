"""Flood as in the HAZARD challenge: water rises at one wall, its surface slopes down from there, and things float off.

    level(p) = H(t) - tan(slope) length(p),   length: of the path from the source wall to p, through doorways
    (hazard_ms.hazards.flood.flow_paths)

H rises by 0.01 m every 10 frames to 1.5 m; from then on the slope lessens as the wetted length grows, so no level ever
falls. The current runs away from the source along the path. The water is a few Warp kernels,
hazard_ms.hazards.flood.kernels: lift and drag are those of hazard_ms.hazards.flood.floating, in the original's code of
hazard_ms.hazards.flood.slab; what a robot feels of it, and its ways through doors, are torch. Constants:
docs/physics.md 1.2; what the presets change: docs/physics.md 1.5. In `realistic` water flows instead:
hazard_ms.hazards.flood.realistic.inundation.

`gain` is the one number tuned for difficulty. The original's frame lasts 0.01 s, ours 1/30 s: of its current, 0.3
carries things as far per frame as it did there, while the agent walks as far per frame as there. Measured in
kitchen_a/00, mean distance that its 60 bodies drift after 250, 500, 750, 1,000 frames: `shipped` with bodies of 1 kg
0.07, 0.23, 0.32, 0.48 m; `paper` 0.08, 0.30, 0.42, 0.63 m (gain 1: 0.28, 0.65, 0.73, 1.08 m).
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard, Level, Push, State, none_set
from hazard_ms.hazards.flood import flow_paths, kernels, wading
from hazard_ms.hazards.flood.buoyancy import FILLS
from hazard_ms.hazards.flood.floating import Liquid
from hazard_ms.hazards.flood.flood_state import FloodState
from hazard_ms.hazards.flood.reach import PathArrays
from hazard_ms.hazards.flood.soaking import ELECTRONIC, SHAPES, SOAKING, porosity
from hazard_ms.hazards.flood.water import Water
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import of_environments
from hazard_ms.simulation.world import World
from hazard_ms.spec import Quantity
from hazard_ms.spec.catalogue import CATEGORIES

ROUNDING = 1e-4  # largest rounding error of a sum of frame lengths [s] [ours]


@dataclass(frozen=True)
class Flood(Hazard):
    """A flood with these parameters; the defaults are those of the preset `paper`."""

    name: ClassVar[str] = "flood"
    state_type: ClassVar[type[State]] = FloodState
    level: ClassVar[Level] = Level("water level", "m", 0.0, 1.5, "ocean", (92, 173, 255), least=0.0)
    tells: ClassVar[dict[str, Quantity]] = {
        "water_depth": Quantity("depth of the water at the agent", "m", 0.0),
        "flow_speed": Quantity("speed of the water at the agent", "m/s", 0.0),
        "hazard_class": Quantity("hazard class of the water to people, H1 to H6, 0 if dry", "", 0.0, 6.0),
        "agent_traction": Quantity("share of the agent's weight that is left on the floor", "", 0.0, 1.0),
    }
    signals: ClassVar[str] = "hazard_ms.sensing.senses.of_others:FloodSignals"
    fills: ClassVar[bool] = True
    provides: ClassVar[dict[str, str]] = {"water": "image"}

    rise: float = 0.01  # rise of the level at the source per update [m] [HAZARD flood/utils.py:19-21]
    every: int = 10  # frames from update to update [HAZARD flood/utils.py:19-21]
    cap: float = 1.5  # highest level [m] [HAZARD flood/utils.py:19-21]
    slope: float = 3.0  # angle of the surface [degrees] [HAZARD flood/utils.py:25]
    # speed of the water [m/s]: 50 times the front's metres per frame [HAZARD flood/object.py:284]
    current: float = 0.9540568
    gain: float = 0.3  # factor on the current: 30 frames a second in place of 100 [ours]
    water: Water = Water()
    # of everything; 0: the category's own [HAZARD flood/object.py:90] [docs/physics.md R6]
    drag_coefficient: float = 0.47
    slabs: bool = False  # the original's lift and drag [docs/physics.md R5, R6]
    spares_waterproof: bool = True  # what is waterproof is not damaged [docs/physics.md R8]
    damage_fraction: float = 0.5  # share of a thing under water that damages it; 0: any contact [docs/physics.md R7]
    damage_time: float = 0.0  # how long it must be under water to be damaged [s]
    electronic_time: float = 0.0  # how long for electronics [s]
    soaks: bool = False  # porous things lose their lift
    least_grip: float = 0.8  # share of its own motion that the agent keeps at least [ours]
    through_doors: bool = False  # water comes in at the outer doors, not over the whole of the walls [ours]

    def __post_init__(self) -> None:
        for name in ("rise", "every", "cap", "slope"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in ("current", "gain", "drag_coefficient", "damage_time", "electronic_time"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name} must be 0 or a positive number, got {getattr(self, name)}")
        for name in ("damage_fraction", "least_grip"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} must be a share from 0 to 1, got {getattr(self, name)}")
        if not self.slope < 45:
            raise ValueError(f"slope must be less than 45 degrees, got {self.slope}")

    @functools.cached_property
    def speed(self) -> float:
        """Speed of the water [m/s]."""
        return self.current * self.gain

    def sizes(self, world: World) -> dict[str, int]:
        return flow_paths.sizes(world.specs, self.through_doors)

    def reset(self, state: FloodState, world: World, rows: Tensor) -> None:
        state.surface_slope[rows] = math.tan(math.radians(self.slope))
        sizes = state.partition.shape[1], state.doorway.shape[1]
        made = [flow_paths.paths_of(world.specs[row], *sizes, self.through_doors) for row in rows.tolist()]
        for name in flow_paths.FlowPaths._fields:
            target = getattr(state, name)
            entries = torch.tensor([paths[name] for paths in made], dtype=target.dtype, device=world.device)
            target[rows] = entries.reshape(len(made), *target.shape[1:])
        self._reset_materials(state, world, rows)

    def _reset_materials(self, state: FloodState, world: World, rows: Tensor) -> None:
        state.shape[rows] = _by_category(world, SHAPES, 0).long()[rows]
        box = world.extent.prod(-1) * torch.tensor(FILLS, device=world.device)[state.shape]
        density = world.lookup("density").clamp(min=1e-3)
        # cavities are not in the density: see catalogue
        state.volume[rows] = torch.minimum(world.mass / density, box)[rows]
        own = world.lookup("drag_coefficient")
        one = torch.full_like(own, self.drag_coefficient) if self.drag_coefficient else own
        state.drag_coefficient[rows] = one[rows]
        if self.soaks:
            state.pores[rows] = _by_category(world, {name: porosity(name) for name in SOAKING}, 0.0)[rows]
            state.soaking_time[rows] = _by_category(world, {name: s.time for name, s in SOAKING.items()}, 1.0)[rows]
        limit = _by_category(world, dict.fromkeys(ELECTRONIC, self.electronic_time), self.damage_time)
        spared = world.lookup("waterproof") > 0 if self.spares_waterproof else torch.zeros_like(world.exists)
        state.submersion_limit[rows] = torch.where(spared, torch.inf, limit)[rows]

    def advance(self, state: FloodState, world: World, dt: float) -> None:
        state.time.add_(dt)
        before = state.level.clone()
        launches, bodies = world.launches, world.launches.struct(Bodies, world)
        flooded = launches.struct(kernels.Flooded, state)
        launches.run(kernels.rise, (world.num_envs,), world.frame, *self._course, flooded)
        blocked = self.through_doors and flow_paths.hold_back(state, world, state.level - before)
        if world.openings.inner or blocked:
            state.doorway_distance.copy_(flow_paths.through_open(state, *world.openings.ways))
        how = dt, self.slabs, self.damage_fraction
        paths = launches.struct(PathArrays, state)
        launches.run(kernels.immerse, tuple(world.exists.shape), *how, flooded, paths, bodies)

    @functools.cached_property
    def _course(self) -> tuple[int, float, float, int, float, float, float]:
        """The course of the level and of the slope, as `kernels.rise` takes it."""
        full = math.ceil(self.cap / self.rise - 1e-6)  # updates until the cap is reached
        steep = math.tan(math.radians(self.slope))
        return self.every, self.rise, self.cap, full, steep, self.cap / steep, self.rise / steep

    def _surface(self, state: FloodState, world: World, points: Tensor) -> tuple[Tensor, Tensor]:
        """Level [m], [E, P], and direction of flow, [E, P, 2], of the water at `points` [m], [E, P, 3], world frame.

        The level is below the floor where it is dry.
        """
        place, launches = of_environments(points, world.num_envs), world.launches
        level, direction = place.new_empty(place.shape[:2]), place.new_empty(*place.shape[:2], 2)
        structs = launches.struct(kernels.Flooded, state), launches.struct(PathArrays, state)
        launches.run(kernels.tell, tuple(level.shape), *structs, place, level, direction)
        return level, direction

    def force(self, state: FloodState, world: World, dt: float) -> Push | None:
        if none_set(state.level > 0):
            return None
        made = world.launches.results(kernels.push, world.position, world.position)
        world.launches.run(
            kernels.push,
            tuple(world.exists.shape),
            dt,
            self.slabs,
            self.speed,
            world.launches.struct(Liquid, self.water),
            world.launches.struct(kernels.Flooded, state),
            world.launches.struct(PathArrays, state),
            world.launches.struct(Bodies, world),
            *made,
        )
        return Push(made[0], None if self.slabs else made[1])

    def damaged(self, state: FloodState, world: World) -> Tensor:
        return (state.under > 0) & (state.under >= state.submersion_limit - ROUNDING) & world.exists & ~world.held

    def image(self, state: FloodState, world: World, points: Tensor) -> Tensor:
        return self._surface(state, world, points)[0].clamp(min=0)

    def at_agent(self, state: FloodState, world: World) -> tuple[Tensor, Tensor, Tensor]:
        """Depth [m], [E], and velocity of the water [m/s], [E, 2], at the agent, and its grip, [E].

        Grip is the share of its own motion that the agent keeps.
        """
        place = world.agent_position[:, None]
        level, direction = self._surface(state, world, place)
        depth = (level - place[..., 2]).clamp(min=0)
        flow = torch.where(depth > 0, self.speed * direction[:, 0], 0.0)
        grip = wading.grip(depth, self.speed, world.robot, self.water.density, self.water.gravity)
        return depth[:, 0], flow, grip[:, 0].clamp(min=self.least_grip)

    def slow(self, state: FloodState, world: World) -> Tensor:
        """Motion that is left to the agent, [E, 3]: the share of its own velocity, and a velocity x, y [m/s] to add.

        Together they are a weighted mean of its own velocity and the water's, so it is carried no faster than the
        water. It is never toppled.
        """
        _, flow, grip = self.at_agent(state, world)
        return torch.cat([grip[:, None], (1 - grip[:, None]) * flow], 1)

    def threatens(self, target: Any, level: float, height: float) -> bool:
        return not target.waterproof and level >= height

    def agent_info(self, state: FloodState, world: World) -> dict[str, Tensor]:
        depth, flow, _ = self.at_agent(state, world)
        speed = flow.norm(dim=-1)
        return {
            "water_depth": depth,
            "flow_speed": speed,
            "hazard_class": wading.hazard_class(depth, speed),
            "agent_traction": wading.traction(depth, world.robot, self.water.density),
        }


def _by_category(world: World, table: dict[str, float] | dict[str, int], default: float) -> Tensor:
    """The entry of `table` for the category of every thing, [E, B]; `default` where it has none."""
    row = torch.tensor([float(table.get(name, default)) for name in CATEGORIES], device=world.device)
    return torch.where(world.exists, row[world.category.clamp(min=0)], default)
