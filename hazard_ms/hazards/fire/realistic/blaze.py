"""Fire of the preset `realistic`: heat release, radiation, ignition, spread and smoke, in SI seconds (torch).

    heat       each burning thing by its measured or t^2 curve (hazard_ms.hazards.fire.realistic.burning), each cell of
               the floor as a t^2 fire
    ignition   of thick and thin solids by the flux of all fires, of the smoke layer, and of flames that touch
               (.radiation)
    spread     cells of the floor warm up under all fires, the smoke and flames that touch them, and light at the
               ignition temperature of the floor's material (.scorch, .front, .fuels); tiles do not burn
    smoke      two zones in each room (.twozone, .smoke); dose of heat of the agent (.tenability)

Burnt things give off no heat and cool. Nothing is drawn by chance, and nothing depends on the length of a frame: curves
are functions of time, surfaces are warmed exactly. Heat is updated every few frames. `time_scale` is the one number
that is not physics: seconds of fire per second of the episode, since rooms burn for minutes and episodes last 50 s.
Limits: flames on the floor do not go out (carpet of 4 kg/m^2 burns longer than an episode), and are within 2 to 3 m of
the first; no conduction between things, no shading but by walls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, none_set
from hazard_ms.hazards.fire import coupling, spread
from hazard_ms.hazards.fire.burning import Burning
from hazard_ms.hazards.fire.declared import TELLS_OF_BLAZE, ignites
from hazard_ms.hazards.fire.fire import begin_flames
from hazard_ms.hazards.fire.fire_state import BURNING, NORMAL, lit
from hazard_ms.hazards.fire.realistic import (
    burners,
    extinguishing,
    front,
    fuels,
    kindling,
    radiation,
    smoke,
    tenability,
    thermometer,
    touching,
    wetting,
)
from hazard_ms.hazards.fire.realistic.blaze_state import HEATED, BlazeState
from hazard_ms.hazards.fire.realistic.twozone import leaves, rooms
from hazard_ms.simulation.openings import Strain
from hazard_ms.simulation.world import World
from hazard_ms.spec import Quantity
from hazard_ms.spec.severity import SEVERITIES, USUAL

ESTABLISHED = 60.0  # age of the fires with which a scene begins [s] [ours]
UPDATE = 1 / 6  # unit in which pictures count the age of flames on things: 5 frames of the original [s]


@dataclass(frozen=True)
class Blaze(Burning):
    """A realistic fire with these parameters; the defaults are those of the preset `realistic`."""

    state_type: ClassVar[type[State]] = BlazeState
    tells: ClassVar[dict[str, Quantity]] = TELLS_OF_BLAZE
    signals: ClassVar[str] = "hazard_ms.sensing.senses.of_fire:BlazeSignals"
    fills: ClassVar[bool] = True  # with smoke

    room_temperature: float = 20.0  # [C] [docs/physics.md 4.4]
    # temperature of burning things, and the highest of plumes and jets: 800 K above the room [C] [M: McCaffrey, flame
    # region]; gas of the layers has no limit
    flame_temperature: float = 820.0
    every: int = 5  # frames from one update of heat to the next, as in the paper [HAZARD fire/manager.py:97]
    time_scale: float = 4.5  # seconds of fire per second: 0.15 s in a frame [docs/physics.md 3.1, flame spread]
    radiant: float = 0.35  # share of the heat that is radiated, where no measurement tells [docs/physics.md 4.4]
    growth: float = SEVERITIES[USUAL].fire_growth  # of all fires at the start, and of each later one [kW/s^2]
    first_release: float = SEVERITIES[USUAL].fire_start  # highest heat release of all fires at the start [kW]
    first_base: float = SEVERITIES[USUAL].fire_base  # diameter of the base of one that gives off so much [m]
    first_height: float = SEVERITIES[USUAL].fire_height  # of what burns at the start [m]
    horizon: float = 50.0  # length of episodes that the floor window and the roster have room for [s]
    agent_bound: float = 10.0  # flux that keeps the agent out: the limit of class III [kW/m^2] [docs/physics.md 3.1]

    def __post_init__(self) -> None:
        sizes = ("first_release", "first_base", "first_height", "horizon", "agent_bound")
        for name in ("every", "time_scale", "growth", *sizes):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)}")
        if not 0 < self.radiant < 1:
            raise ValueError(f"radiant must be a share between 0 and 1, got {self.radiant}")
        if not self.flame_temperature > self.room_temperature:
            raise ValueError(f"flame_temperature must be above {self.room_temperature}, got {self.flame_temperature}")

    def sizes(self, world: World) -> dict[str, int]:
        lattices = max(1, *(len(s.fires) for s in world.specs))
        fastest = max(self._pace(s.room.floor) * coupling.fastest(s.wind) for s in world.specs)
        cells = fastest * self.time_scale * self.horizon
        window = 2 * (math.ceil(1.25 * cells) + 3) + 1
        flames = min(window**2, math.ceil(1.3 * math.pi * cells**2) + 25)
        return {
            "S": lattices,
            "K": window,
            "F": lattices * flames,
            "O": world.openings.count,
            "R": max(len(rooms.parts(s.room)) for s in world.specs),
            "A": len(world.crew),
        }

    def _pace(self, floor: str) -> float:
        """Cells per second over which a fire spreads on a `floor` that flames touch."""
        solid = fuels.FLOORS.get(floor, fuels.BARE)
        soaked = math.pi / 4.0 * solid.inertia * ((solid.ignition - self.room_temperature) / touching.TOUCH_FLUX) ** 2
        return 1.0 / soaked if soaked > 0 else 0.0

    def reset(self, state: BlazeState, world: World, rows: Tensor) -> None:
        state.temperature[rows] = state.agent_temperature[rows] = state.smoke_temperature[rows] = self.room_temperature
        begin_flames(state, world, rows, fixtures_block=True)
        first, middle = state.flame_cell[rows] >= 0, state.free.shape[-1] // 2
        state.free[rows, :, middle, middle] = False
        state.floor_temperature[rows] = self.room_temperature
        each = self.first_release / first.sum(1, keepdim=True).clamp(min=1)
        state.flame_peak[rows] = torch.where(first, each, burners.CELL_RELEASE)
        state.flame_age[rows] = torch.where(first, ESTABLISHED, 0.0)
        state.first_height[rows] = self.first_height
        kindling.describe_rooms(state, world, rows, self.room_temperature)
        kindling.describe_things(state, world, rows)

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: BlazeState, world: World, dt: float) -> None:
        wetting.soak(state, world)
        extinguishing.go_out(state, world)
        due = world.chance.due(self.every)
        if due is not None:
            waiting = {} if none_set(~due) else {name: getattr(state, name).clone() for name in HEATED}
            self._heat(state, world, dt * self.time_scale * self.every)
            for name, before in waiting.items():
                now = getattr(state, name)
                now.copy_(torch.where(due.view(-1, *[1] * (now.ndim - 1)), now, before))
        state.flame_age.add_(lit(state, world.frame) * (dt * self.time_scale))
        front.advance(state, world)

    def _heat(self, state: BlazeState, world: World, step: float) -> None:
        """Advance smoke, heat and burning by `step` seconds of fire."""
        fires = extinguishing.fight(state, world, self._fires(state, world), step)
        fires = self._smoke(state, world, fires, step)
        self._warm(state, world, fires, step)
        front.warm(state, world, fires, self.room_temperature, step)
        self._burn(state, world, step)

    def _fires(self, state: BlazeState, world: World) -> radiation.Fires:
        """The fires of each environment: B things, then F flames on the floor."""
        return burners.fires(state, world, self.growth, self.first_release, self.first_base, self.radiant)

    def _smoke(self, state: BlazeState, world: World, fires: radiation.Fires, step: float) -> radiation.Fires:
        """Advance the smoke by `step` seconds of fire; returns the fires as far as they have oxygen."""
        state.vents.copy_(leaves.vents(world, leaves.fallen(state, world)))
        burns = smoke.advance(state, world, fires, state.yields, self.room_temperature, step)
        state.heat_release.copy_(burns.sum(1))
        here = smoke.zone_of(state, world.crew.places)
        for name in ("height", "temperature", "density", "low_density"):
            getattr(state, f"smoke_{name}").copy_(getattr(state, f"zone_{name}").gather(1, here))
        return fires._replace(power=burns)

    def _exposure(
        self, state: BlazeState, world: World, fires: radiation.Fires, points: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Flux [kW/m^2] on surfaces facing heat and gas temperature [C], both [E, P], at `points` [m], [E, P, 3]."""
        here = smoke.zone_of(state, points)
        warmth, face = state.zone_temperature.gather(1, here), state.zone_height.gather(1, here)
        room = self.room_temperature + radiation.KELVIN
        layer = state.zone_emissivity.gather(1, here) * radiation.STEFAN * ((warmth + radiation.KELVIN) ** 4 - room**4)
        flux = radiation.flux(fires, world.walls, points, state.ceiling) + layer
        gas = torch.where(points[..., 2] > face, warmth, state.zone_low_temperature.gather(1, here))
        rise = smoke.above(fires, world.walls, points, self.room_temperature)
        jet = self.room_temperature + smoke.under_ceiling(fires, world.walls, points, state.ceiling)
        return flux, torch.maximum(gas, torch.maximum(gas + rise, jet).clamp(max=self.flame_temperature))

    def _warm(self, state: BlazeState, world: World, fires: radiation.Fires, step: float) -> None:
        """Heat things, and all robots, for `step` seconds of fire."""
        things, chests = state.status.shape[1], tenability.chests(world)
        points = torch.cat([world.position, chests], 1)
        flux, gas = self._exposure(state, world, fires, points)
        reached = torch.where(touching.touched(fires, world, state.ceiling), touching.TOUCH_FLUX, 0.0)
        taken = torch.maximum(flux[:, :things], reached) + radiation.CONVECTION * (
            gas[:, :things] - self.room_temperature
        )
        passive = world.exists & ~world.safe & (state.status != BURNING)
        warmed = radiation.warm(state.temperature, taken, state.solid, self.room_temperature, step).clamp(
            max=self.flame_temperature
        )
        state.temperature.copy_(torch.where(passive, warmed, state.temperature))
        wetting.dry(state, taken, step)
        state.agent_temperature.copy_(gas[:, things:])
        seconds = step / self.time_scale  # the robots': they do not age as fast as the fire
        state.agent_dose.add_(tenability.dose_rate(gas[:, things:], flux[:, things:]) * seconds)
        state.agent_toxic_dose.add_(tenability.toxic_rate(smoke.breathed(state, chests)) * seconds)

    def _burn(self, state: BlazeState, world: World, step: float) -> None:
        """Let things catch fire and burn out."""
        live = world.exists & ~world.safe
        burning_now = live & (state.status == BURNING)
        state.burn_age.add_(burning_now * step)
        state.burn_updates.copy_((state.burn_age / (self.time_scale * UPDATE)).long())
        ignites = live & (state.status == NORMAL) & (state.temperature >= state.threshold)
        ignites &= state.coated < wetting.SOAKED
        state.status.add_(ignites | (burning_now & (state.burn_age >= state.burn_end)))  # normal -> burning -> burnt
        state.temperature.masked_fill_(ignites, self.flame_temperature)

    @torch.inference_mode()
    def strain(self, state: BlazeState, world: World) -> Strain:
        heat = self._exposure(state, world, self._fires(state, world), leaves.faces(world))
        return leaves.strain(state, world, *heat, self.room_temperature, self.time_scale)

    def smother(self, state: BlazeState, world: World, things: Tensor) -> None:
        state.coated.masked_fill_(things, 1.0)

    @property
    def clock(self) -> float:
        return self.time_scale

    def image(self, state: BlazeState, world: World, points: Tensor) -> Tensor:
        """Temperature [C], [E, P], that plate thermometers at `points` [m], [E, P, 3], world frame, would show."""
        fires = self._fires(state, world)
        return thermometer.shown(state, world, fires, points, self.room_temperature, self.flame_temperature)

    def threatens(self, target: Any, level: float, height: float) -> bool:
        return ignites(target, level)

    def forbids(self, state: BlazeState, world: World, points: Tensor) -> Tensor:
        """Whether `points` [m], [E, P, 3], world frame, are out of bounds, [E, P], bool.

        They are above a burning floor cell, or under a flux of more than `agent_bound`.
        """
        raised = points + points.new_tensor([0.0, 0.0, tenability.CHEST])
        return self._forbids(state, world, points, self._exposure(state, world, self._fires(state, world), raised)[0])

    def _forbids(self, state: BlazeState, world: World, points: Tensor, flux: Tensor) -> Tensor:
        apart = (state.flame_place[:, None, :, :2] - points[:, :, None, :2]).abs().amax(-1)
        return ((apart <= spread.STEP / 2) & lit(state, world.frame)[:, None]).any(-1) | (flux > self.agent_bound)

    def agent_info(self, state: BlazeState, world: World) -> dict[str, Tensor]:
        chest, own = tenability.chest(world), world.crew.own
        flux, gas = (v[:, 0] for v in self._exposure(state, world, self._fires(state, world), chest))
        return {
            "agent_temperature": gas,
            "agent_flux": flux,
            "agent_dose": own(state.agent_dose).clone(),
            "agent_thermal_class": tenability.thermal_class(gas, flux),
            "agent_overheated": own(state.agent_dose) >= tenability.UNBEARABLE,
            "agent_in_fire": self._forbids(state, world, world.agent_position[:, None], flux[:, None])[:, 0],
            "agent_in_smoke": own(state.smoke_height) < tenability.CHEST,
            "agent_toxic_dose": own(state.agent_toxic_dose).clone(),
            "agent_visibility": smoke.visibility(state, chest)[:, 0],
        }
