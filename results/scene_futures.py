"""What is lost in homes if nobody acts, and if something is done about it at one frame: hazards alone, no robot.

Every change is a row of one batch. Fires are those of `paper`, but for rounding. Water is that of `paper` around things
that stay where they are: what floats counts as lost once it is half under water, as if it were carried off.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.hazards.fire import heat
from hazard_ms.hazards.fire.dousing import NEVER, STEAM
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.fire.fire_state import ALL_USED, BURNING, NORMAL, FireState, lit
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.simulation import building
from hazard_ms.simulation.openings import EVERY
from hazard_ms.simulation.walls import blocked
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec, Task
from hazard_ms.spec.catalogue import CATEGORIES, FLOOD_BOARD
from hazard_ms.tasks import task_of
from hazard_ms.tasks.episode.episode import Episode

FIRE, FLOOD = "HazardHouseFire-v1", "HazardHouseFlood-v1"
AT = 500  # the frame of changes: about when an extinguisher can be at a fire
BOTH_AT = 900  # that of boards in two openings, which are fetched and set one after the other
LOOK_EVERY = 10  # frames from one look at the water to the next
WATER = 1000.0  # density [kg/m^3]: what is lighter floats


@dataclass(frozen=True)
class Change:
    """What is done, and when."""

    fires: tuple[int, ...] = ()  # numbers of those that are put out
    doors: tuple[int, ...] = ()  # numbers of the openings that are shut
    blocked: tuple[int, ...] = ()  # numbers of the openings in which flood boards are set
    at: int = AT  # the frame


@dataclass(frozen=True)
class StillFire(Fire):
    """A fire among things that rest, of whose weights for each other only those of new flames are worked out."""

    kept: ClassVar[dict[int, _Kept]] = {}  # by the identity of the state

    def _warm(self, state: FireState, world: World, due: Tensor) -> None:
        place, temperature, active = self._sources(state, world)
        nodes, slots = state.temperature.shape[1] + 1, place.shape[1]
        kept, cells = self.kept.get(id(state)), state.flame_cell[:, : slots - nodes]
        ways = world.walls.doorway
        if kept is None or not torch.equal(kept.ways, ways):  # doors hold heat back
            weight = torch.zeros(len(place), nodes + state.flame_cell.shape[1], nodes)
            kept = _Kept(weight, torch.full_like(cells, -1), ways.clone())
            kept.weight[:, :nodes] = self._weight(place[:, :nodes], place[:, :nodes], world)
            kept.weight[:, :nodes].diagonal(dim1=1, dim2=2).zero_()
            self.kept[id(state)] = kept
        known = torch.nn.functional.pad(kept.cells, (0, cells.shape[1] - kept.cells.shape[1]), value=-1)
        new = (known != cells).any(0).nonzero().flatten() + nodes
        if len(new):
            kept.weight[:, new] = self._weight(place[:, new], place[:, :nodes], world)
        kept.cells = cells.clone()
        weight, on = kept.weight[:, :slots], active.float()[:, None]
        total = (on @ weight)[:, 0] + 1.0 / self.reach**2
        over = (on * (temperature - self.room_temperature)[:, None] @ weight)[:, 0]
        around = self.room_temperature + over / total
        passive = active[:, : nodes - 1] & ~(state.status == BURNING) & due[:, None]
        state.temperature.copy_(heat.exchange(state.temperature, around[:, :-1], passive, self.decay))
        state.agent_temperature.copy_(heat.exchange(state.agent_temperature, around[:, -1:], due[:, None], self.decay))

    def _weight(self, here: Tensor, there: Tensor, world: World) -> Tensor:
        """Weights of sources `here` [m], [E, M, 3], at points `there` [m], [E, P, 3]: [E, M, P]."""
        apart = (here[:, :, None] - there[:, None]).square().sum(-1).clamp(min=self.nearest**2)
        return apart.reciprocal().masked_fill(blocked(world.walls, here, there), 0.0)


@dataclass
class _Kept:
    weight: Tensor  # [E, M, P]
    cells: Tensor  # of the flames whose weights are known, [E, F] or fewer
    ways: Tensor  # what is open in the walls


def _still(fire: Fire) -> StillFire:
    return StillFire(**{field.name: getattr(fire, field.name) for field in dataclasses.fields(fire)})


def _task(env_id: str) -> Task:
    task = task_of(env_id, "paper")
    made = (_still(h) if isinstance(h, Fire) else h for h in task.hazards)
    return dataclasses.replace(task, hazards=tuple(made))


def losses(
    env_id: str, cases: Sequence[tuple[SceneSpec, Change]], frames: int | None = None, every: int | None = None
) -> list[NDArray[np.float64]]:
    """The frame at which each target of each case is lost, inf if it is not, [T], in the order of its scene.

    `frames` to look at: by default those of the task. `every`: frames in which water rises by a step, by default the
    task's.
    """
    task = _task(env_id)
    if every is not None:
        floods = (dataclasses.replace(h, every=every) if isinstance(h, Flood) else h for h in task.hazards)
        task = dataclasses.replace(task, hazards=tuple(floods))
    specs = [spec for spec, _ in cases]
    world = building.make_world(tuple(specs), torch.device("cpu"))
    if env_id == FLOOD:
        world.equip([FLOOD_BOARD])
    episode, rows = Episode(world, task.hazards, task.safe_place), torch.arange(len(specs))
    episode.begin(rows, torch.zeros(len(specs)).long())
    episode.begin_hazards(rows)
    light = torch.tensor([[_floats(name) for name in row] for row in _padded(world.names, world.num_bodies)])
    middle = world.position[..., 2]
    under = torch.full(middle.shape, -1, dtype=torch.long)
    for frame in range(1, (frames or task.max_frames) + 1):
        if env_id == FIRE and frame % EVERY:
            world.chance.tick()  # fires and doors do nothing then
        else:
            episode.advance(1.0 / 30.0)
        for row, (_, change) in enumerate(cases):
            if frame == change.at:
                _change(episode, row, change)
        if env_id == FLOOD and frame % LOOK_EVERY == 0:
            now = light & world.target & (episode.levels(world.position)[:, 0] >= middle) & (under < 0)
            under[now] = frame
    StillFire.kept.clear()
    first = torch.where(episode.damage.frame >= 0, episode.damage.frame, under)
    found = []
    for row, spec in enumerate(specs):
        at = [int(first[row, world.names[row].index(target.name)]) for target in spec.targets]
        found.append(np.array([frame if frame >= 0 else np.inf for frame in at]))
    return found


def _change(episode: Episode, row: int, change: Change) -> None:
    world = episode.world
    for number in change.doors:
        world.openings.set_open(torch.tensor([row]), number, 0.0)
    if world.equipment is not None:
        boards = world.equipment.tool[row].nonzero()[:, 0]
        for board, number in zip(boards, change.blocked, strict=False):
            world.equipment.state.stands_in[row, board] = number
    if not change.fires:
        return
    state = next(iter(episode.states.values()))
    fires = torch.tensor(world.specs[row].fires)
    mine = torch.cdist(world.position[row, :, :2], fires).argmin(-1)  # things belong to the nearest fire
    lattice = state.flame_cell[row] // state.free.shape[-1] ** 2
    out = lit(state, world.frame)[row] & torch.isin(lattice, torch.tensor(change.fires))
    state.flame_birth[row, out], state.flame_used[row, out] = NEVER, ALL_USED
    cool = torch.isin(mine, torch.tensor(change.fires))
    state.status[row, cool & (state.status[row] == BURNING)] = NORMAL
    state.burn_updates[row, cool] = 0
    state.temperature[row, cool] = state.temperature[row, cool].clamp(max=STEAM)


def _floats(name: str) -> bool:
    kind = CATEGORIES.get(name.rpartition("_")[0])
    return kind is not None and kind.density < WATER


def _padded(names: Sequence[Sequence[str]], length: int) -> list[list[str]]:
    return [[*row, *[""] * (length - len(row))] for row in names]
