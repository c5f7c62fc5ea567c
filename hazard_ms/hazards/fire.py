"""Fire as in the HAZARD challenge: flames heat things, things at their ignition temperature burn, flames spread over the floor.

Two clocks, both counting frames: every 5 frames all temperatures (hazard_ms.hazards.heat), then all states of burning; every 10
frames flames grow or spread (hazard_ms.hazards.spread, .floor). Flames on the floor never go out. A thing is where the middle of
its base is, as in the original. Constants: physics.md 1.1 [C]; what the presets change: physics.md 1.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards import floor, heat, spread, together
from hazard_ms.hazards.base import Hazard, State, nobody
from hazard_ms.hazards.fire_state import BURNING, BURNT, NORMAL, FireState
from hazard_ms.world import World


@dataclass(frozen=True)
class Fire(Hazard):
    """Parameters; the defaults are those of the preset `paper`."""

    name: ClassVar[str] = "fire"
    state_type: ClassVar[type[State]] = FireState
    uses: ClassVar[tuple[str, ...]] = ("water", "air")

    room_temperature: float = 20.0  # [C] [C fire_utils.py:16]
    flame_temperature: float = 600.0  # of flames and of burning things [C] [C fire_utils.py:17]
    decay: float = 0.03  # share of the difference to the surroundings made up per update [C object.py:87]
    reach: float = 0.5  # distance at which a source weighs as much as the room [m] [C object.py:86]
    nearest: float = 0.5  # nearer sources weigh no more than at this distance [m] [P min(D^-2, d^-2)]
    heat_every: int = 5  # frames [C manager.py:97]
    strict: bool = False  # ignition above the threshold only, not at it [P "reaches"]
    burn_updates: int = 300  # updates from ignition to burnt [C object.py:8]
    embers: bool = False  # burnt things go on heating, at the flame's temperature [physics.md R3]
    image_room_weight: float = 1.0  # of the room in an observed temperature [physics.md R14]
    crowd: int = 3  # things on a floor cell that keep flames from it [C fire.py:180]
    fixtures_block: bool = True  # one fixture that stands on a cell keeps flames from it, too [ours]
    max_frames: int = 1500  # the floor window holds every cell that can burn by then
    endurance: float = 60.0  # temperature above which the agent is overheated [C] [C object.py:62]
    agent_bound: float = 500.0  # air hotter than this keeps the agent out: five flames within `reach` [C] [ours]

    def __post_init__(self) -> None:
        if not 0.0 < self.decay < 1.0:
            raise ValueError(f"decay is {self.decay}; a share between 0 and 1 is allowed")
        for name in ("reach", "nearest", "image_room_weight", "heat_every", "burn_updates", "crowd", "max_frames"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is {getattr(self, name)}; a positive number is allowed")
        if spread.EVERY % self.heat_every:
            raise ValueError(f"heat_every is {self.heat_every}; a divisor of {spread.EVERY} frames is allowed")

    def sizes(self, world: World) -> dict[str, int]:
        lattices = max(1, *(len(spec.fires) for spec in world.specs))
        return {
            "S": lattices,
            "K": 2 * spread.lattice_reach(self.max_frames) + 1,
            "F": spread.roster_length(self.max_frames, lattices),
        }

    def reset(self, state: FireState, world: World, rows: Tensor) -> None:
        state.temperature[rows] = state.agent_temperature[rows] = self.room_temperature
        state.threshold[rows] = torch.where(world.lookup("flammable") > 0, world.lookup("ignition_temperature"), torch.inf)[rows]
        begin_flames(state, world, rows, self.fixtures_block)

    def advance(self, state: FireState, world: World, dt: float) -> None:
        together.drench(state, world)
        due = world.frame % self.heat_every == 0
        if nobody(due):
            return  # nor is anything to spread, see __post_init__
        self._warm(state, world, due)
        self._burn(state, world, due)
        due = world.frame % spread.EVERY == 0
        if not nobody(due):
            self._spread(state, world, due)

    def _warm(self, state: FireState, world: World, due: Tensor) -> None:
        """One update of all temperatures in the environments that are `due`, [E]."""
        sources = self._sources(state, world)
        nodes = state.temperature.shape[1] + 1  # things and the agent; after them come the flames
        mean = heat.Mean(self.room_temperature, 1.0, self.reach, self.nearest)
        around = mean.at(sources.place[:, :nodes], sources, apart=True)
        embers = (state.status == BURNT) & state.threshold.isfinite() & self.embers  # what went out under water has none
        fixed = (state.status == BURNING) | embers
        passive = sources.active[:, : nodes - 1] & ~fixed & due[:, None]
        state.temperature.copy_(heat.exchange(state.temperature, around[:, :-1], passive, self.decay))
        state.agent_temperature.copy_(heat.exchange(state.agent_temperature, around[:, -1], due, self.decay))

    def _sources(self, state: FireState, world: World) -> heat.Sources:
        """The B things, the agent and the F flames: M = B + 1 + F."""
        base = world.base_of(world.position, world.rotation, world.extent)
        flame_temperature = torch.full_like(state.flame_place[..., 0], self.flame_temperature)
        agent = torch.ones_like(state.agent_temperature, dtype=torch.bool)[:, None]
        return heat.Sources(
            torch.cat([base, world.agent_position[:, None], state.flame_place], 1),
            torch.cat([state.temperature, state.agent_temperature[:, None], flame_temperature], 1),
            torch.cat([world.exists & ~world.safe, agent, lit(state, world.frame)], 1),
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
        """Let flames try their neighbours in the environments that are `due`, [E]; what they ignite is born in the next frame."""
        slots, frame = state.flame_cell.shape[1], world.frame
        draw = world.chance.uniform("fire.spread", slots, 2)
        roster = (state.flame_cell, state.flame_birth, state.flame_last, state.flame_used)
        blown = together.drift(world, state.flame_place)
        fed = draw[..., 0] if blown is None else draw[..., 0] / blown.mean(-1)
        success = spread.succeeds(*roster, frame, fed) & due[:, None]
        if nobody(success):
            return
        parent = spread.compact(success, spread.AT_ONCE)  # [E, C]
        some = parent >= 0
        chosen = parent.clamp(min=0)
        weight = None if blown is None else blown.gather(1, chosen[..., None].expand(-1, -1, spread.DIRECTIONS))
        direction = spread.pick(state.flame_used.gather(1, chosen), draw[..., 1].gather(1, chosen), weight)
        state.flame_used.scatter_add_(1, chosen, some.long() << direction)
        state.flame_last.copy_(torch.where(success, frame[:, None], state.flame_last))
        aim = spread.neighbour(torch.where(some, state.flame_cell.gather(1, chosen), -1), direction, state.free.shape[-1])
        kept = can_burn(state, world, aim, self.crowd)
        if nobody(kept):
            return
        light(state, slice(None), enlisted(state, aim, kept), frame + 1)

    def damaged(self, state: FireState, world: World) -> Tensor:
        return state.status != NORMAL

    def image(self, state: FireState, world: World, points: Tensor) -> Tensor:
        mean = heat.Mean(self.room_temperature, self.image_room_weight, self.reach, self.nearest)
        return mean.at(points, self._sources(state, world))

    def forbids(self, state: FireState, world: World, points: Tensor) -> Tensor:
        """Above a floor cell that burns, or in air hotter than `agent_bound`, [E, P]; `points` [m], [E, P, 3], world frame."""
        apart = (state.flame_place[:, None, :, :2] - points[:, :, None, :2]).abs().amax(-1)
        inside = ((apart <= spread.STEP / 2) & lit(state, world.frame)[:, None]).any(-1)
        return inside | (self.image(state, world, points) > self.agent_bound)

    def agent_info(self, state: FireState, world: World) -> dict[str, Tensor]:
        place = world.agent_position[:, None]
        return {
            "agent_temperature": state.agent_temperature.clone(),
            "agent_overheated": state.agent_temperature > self.endurance,
            "agent_in_fire": self.forbids(state, world, place)[:, 0],
        }


def enlisted(state: FireState, aim: Tensor, kept: Tensor) -> Tensor:
    """The cells `aim`, [E, C], that are `kept`, [E, C], at the next places of the roster: [E, F], -1 elsewhere."""
    new = spread.compact(kept, spread.AT_ONCE)
    cell = torch.where(new >= 0, aim.gather(1, new.clamp(min=0)), -1)
    slot = torch.arange(state.flame_cell.shape[1], device=aim.device)
    number = slot - (state.flame_cell >= 0).sum(1, keepdim=True)  # of the new flame per slot
    return torch.where((number >= 0) & (number < spread.AT_ONCE), cell.gather(1, number.clamp(0, spread.AT_ONCE - 1)), -1)


def can_burn(state: FireState, world: World, aim: Tensor, crowd: int) -> Tensor:
    """Which of the cells `aim`, [E, C], -1 for none, are free of furniture, flames, `crowd` things, and aims of earlier flames."""
    there = (aim >= 0) & state.free.flatten(1).gather(1, aim.clamp(min=0))
    place = spread.places(aim, state.anchor, state.free.shape[-1])
    there &= ~(floor.overlap(place, state.flame_place) & (state.flame_cell >= 0)[:, None]).any(-1)
    if nobody(there):
        return there
    there &= floor.crowd(world, place) < crowd
    earlier = (floor.overlap(place, place) & there[:, None]).tril(-1)
    return there & ~earlier.any(-1)


def light(state: FireState, rows: Tensor | slice, cell: Tensor, frame: Tensor) -> None:
    """Enter the cells `cell` [rows, F], -1 for none, on the roster, born at `frame` [rows]."""
    new = cell >= 0
    place = spread.places(cell, state.anchor[rows], state.free.shape[-1])
    state.flame_cell[rows] = torch.where(new, cell, state.flame_cell[rows])
    state.flame_place[rows] = torch.where(new[..., None], place, state.flame_place[rows])
    state.flame_birth[rows] = torch.where(new, frame[:, None], state.flame_birth[rows])
    state.flame_last[rows] = torch.where(new, frame[:, None], state.flame_last[rows])


def begin_flames(state: FireState, world: World, rows: Tensor, fixtures_block: bool) -> None:
    """Light the fires of the scenes `rows`, and find out where their floors can burn."""
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


def lit(state: FireState, frame: Tensor) -> Tensor:
    """Which flames of the roster burn at `frame` [E]: [E, F], bool."""
    return (state.flame_cell >= 0) & (state.flame_birth <= frame[:, None])


def floor_flames(state: FireState, frame: Tensor) -> tuple[Tensor, Tensor]:
    """Places [m], [E, F, 3], world frame, and scales of the flames on the floor at `frame` [E]; scale 0: no flame there (yet)."""
    scale = spread.SCALE_FIRST + spread.SCALE_STEP * spread.growth(state.flame_birth, frame[:, None])
    return state.flame_place, torch.where(lit(state, frame), scale, 0.0)


def body_flames(state: FireState, heat_every: int = Fire.heat_every) -> Tensor:
    """Scale of the flames on burning things, which grow as those on the floor do; 0 for things that do not burn, [E, B]."""
    steps = (state.burn_updates * heat_every // spread.EVERY).clamp(max=spread.GROWTH_STEPS)
    return torch.where(state.status == BURNING, spread.SCALE_FIRST + spread.SCALE_STEP * steps, 0.0)
