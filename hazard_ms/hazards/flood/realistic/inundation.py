"""Flood of the preset `realistic`: water that comes in through doors and runs round the furniture.

    water    depth-averaged flow over the floor (.shallow_water), from a depth outside the doors that stays (.inlets)
    things   lift, drag and torque as of every flood (hazard_ms.hazards.flood.floating), by the level, the slope and the
             velocity of the water where they are (.basin, .currents)

What stands on the floor is ground for the water, so nothing is pushed through a wall, and things float into eddies
behind sofas. Inside furniture that is not full of water, it stands as high as around it. Doors hold it back as far as
they are closed, but for the gap under them, until it breaks them (.openings). Limits: depth-averaged, so nothing is
drawn under; things do not act on the water; no water comes in through windows.

Furniture that would float in the water outside the doors (.buoyant) stands like a wall until it does. Then the
simulator moves it as a rigid body under the same lift, drag and torque as all things, with contacts with walls, robots
and other things: what stands on it goes with it or falls. PhysX on the CPU repeats exactly and is honest in three
dimensions, and what stands costs nothing. PhysX on a GPU cannot set a body free at run time: there it stays. What it
does to the water: .dams.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import Push, State, none_set
from hazard_ms.hazards.flood import kernels, wading
from hazard_ms.hazards.flood.floating import Liquid
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.flood.realistic import (
    buoyant,
    currents,
    dams,
    floor_plan,
    floors,
    footing,
    openings,
    shallow_water,
)
from hazard_ms.hazards.flood.realistic.basin import Basin
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import of_environments
from hazard_ms.simulation.openings import Strain
from hazard_ms.simulation.world import World
from hazard_ms.spec import Quantity, SceneSpec
from hazard_ms.spec.severity import SEVERITIES, USUAL

LISTED = (  # quantities of the plan of a floor that are lists
    *("inlet", "inlet_side", "inlet_beside", "inlet_width", "inlet_height", "inlet_opening", "inlet_along"),
    *("door", "door_side", "door_height"),
    *("leaf", "leaf_side", "leaf_opening", "leaf_along"),
)


@dataclass(frozen=True)
class Inundation(Flood):
    """A flood that flows, with these parameters; of Flood's, those of level and current mean nothing."""

    state_type: ClassVar[type[State]] = InundationState
    tells: ClassVar[dict[str, Quantity]] = Flood.tells | {
        "agent_fallen": Quantity("the agent lies on the ground", "", 0, 1)
    }

    outside: float = SEVERITIES[USUAL].flood_outside  # depth of the water outside the doors [m]
    roughness: float | None = None  # Manning's n of every floor [s/m^(1/3)]; None: that of its material (.floors)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.outside < floor_plan.BEYOND / 2:
            raise ValueError(f"outside must be from 0 to {floor_plan.BEYOND / 2:g} m, got {self.outside}")
        if self.roughness is not None and not self.roughness >= 0:
            raise ValueError(f"roughness must be None, 0 or a positive number, got {self.roughness}")

    def loosens(self, spec: SceneSpec) -> frozenset[str]:
        return buoyant.afloat_in(spec, self.outside)

    def loose(self, state: InundationState, world: World) -> Tensor | None:
        return state.afloat

    def sizes(self, world: World) -> dict[str, int]:
        rows, columns = _cells(world)
        inlets, doors, sides = (
            max(1, most(world.specs)) for most in (floor_plan.most_inlets, floor_plan.most_doors, floor_plan.most_sides)
        )
        sizes = super().sizes(world)
        return sizes | {"N": (rows + 2) * (columns + 2), "I": inlets, "DOORS": doors, "L": sides, "A": len(world.crew)}

    def reset(self, state: InundationState, world: World, rows: Tensor) -> None:  # type: ignore[override]
        size = _cells(world)
        for row in rows.tolist():
            edges = dict(zip(world.names[row], world.extent[row].tolist(), strict=False))
            state.friction[row] = floors.friction_of(world.specs[row], self.roughness)
            plan = floor_plan.plan_of(world.specs[row], size, edges)
            for name in ("bed", "open_x", "open_y", "ground_of"):
                getattr(state, name)[row] = torch.from_numpy(getattr(plan, name))
            for name in LISTED:
                given, held = getattr(plan, name), getattr(state, name)
                held[row, : len(given)] = torch.tensor(given).to(held)[: held.shape[1]]
        world.openings.let_in(rows)
        state.signal[rows] = shallow_water.wave(self.outside)
        self._reset_materials(state, world, rows)
        self._reset_furniture(state, world, rows)

    def _reset_furniture(self, state: InundationState, world: World, rows: Tensor) -> None:
        for row, b in (world.floats[rows].nonzero()).tolist():
            e = int(rows[row])
            spec = world.specs[e]
            state.float_depth[e, b], state.volume[e, b] = buoyant.floating(spec.fixtures[b - len(spec.bodies)])

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: InundationState, world: World, dt: float) -> None:  # type: ignore[override]
        state.time.add_(dt)
        openings.set_heights(state, world, self.outside)
        launches, (rows, columns) = world.launches, _cells(world)
        basin = launches.struct(Basin, state)
        new = launches.results(shallow_water.flow, state.velocity_x, state.velocity_y)
        launches.run(shallow_water.flow, (world.num_envs,), dt, self.outside, rows, columns, basin, *new)
        flooded, bodies = launches.struct(kernels.Flooded, state), launches.struct(Bodies, world)
        size = tuple(world.exists.shape)
        launches.run(currents.immerse, size, dt, self.damage_fraction, rows, columns, flooded, basin, bodies)
        if not none_set(world.floats):
            self._float(state, world)
        self._topple(state, world, dt)

    def _float(self, state: InundationState, world: World) -> None:
        """Let furniture leave the floor, and dam the openings that it lies in."""
        launches, (rows, columns) = world.launches, _cells(world)
        structs = launches.struct(Basin, state), launches.struct(dams.Furniture, state), launches.struct(Bodies, world)
        launches.run(dams.drift, (world.num_envs,), self.outside, rows, columns, *structs)

    def _topple(self, state: InundationState, world: World, dt: float) -> None:
        """Let robots fall, lie and stand up during `dt` [s]."""
        launches, water, size = world.launches, self.water, (world.num_envs,)
        for robot, *own in world.crew.each(state.lies, state.lain):
            build = footing.footing(robot, water.density, water.gravity)
            launches.run(footing.stand, size, dt, *_cells(world), build, launches.struct(Basin, state), *own)

    def force(self, state: InundationState, world: World, dt: float) -> Push | None:  # type: ignore[override]
        launches = world.launches
        made = launches.results(currents.push, world.position, world.position)
        structs = (
            launches.struct(Liquid, self.water),
            launches.struct(kernels.Flooded, state),
            launches.struct(Basin, state),
            launches.struct(Bodies, world),
        )
        launches.run(currents.push, tuple(world.exists.shape), dt, *_cells(world), *structs, *made)
        return Push(*made)

    @torch.inference_mode()
    def strain(self, state: InundationState, world: World) -> Strain:
        beside = world.openings.plan.beside
        level = self._surface(state, world, beside.flatten(1, 2))[0].clamp(min=0.0).view(beside.shape[:3])
        return openings.press(level, self.outside, world, self.water.density * self.water.gravity)

    def _surface(self, state: InundationState, world: World, points: Tensor) -> tuple[Tensor, Tensor]:  # type: ignore[override]
        """Level [m], [E, P], and velocity [m/s], [E, P, 2], of the water at `points` [m], [E, P, 3], world frame.

        The level is below the floor where it is dry.
        """
        place = of_environments(points, world.num_envs)
        level, velocity = place.new_empty(place.shape[:2]), place.new_empty(*place.shape[:2], 2)
        launches = world.launches
        basin = launches.struct(Basin, state)
        launches.run(currents.tell, tuple(level.shape), *_cells(world), basin, place, level, velocity)
        return level, velocity

    def at_agent(self, state: InundationState, world: World) -> tuple[Tensor, Tensor, Tensor]:  # type: ignore[override]
        place = world.agent_position[:, None]
        level, velocity = self._surface(state, world, place)
        depth = (level - place[..., 2]).clamp(min=0)
        flow = torch.where(depth > 0, velocity[:, 0], 0.0)
        holds, speed = (
            wading.sliding_speed(depth, world.robot, self.water.density, self.water.gravity),
            flow.norm(dim=-1),
        )
        grip = torch.where(speed > holds[:, 0], holds[:, 0] / speed, 1.0)
        return depth[:, 0], flow, grip.clamp(min=self.least_grip)

    def slow(self, state: InundationState, world: World) -> Tensor:  # type: ignore[override]
        """Motion that is left to the agent, [E, 3]: the share of its own velocity, and a velocity x, y [m/s] to add.

        Wheels or soles hold up to the speed of the water at which they slide, then carry the robot off at what the
        water is faster than that; its own motion counts less the faster it is carried. One that lies only slides.
        """
        left, lies = super().slow(state, world), world.crew.own(state.lies)
        return torch.where(lies[:, None] & left.new_tensor([True, False, False]).bool(), 0.0, left)

    def fallen(self, state: InundationState, world: World) -> Tensor | None:
        return world.crew.own(state.lies)

    def agent_info(self, state: InundationState, world: World) -> dict[str, Tensor]:  # type: ignore[override]
        return super().agent_info(state, world) | {"agent_fallen": world.crew.own(state.lies).clone()}


def _cells(world: World) -> tuple[int, int]:
    """Cells along x and y that cover every scene of the batch."""
    return floor_plan.cells_over(tuple(spec.room.size for spec in world.specs))
