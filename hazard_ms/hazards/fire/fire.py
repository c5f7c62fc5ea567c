"""Fire as in the HAZARD challenge: flames heat things, hot things burn, flames spread over the floor (torch).

Two clocks, both counting frames: every 5 frames all temperatures (hazard_ms.hazards.fire.heat), then all states of
burning; every 10 frames flames grow or spread (hazard_ms.hazards.fire.spread, .floor). Flames on the floor never go
out. A thing is where the middle of its base is, as in the original. Images come from a kernel. Constants:
docs/physics.md 1.1; what the presets change: docs/physics.md 1.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, none_set
from hazard_ms.hazards.fire import coupling, floor, heat, spread
from hazard_ms.hazards.fire.burning import Burning
from hazard_ms.hazards.fire.declared import TELLS, ignites
from hazard_ms.hazards.fire.fire_state import BURNING, BURNT, NORMAL, FireState, lit, some_flames
from hazard_ms.hazards.fire.kernels import Heat, temperature_at
from hazard_ms.hazards.walls import Partitions
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import of_environments
from hazard_ms.simulation.world import World
from hazard_ms.spec import Quantity


@dataclass(frozen=True)
class Fire(Burning):
    """A fire with these parameters; the defaults are those of the preset `paper`."""

    state_type: ClassVar[type[State]] = FireState
    tells: ClassVar[dict[str, Quantity]] = TELLS
    signals: ClassVar[str] = "hazard_ms.sensing.senses.of_fire:FireSignals"

    room_temperature: float = 20.0  # [C] [HAZARD fire/fire_utils.py:16]
    flame_temperature: float = 600.0  # temperature of flames and of burning things [C] [HAZARD fire/fire_utils.py:17]
    decay: float = 0.03  # share of the difference to the surroundings made up per update [HAZARD fire/object.py:87]
    reach: float = 0.5  # distance at which a source weighs as much as the room [m] [HAZARD fire/object.py:86]
    nearest: float = 0.5  # nearer sources weigh no more than at this distance [m] [the paper: min(D^-2, d^-2)]
    heat_every: int = 5  # frames from one update of heat to the next [HAZARD fire/manager.py:97]
    strict: bool = False  # ignition above the threshold only, not at it [the paper: "reaches"]
    burn_updates: int = 300  # updates from ignition to burnt [HAZARD fire/object.py:8]
    embers: bool = False  # burnt things go on heating, at the flame's temperature [docs/physics.md R3]
    image_room_weight: float = 1.0  # weight of the room in an observed temperature [docs/physics.md R14]
    crowd: int = 3  # things on a floor cell that keep flames from it [HAZARD fire/fire.py:180]
    fixtures_block: bool = True  # one fixture that stands on a cell keeps flames from it, too [ours]
    max_frames: int = 1500  # the floor window holds every cell that can burn by then
    endurance: float = 60.0  # temperature above which the agent is overheated [C] [HAZARD fire/object.py:62]
    agent_bound: float = 500.0  # air hotter than this keeps the agent out: five flames within `reach` [C] [ours]

    def __post_init__(self) -> None:
        if not 0.0 < self.decay < 1.0:
            raise ValueError(f"decay must be a share between 0 and 1, got {self.decay}")
        for name in ("reach", "nearest", "image_room_weight", "heat_every", "burn_updates", "crowd", "max_frames"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)}")
        if spread.EVERY % self.heat_every:
            raise ValueError(f"heat_every must be a divisor of {spread.EVERY} frames, got {self.heat_every}")

    def sizes(self, world: World) -> dict[str, int]:
        lattices = max(1, *(len(spec.fires) for spec in world.specs))
        return {
            "S": lattices,
            "K": 2 * spread.lattice_reach(self.max_frames) + 1,
            "F": spread.roster_length(self.max_frames, lattices),
            "A": len(world.crew),
        }

    def reset(self, state: FireState, world: World, rows: Tensor) -> None:
        state.temperature[rows] = state.agent_temperature[rows] = self.room_temperature
        state.threshold[rows] = torch.where(
            world.lookup("flammable") > 0, world.lookup("ignition_temperature"), torch.inf
        )[rows]
        begin_flames(state, world, rows, self.fixtures_block)

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: FireState, world: World, dt: float) -> None:
        coupling.drench(state, world)
        due = world.chance.due(self.heat_every)
        if due is None:
            return  # nor is anything to spread, see __post_init__
        self._warm(state, world, due)
        self._burn(state, world, due)
        due = world.chance.due(spread.EVERY)
        if due is not None:
            self._spread(state, world, due)

    def _warm(self, state: FireState, world: World, due: Tensor) -> None:
        """Update all temperatures once in the environments that are `due`, [E]."""
        sources = self._sources(state, world)
        things = state.temperature.shape[1]  # after them come the robots, then flames
        mean = heat.Mean(self.room_temperature, 1.0, self.reach, self.nearest)
        around = mean.at(sources.place[:, : things + len(world.crew)], sources, world.walls)
        # what went out under water has none
        embers = (state.status == BURNT) & state.threshold.isfinite() & self.embers
        fixed = (state.status == BURNING) | embers
        passive = sources.active[:, :things] & ~fixed & due[:, None]
        state.temperature.copy_(heat.exchange(state.temperature, around[:, :things], passive, self.decay))
        bodies = heat.exchange(state.agent_temperature, around[:, things:], due[:, None], self.decay)
        state.agent_temperature.copy_(bodies)

    def _sources(self, state: FireState, world: World) -> heat.Sources:
        """The sources of heat: B things, A robots and the first flames of the roster, M = B + A + F or fewer."""
        base = world.base_of(world.position, world.rotation, world.extent)
        count = some_flames(state)
        flames, like, robots = state.flame_place[:, :count], state.temperature, state.agent_temperature
        return heat.Sources(
            torch.cat([base, world.crew.places, flames], 1),
            torch.cat([like, robots, like.new_full(flames.shape[:2], self.flame_temperature)], 1),
            torch.cat([world.exists & ~world.safe, torch.ones_like(robots).bool(), lit(state, world.frame, count)], 1),
        )

    def _burn(self, state: FireState, world: World, due: Tensor) -> None:
        """Let things catch fire and burn out in the environments that are `due`, [E]."""
        live = world.exists & ~world.safe & due[:, None]
        burning = live & (state.status == BURNING)
        state.burn_updates.add_(burning)
        hot = state.temperature > state.threshold if self.strict else state.temperature >= state.threshold
        ignites = live & (state.status == NORMAL) & hot
        state.status.add_(ignites | (burning & (state.burn_updates >= self.burn_updates)))  # normal -> burning -> burnt
        state.temperature.masked_fill_(ignites, self.flame_temperature)

    def _spread(self, state: FireState, world: World, due: Tensor) -> None:
        """Let flames try their neighbours in environments that are `due`, [E]; new flames appear in the next frame."""
        slots, frame = state.flame_cell.shape[1], world.frame
        draw = world.chance.uniform("fire.spread", slots, 2)
        roster = (state.flame_cell, state.flame_birth, state.flame_last, state.flame_used)
        blown = coupling.drift(world, state.flame_place)
        fed = draw[..., 0] if blown is None else draw[..., 0] / blown.mean(-1)
        success = spread.succeeds(*roster, frame, fed) & due[:, None]
        if none_set(success):
            return
        parent = spread.compact(success, spread.AT_ONCE)  # [E, C]
        some, chosen = parent >= 0, parent.clamp(min=0)
        weight = None if blown is None else blown.gather(1, chosen[..., None].expand(-1, -1, spread.DIRECTIONS))
        direction = spread.pick(state.flame_used.gather(1, chosen), draw[..., 1].gather(1, chosen), weight)
        state.flame_used.scatter_add_(1, chosen, some.long() << direction)
        state.flame_last.copy_(torch.where(success, frame[:, None], state.flame_last))
        cell = torch.where(some, state.flame_cell.gather(1, chosen), -1)
        aim = spread.neighbour(cell, direction, state.free.shape[-1])
        kept = can_burn(state, world, aim, self.crowd)
        if none_set(kept):
            return
        light(state, slice(None), enlisted(state, aim, kept), frame + 1)

    def smother(self, state: FireState, world: World, things: Tensor) -> None:
        state.status.masked_fill_(things & (state.status == BURNING), NORMAL)
        state.temperature.masked_fill_(things, self.room_temperature)

    def image(self, state: FireState, world: World, points: Tensor) -> Tensor:
        points = of_environments(points, world.num_envs)
        found = points.new_empty(points.shape[:2])
        room = (self.room_temperature, self.image_room_weight / self.reach**2, self.nearest, self.flame_temperature)
        sources = ((Heat, state), (Bodies, world), (Partitions, world.walls))
        structs = (world.launches.struct(kind, of) for kind, of in sources)
        world.launches.run(
            temperature_at, tuple(found.shape), points, world.frame, world.crew.places, *room, *structs, found
        )
        return found

    def threatens(self, target: Any, level: float, height: float) -> bool:
        return ignites(target, level)

    def forbids(self, state: FireState, world: World, points: Tensor) -> Tensor:
        """Whether `points` [m], [E, P, 3], world frame, are above a burning floor cell or in air above `agent_bound`.

        The result is [E, P], bool.
        """
        apart = (state.flame_place[:, None, :, :2] - points[:, :, None, :2]).abs().amax(-1)
        inside = ((apart <= spread.STEP / 2) & lit(state, world.frame)[:, None]).any(-1)
        return inside | (self.image(state, world, points) > self.agent_bound)

    def agent_info(self, state: FireState, world: World) -> dict[str, Tensor]:
        own = world.crew.own(state.agent_temperature)
        return {
            "agent_temperature": own.clone(),
            "agent_overheated": own > self.endurance,
            "agent_in_fire": self.forbids(state, world, world.agent_position[:, None])[:, 0],
        }


def enlisted(state: FireState, aim: Tensor, kept: Tensor) -> Tensor:
    """Numbers of the cells `aim`, [E, C], that are `kept`, [E, C], on the next places of a roster, [E, F], else -1."""
    new = spread.compact(kept, spread.AT_ONCE)
    cell = torch.where(new >= 0, aim.gather(1, new.clamp(min=0)), -1)
    slot = torch.arange(state.flame_cell.shape[1], device=aim.device)
    number = slot - (state.flame_cell >= 0).sum(1, keepdim=True)  # of the new flame per slot
    return torch.where(
        (number >= 0) & (number < spread.AT_ONCE), cell.gather(1, number.clamp(0, spread.AT_ONCE - 1)), -1
    )


def can_burn(state: FireState, world: World, aim: Tensor, crowd: int) -> Tensor:
    """Whether the cells `aim`, [E, C], can burn, [E, C], bool; -1 for no cell.

    They must be free of furniture, closed doors, flames, `crowd` things, and not be the aim of an earlier flame.
    """
    there = (aim >= 0) & state.free.flatten(1).gather(1, aim.clamp(min=0))
    place = spread.places(aim, state.anchor, state.free.shape[-1])
    there &= ~(floor.overlap(place, state.flame_place) & (state.flame_cell >= 0)[:, None]).any(-1)
    if none_set(there):
        return there
    there &= (floor.crowd(world, place) < crowd) & ~floor.shut(world, place[..., 0], place[..., 1])
    earlier = (floor.overlap(place, place) & there[:, None]).tril(-1)
    return there & ~earlier.any(-1)


def light(state: FireState, rows: Tensor | slice, cell: Tensor, frame: Tensor) -> None:
    """Enter the cells `cell`, [R, F], -1 for none, on the roster of the environments `rows`, born at `frame`, [R]."""
    new = cell >= 0
    place = spread.places(cell, state.anchor[rows], state.free.shape[-1])
    state.flame_cell[rows] = torch.where(new, cell, state.flame_cell[rows])
    state.flame_place[rows] = torch.where(new[..., None], place, state.flame_place[rows])
    state.flame_birth[rows] = torch.where(new, frame[:, None], state.flame_birth[rows])
    state.flame_last[rows] = torch.where(new, frame[:, None], state.flame_last[rows])


def begin_flames(state: FireState, world: World, rows: Tensor, fixtures_block: bool) -> None:
    """Light the first fires of the environments `rows`, [R] indices, and find out where their floors can burn."""
    lattices, window = state.free.shape[1:3]
    fires = [world.specs[row].fires for row in rows.tolist()]
    padded = [[*f, *[(0.0, 0.0)] * (lattices - len(f))] for f in fires]
    state.anchor[rows] = torch.tensor(padded, device=world.device)
    lattice = torch.arange(lattices, device=world.device)
    there = lattice < torch.tensor([[len(f)] for f in fires], device=world.device)
    first = torch.full_like(state.flame_cell[rows], -1)
    first[:, :lattices] = torch.where(there, lattice * window**2 + window**2 // 2, -1)
    light(state, rows, first, torch.zeros_like(rows))
    free = floor.free_floor(world, rows, state.anchor[rows], window, fixtures_block)
    free[:, :, window // 2, window // 2] |= there
    state.free[rows] = free


def floor_flames(state: FireState, frame: Tensor) -> tuple[Tensor, Tensor]:
    """Places [m], [E, F, 3], world frame, and scales, [E, F], of the flames on the floor at `frame`, [E].

    A scale of 0 means that there is no flame yet.
    """
    scale = spread.SCALE_FIRST + spread.SCALE_STEP * spread.growth(state.flame_birth, frame[:, None])
    return state.flame_place, torch.where(lit(state, frame), scale, 0.0)


def body_flames(state: FireState, heat_every: int = Fire.heat_every) -> Tensor:
    """Scales, [E, B], of the flames on burning things, which grow like those on the floor; 0 where nothing burns."""
    steps = (state.burn_updates * heat_every // spread.EVERY).clamp(max=spread.GROWTH_STEPS)
    return torch.where(state.status == BURNING, spread.SCALE_FIRST + spread.SCALE_STEP * steps, 0.0)
