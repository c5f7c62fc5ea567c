"""Fire of the preset `realistic`: heat release, radiation, ignition, spread over the floor, and a layer of smoke, in SI seconds.

    heat       each burning thing by its measured or t^2 curve (hazard_ms.hazards.burning), each cell of the floor as a t^2 fire
    ignition   of thick and thin solids by the flux of all fires, of the smoke layer, and of flames that touch (.radiation)
    spread     a burning cell lights each of its four neighbours at the rate FRONT V / dx, V by the material of the floor (.fuels)
    smoke      one layer per scene (.smoke); dose of heat of the agent (.tenability)

Burnt things give off no heat and cool. Nothing depends on the length of a frame: rates are turned into probabilities by
1 - exp(-rate dt), curves are functions of time, surfaces are warmed exactly. Heat is updated every few frames, flames on the floor in
each. `lapse` is the one number that is not physics: seconds of fire per second of the episode, since rooms burn for minutes and episodes
last 50 s. Limits: flames on the floor do not go out (carpet of 4 kg/m^2 burns longer than an episode), no conduction, no shading; the
layer does not care about partitions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.catalogue import CATEGORIES
from hazard_ms.hazards import burning, floor, fuels, radiation, smoke, spread, tenability, together
from hazard_ms.hazards.base import Hazard, State, nobody
from hazard_ms.hazards.blaze_state import HEATED, BlazeState
from hazard_ms.hazards.fire import begin_flames, can_burn, enlisted, light, lit
from hazard_ms.hazards.fire_state import BURNING, NORMAL
from hazard_ms.world import World

FRONT = 0.5  # mean time per cell of a front, in units of 1 / rate, over ten cells; 0.41 far out [ours, see case 4.3 of validation]
CELL_AREA = spread.STEP**2  # [m^2]
CELL_WIDTH = math.sqrt(4.0 * CELL_AREA / math.pi)  # [m]
ESTABLISHED = 60.0  # age of the fires with which a scene begins [s] [ours]
FLOOR_SOOT = fuels.MATERIALS["wood"].soot / fuels.MATERIALS["wood"].combustion  # [kg/kJ]
TOUCH = 0.05  # a flame leans over so far [m] [ours]
TOUCH_FLUX = 30.0  # on what a flame touches [kW/m^2] [M: SFPE, flames on walls 20 to 40]
NO_CROWD = 2**31  # things on the floor do not keep flames away
UPDATE = 1 / 6  # of an episode: the original's interval of 5 frames, in which pictures count the age of flames on things [s]
CHEST = 1.0  # where the agent feels heat and smoke [m] [ours]


@dataclass(frozen=True)
class Blaze(Hazard):
    """Parameters; the defaults are those of the preset `realistic`."""

    name: ClassVar[str] = "fire"
    state_type: ClassVar[type[State]] = BlazeState
    uses: ClassVar[tuple[str, ...]] = ("water", "air")

    room_temperature: float = 20.0  # [C] [physics.md 4.4]
    flame_temperature: float = 820.0  # of what burns, and the most of everything: 800 K above the room [C] [M: McCaffrey, flame region]
    every: int = 5  # frames from one update of heat to the next, as in the paper [C manager.py:97]
    lapse: float = 4.5  # seconds of fire per second: 0.15 s in a frame of 1/30 s [physics.md 3.1, flame spread]
    radiant: float = 0.35  # share of the heat that is radiated, where no measurement tells [physics.md 4.4]
    first_release: float = fuels.BASKET  # of the fires with which a scene begins [kW]
    horizon: float = 50.0  # the floor window and the roster serve episodes of this length [s]
    agent_bound: float = 10.0  # flux that keeps the agent out: the limit of class III [kW/m^2] [physics.md 3.1]

    def __post_init__(self) -> None:
        for name in ("every", "lapse", "first_release", "horizon", "agent_bound"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}; a positive number is allowed")
        if not 0 < self.radiant < 1:
            raise ValueError(f"radiant is {self.radiant}; a share between 0 and 1 is allowed")
        if not self.flame_temperature > self.room_temperature:
            raise ValueError(f"flame_temperature is {self.flame_temperature}; more than the room's {self.room_temperature} is allowed")

    def sizes(self, world: World) -> dict[str, int]:
        lattices = max(1, *(len(s.fires) for s in world.specs))
        fastest = max(fuels.SPREAD.get(s.room.floor, 0.0) * together.fastest(s.wind) for s in world.specs)
        cells = fastest * self.lapse * self.horizon / spread.STEP
        window = 2 * (math.ceil(1.25 * cells) + 3) + 1
        flames = min(window**2, math.ceil(1.3 * math.pi * cells**2) + 25)
        return {"S": lattices, "K": window, "F": lattices * flames, "O": max(1, *(len(smoke.gaps(s.room)) for s in world.specs))}

    def reset(self, state: BlazeState, world: World, rows: Tensor) -> None:
        state.temperature[rows] = state.agent_temperature[rows] = state.smoke_temperature[rows] = self.room_temperature
        begin_flames(state, world, rows, fixtures_block=True)
        first = state.flame_cell[rows] >= 0
        state.flame_peak[rows] = torch.where(first, self.first_release, CELL_AREA * fuels.AS_GOODS)
        state.flame_age[rows] = torch.where(first, ESTABLISHED, 0.0)
        specs = [world.specs[row] for row in rows.tolist()]
        state.floor_speed[rows] = torch.tensor([fuels.SPREAD.get(s.room.floor, 0.0) for s in specs], device=world.device)
        state.height[rows] = torch.tensor([s.room.height for s in specs], device=world.device)
        state.smoke_height[rows] = state.height[rows]
        state.roofed[rows] = torch.tensor([float(not s.room.open_air) for s in specs], device=world.device)
        padded = [[*g, *[(0.0, 0.0, 0.0)] * (state.vents.shape[1] - len(g))] for g in (smoke.gaps(s.room) for s in specs)]
        state.vents[rows] = torch.tensor(padded, device=world.device)
        self._reset_fuels(state, world, rows)

    def _reset_fuels(self, state: BlazeState, world: World, rows: Tensor) -> None:
        def of(attribute: str) -> Tensor:
            table = torch.tensor([float(getattr(fuels.material(c), attribute)) for c in CATEGORIES], device=world.device)
            return table[world.category.clamp(min=0)]

        for name in ("ignition", "critical", "inertia", "sheet"):
            getattr(state, name)[rows] = of(name)[rows]
        state.threshold[rows] = torch.where(world.lookup("flammable") > 0, state.ignition, torch.inf)[rows]
        wide, deep, high = world.extent.unbind(-1)
        mass = torch.where(world.movable, world.mass, world.lookup("density") * wide * deep * high)  # fixtures weigh nothing on purpose
        peak, energy = of("release") * (wide * deep + 2.0 * (wide + deep) * high), of("combustion") * mass
        measured = torch.tensor([fuels.MEASURED.get(c, (0.0, 0.0)) for c in CATEGORIES], device=world.device)[world.category.clamp(min=0)]
        known = measured[..., 0] > 0
        peak, energy = torch.where(known, measured[..., 0], peak), torch.where(known, measured[..., 1], energy)
        made = burning.course(of("growth"), peak, energy)
        numbers = {name: k for k, name in enumerate(fuels.CURVES)}
        curve = torch.tensor([numbers.get(fuels.CURVE_OF.get(c, ""), -1) for c in CATEGORIES], device=world.device)
        state.curve[rows] = curve[world.category.clamp(min=0)][rows]
        state.growth[rows], state.peak[rows], state.decline[rows] = made.growth[rows], made.peak[rows], made.decline[rows]
        state.burn_end[rows] = torch.where(state.curve >= 0, burning.lasting(state.curve), made.end)[rows]
        state.soot_yield[rows] = (of("soot") / of("combustion"))[rows]

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: BlazeState, world: World, dt: float) -> None:
        together.drench(state, world)
        due = world.frame % self.every == 0
        if not nobody(due):
            waiting = {} if nobody(~due) else {name: getattr(state, name).clone() for name in HEATED}
            self._heat(state, world, dt * self.lapse * self.every)
            for name, before in waiting.items():
                now = getattr(state, name)
                now.copy_(torch.where(due.view(-1, *[1] * (now.ndim - 1)), now, before))
        state.flame_age.add_(lit(state, world.frame) * (dt * self.lapse))
        self._spread(state, world, dt * self.lapse)

    def _heat(self, state: BlazeState, world: World, step: float) -> None:
        """Smoke, heat and burning over `step` seconds of fire."""
        fires = self._fires(state, world)
        self._smoke(state, world, fires, step)
        self._warm(state, world, fires, step)
        self._burn(state, world, step)

    def _fires(self, state: BlazeState, world: World) -> radiation.Fires:
        """The B things, then the F flames on the floor."""
        there = world.exists & ~world.safe & (state.status == BURNING)
        things = burning.release(state.course, state.burn_age) * there
        flames = torch.minimum(burning.t_squared(fuels.FAST, state.flame_age), state.flame_peak)
        flames = flames * lit(state, world.frame)
        base = world.base_of(world.position, world.rotation, world.extent)
        own = (4.0 / math.pi * world.extent[..., 0] * world.extent[..., 1]).sqrt()
        return radiation.Fires(
            torch.cat([base, state.flame_place], 1),
            torch.cat([things, flames], 1),
            torch.cat([burning.radiant(state.curve, self.radiant), torch.full_like(flames, self.radiant)], 1),
            torch.cat([own, torch.full_like(flames, CELL_WIDTH)], 1),
        )

    def _smoke(self, state: BlazeState, world: World, fires: radiation.Fires, step: float) -> None:
        """What the layer becomes in `step` seconds of fire."""
        power = fires.power.sum(1)
        convected = ((1.0 - fires.radiant) * fires.power).sum(1)
        base = (fires.power * fires.place[..., 2]).sum(1) / power.clamp(min=1e-6)
        things = state.status.shape[1]
        soot = (fires.power[:, :things] * state.soot_yield).sum(1) + FLOOR_SOOT * fires.power[:, things:].sum(1)
        walls = smoke.Walls(world.room.prod(-1), state.height, 2.0 * world.room.sum(-1))
        before = smoke.Layer(state.smoke_volume, state.smoke_energy, state.smoke_mass)
        source = smoke.Source(power, convected, base, soot)
        layer = smoke.fill(before, walls, state.vents, source, self.room_temperature, self.flame_temperature, step)
        state.heat_release.copy_(power)
        layer = smoke.Layer(layer.volume * state.roofed, layer.energy * state.roofed, layer.soot * state.roofed)
        state.smoke_volume.copy_(layer.volume)
        state.smoke_energy.copy_(layer.energy)
        state.smoke_mass.copy_(layer.soot)
        state.smoke_height.copy_(smoke.interface(layer.volume, walls))
        state.smoke_temperature.copy_(smoke.temperature(layer, self.room_temperature))
        state.smoke_density.copy_(smoke.extinction(layer))

    def _exposure(self, state: BlazeState, fires: radiation.Fires, points: Tensor) -> tuple[Tensor, Tensor]:
        """Flux [kW/m^2] on surfaces that face the heat, and gas temperature [C], at `points` [m], [E, P, 3]: each [E, P]."""
        kelvin = state.smoke_temperature + radiation.KELVIN
        opaque = 1.0 - radiation.exponential(-state.smoke_density * (state.height - state.smoke_height))
        layer = opaque * radiation.STEFAN * (kelvin**4 - (self.room_temperature + radiation.KELVIN) ** 4)
        flux = radiation.flux(fires, points, state.height) + layer[:, None]
        inside = points[..., 2] > state.smoke_height[:, None]
        gas = torch.where(inside, state.smoke_temperature[:, None], self.room_temperature)
        rise = smoke.above(fires, points, self.room_temperature)
        return flux, (gas + rise).clamp(max=self.flame_temperature)

    def _warm(self, state: BlazeState, world: World, fires: radiation.Fires, step: float) -> None:
        """Heat things, and the agent, for `step` seconds of fire."""
        things = state.status.shape[1]
        points = torch.cat([world.position, self._chest(world)], 1)
        flux, gas = self._exposure(state, fires, points)
        reached = torch.where(touched(fires, world, state.height), TOUCH_FLUX, 0.0)
        taken = torch.maximum(flux[:, :things], reached) + radiation.CONVECTION * (gas[:, :things] - self.room_temperature)
        passive = world.exists & ~world.safe & (state.status != BURNING)
        warmed = radiation.warm(state.temperature, taken, state.solid, self.room_temperature, step).clamp(max=self.flame_temperature)
        state.temperature.copy_(torch.where(passive, warmed, state.temperature))
        state.agent_temperature.copy_(gas[:, -1])
        state.agent_dose.add_(tenability.dose_rate(gas[:, -1], flux[:, -1]) * step)

    def _burn(self, state: BlazeState, world: World, step: float) -> None:
        """Let things catch fire and burn out."""
        live = world.exists & ~world.safe
        burning_now = live & (state.status == BURNING)
        state.burn_age.add_(burning_now * step)
        state.burn_updates.copy_((state.burn_age / (self.lapse * UPDATE)).long())
        ignites = live & (state.status == NORMAL) & (state.temperature >= state.threshold)
        state.status.add_(ignites | (burning_now & (state.burn_age >= state.burn_end)))  # normal -> burning -> burnt
        state.temperature.masked_fill_(ignites, self.flame_temperature)

    def _spread(self, state: BlazeState, world: World, step: float) -> None:
        """Let flames on the floor light their neighbours; what they light is born in the next frame."""
        if nobody(state.floor_speed > 0):
            return
        slots = state.flame_cell.shape[1]
        blown = together.drift(world, state.flame_place)
        speed = state.floor_speed[:, None, None] * (1.0 if blown is None else blown)
        chance = 1.0 - radiation.exponential(-FRONT * speed / spread.STEP * step)
        draw = world.chance.uniform("fire.spread", slots, spread.DIRECTIONS)
        direction = torch.arange(spread.DIRECTIONS, device=draw.device)
        unused = (state.flame_used[..., None] >> direction) & 1 == 0
        success = ((draw < chance) & unused & lit(state, world.frame)[..., None]).flatten(1)
        if nobody(success):
            return
        chosen = spread.compact(success, spread.AT_ONCE)
        parent = chosen.clamp(min=0) // spread.DIRECTIONS
        cell = torch.where(chosen >= 0, state.flame_cell.gather(1, parent), -1)
        aim = spread.neighbour(cell, chosen.clamp(min=0) % spread.DIRECTIONS, state.free.shape[-1])
        state.flame_used.scatter_add_(1, parent, (chosen >= 0).long() << (chosen.clamp(min=0) % spread.DIRECTIONS))
        kept = can_burn(state, world, aim, NO_CROWD)
        if not nobody(kept):
            light(state, slice(None), enlisted(state, aim, kept), world.frame + 1)

    @staticmethod
    def _chest(world: World) -> Tensor:
        """Where the agent feels heat [m], [E, 1, 3]."""
        return (world.agent_position + world.agent_position.new_tensor([0.0, 0.0, CHEST]))[:, None]

    def damaged(self, state: BlazeState, world: World) -> Tensor:
        return state.status != NORMAL

    def image(self, state: BlazeState, world: World, points: Tensor) -> Tensor:
        """What a plate thermometer at `points` [m], [E, P, 3], shows [C]: radiation, plumes and the layer of smoke, [E, P]."""
        flux, gas = self._exposure(state, self._fires(state, world), points)
        return radiation.adiabatic(flux, gas, self.room_temperature).clamp(max=self.flame_temperature)

    def forbids(self, state: BlazeState, world: World, points: Tensor) -> Tensor:
        """Above a floor cell that burns, or under more than `agent_bound`, [E, P]; `points` [m], [E, P, 3], world frame."""
        apart = (state.flame_place[:, None, :, :2] - points[:, :, None, :2]).abs().amax(-1)
        inside = ((apart <= spread.STEP / 2) & lit(state, world.frame)[:, None]).any(-1)
        raised = points + points.new_tensor([0.0, 0.0, CHEST])
        return inside | (self._exposure(state, self._fires(state, world), raised)[0] > self.agent_bound)

    def agent_info(self, state: BlazeState, world: World) -> dict[str, Tensor]:
        flux, gas = (v[:, 0] for v in self._exposure(state, self._fires(state, world), self._chest(world)))
        return {
            "agent_temperature": gas,
            "agent_flux": flux,
            "agent_dose": state.agent_dose.clone(),
            "agent_thermal_class": tenability.thermal_class(gas, flux),
            "agent_overheated": state.agent_dose >= tenability.UNBEARABLE,
            "agent_in_fire": self.forbids(state, world, world.agent_position[:, None])[:, 0],
            "agent_in_smoke": state.smoke_height < CHEST,
        }


def touched(fires: radiation.Fires, world: World, ceiling: Tensor) -> Tensor:
    """Things that the flames of another one, or of the floor, reach, [E, B]: boxes along the axes, flames upright."""
    half = floor.half_spans(world.rotation, world.extent)
    bodies = half.shape[1]
    cells = half.new_full((*fires.power[:, bodies:].shape, 2), spread.STEP / 2)
    reach = torch.cat([half[..., :2], cells], 1)  # [E, M, 2]
    top = fires.place[..., 2] + torch.minimum(radiation.flame_length(fires.power, fires.diameter), ceiling[:, None])
    top = torch.cat([torch.maximum(top[:, :bodies], (world.position + half)[..., 2]), top[:, bodies:]], 1)
    gap = (fires.place[:, :, None, :2] - world.position[:, None, :, :2]).abs()
    beside = (gap <= (reach[:, :, None] + half[:, None, :, :2] + TOUCH)).all(-1)
    low, high = (world.position - half)[..., 2], (world.position + half)[..., 2]
    level = (low[:, None] <= top[..., None]) & (high[:, None] >= fires.place[..., None, 2])
    near = beside & level & (fires.power > 0)[..., None]
    near[:, :bodies].diagonal(dim1=1, dim2=2).fill_(False)
    return near.any(1)
