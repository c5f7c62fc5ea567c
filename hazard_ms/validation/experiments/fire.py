"""Experiments with the fire of the original's laws, whose results hazard_ms.validation.fire_cases compares."""

from __future__ import annotations

import functools
import math

import torch

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire import BURNING, BURNT, NORMAL, Fire
from hazard_ms.hazards.fire.heat import Mean, Sources, exchange
from hazard_ms.hazards.presets import fire
from hazard_ms.simulation.walls import Walls
from hazard_ms.validation.experiments.fire_room import (
    ORIGINAL,
    begin,
    begin_without_spread,
    one_source,
    room_world,
    run,
    updates,
)

PAPER, SHIPPED = (preset for preset in map(fire, ORIGINAL) if isinstance(preset, Fire))
NEVER = math.inf
CELLS = 10_000  # number of flames whose ages at success are counted


def equilibrium(preset: Fire, distance: float) -> float:
    """Temperature [C] of a thing `distance` [m] from one flame, in the end."""
    world = one_source([distance])
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 350)
    return float(state.temperature)


@functools.cache
def cooling() -> dict[int, float]:
    """Temperature [C] of a thing of 200 C in an empty room after this many updates."""
    world = room_world([("pan", (10.0, 10.0, 0.0))])
    state = begin(PAPER, world)
    state.temperature[:] = 200.0
    seen = {}
    for count in range(1, 101):
        updates(PAPER, state, world, 1)
        seen[count] = float(state.temperature)
    return seen


def pair(distance: float, thing: int) -> float:
    """Temperature [C] of one of two things of 300 and 20 C, `distance` [m] apart, after 50 updates."""
    world = room_world([("pan", (10.0, 10.0, 0.0)), ("pan", (10.0 + distance, 10.0, 0.0))])
    state = begin(SHIPPED, world)
    state.temperature[0] = torch.tensor([300.0, 20.0])
    updates(SHIPPED, state, world, 50)
    return float(state.temperature[0, thing])


def isolated(thing: int) -> float:
    """Temperature [C] of one of the two things of `pair`, 0.5 m apart, without a room, after 200 updates."""
    points, temperature = torch.tensor([[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]]), torch.tensor([[300.0, 20.0]])
    mean = Mean(20.0, 0.0, 0.5, 0.1)
    for _ in range(200):
        around = mean.at(points, Sources(points, temperature, torch.ones(1, 2, dtype=torch.bool)), Walls.none(1))
        temperature = exchange(temperature, around, torch.tensor(True), 0.03)
    return float(temperature[0, thing])


def ignites(threshold: float, distance: float) -> float:
    """Whether a thing ignites within 500 updates, 1 or 0."""
    world = one_source([distance])
    state = begin_without_spread(SHIPPED, world)
    state.threshold[:] = threshold
    updates(SHIPPED, state, world, 500)
    return float(state.status != NORMAL)


def ignition_update(case: tuple[float, float]) -> float:
    """Number of updates until a thing of a threshold [C] ignites at a distance [m] from one flame."""
    world = one_source([case[1]])
    state = begin_without_spread(SHIPPED, world)
    state.threshold[:] = case[0]
    for update in range(1, 301):
        updates(SHIPPED, state, world, 1)
        if int(state.status) == BURNING:
            return update
    return NEVER


def burnt_after() -> float:
    """Frames from ignition to burnt."""
    world = room_world([("book", (10.0, 10.0, 0.0))])
    state = begin(PAPER, world)
    state.temperature[:] = 300.0
    updates(PAPER, state, world, 1)
    for frame in range(1, 2000):
        run(PAPER, state, world, 1)
        if int(state.status) == BURNT:
            return frame
    return NEVER


def observed(distance: float) -> float:
    """Temperature [C] that the original's image shows at `distance` [m] from one flame."""
    world = room_world([], [(10.0, 10.0)])
    return float(SHIPPED.image(begin(SHIPPED, world), world, torch.tensor([[[10.0, 10.0 + distance, 0.0]]])))


def overheated(distance: float) -> float:
    """Updates until the agent is above its endurance, `distance` [m] from one flame."""
    world = room_world([], [(10.0, 10.0)], agent=(10.0 + distance, 10.0))
    state = begin_without_spread(SHIPPED, world)
    for update in range(1, 101):
        updates(SHIPPED, state, world, 1)
        if bool(SHIPPED.agent_info(state, world)["agent_overheated"]):
            return update
    return NEVER


@functools.cache
def success_age(birth: int, last: int, start: int) -> tuple[float, float]:
    """Mean and standard deviation of the age [frames] at which flames next succeed in spreading."""
    small = Fire(max_frames=141)
    world = room_world([], [(10.0, 10.0)], copies=CELLS)
    state = begin(small, world)
    state.flame_birth[:, 0], state.flame_last[:, 0] = birth, last
    world.chance.frame[:] = start
    age = torch.full((CELLS,), -1)
    while (age < 0).any():
        world.chance.frame += 10
        small.advance(state, world, 0.01)
        new = (age < 0) & (state.flame_last[:, 0] != last)
        age[new] = world.frame[new] - last
    return float(age.double().mean()), float(age.double().std())


def age_at_success(arguments: tuple[int, int, int], moment: int) -> float:
    """Mean (0) or deviation (1) of `success_age`."""
    return success_age(*arguments)[moment]


def literal_mean() -> float:
    """Updates to the first success with one draw per update."""
    p = spread.probability(5 * torch.arange(1, 51)).double()
    alive = torch.cat([torch.ones(1, dtype=torch.float64), torch.cumprod(1.0 - p, 0)[:-1]])
    return float((p * alive * torch.arange(1, 51)).sum())


@functools.cache
def open_floor(runs: int = 120) -> dict[int, float]:
    """Mean number of burning cells on an open floor, by frame."""
    world = room_world([], [(10.0, 10.0)], copies=runs)
    state = begin(PAPER, world)
    seen = {}
    for _ in range(150):
        world.chance.frame += 10
        PAPER.advance(state, world, 0.01)
        frame = int(world.frame[0])
        seen[frame] = float(((state.flame_cell >= 0) & (state.flame_birth <= frame)).sum(1).double().mean())
    return seen


def burning_cells(frame: int) -> float:
    """Mean number of burning cells at a frame."""
    return open_floor()[frame]


def relaxed(count: int) -> float:
    """Temperature [C] of a thing 1 m from one flame after `count` updates."""
    world = one_source([1.0])
    state = begin_without_spread(PAPER, world)
    updates(PAPER, state, world, count)
    return float(state.temperature)


def pair_mode(case: tuple[float, int]) -> float:
    """Factor per update on the mean (0) or the difference (1) of two things' excess, at a distance [m] (shipped)."""
    apart, moment = case
    world = room_world([("pan", (10.0, 10.0, 0.0)), ("pan", (10.0 + apart, 10.0, 0.0))])
    state = begin(SHIPPED, world)
    state.temperature[0] = torch.tensor([320.0, 120.0])
    updates(SHIPPED, state, world, 1)
    first, second = (float(v) - 20.0 for v in state.temperature[0])
    return (first - second) / 200.0 if moment else (first + second) / 400.0


def _crowd() -> list[tuple[str, tuple[float, float, float]]]:
    """Thirty things of four kinds, close to each other."""
    names = ("book", "pan", "apple", "phone")
    return [(names[k % 4], (9.0 + 0.27 * (k % 6), 9.0 + 0.31 * (k // 6), 0.1 * (k % 3))) for k in range(30)]


def out_of_range() -> float:
    """Temperatures of a crowd near three flames that were ever below the room's or above the flames' in 200 updates."""
    world = room_world(_crowd(), [(9.2, 9.2), (10.1, 9.8), (9.5, 10.4)])
    state, seen = begin_without_spread(SHIPPED, world), 0
    for _ in range(200):
        updates(SHIPPED, state, world, 1)
        seen += int(((state.temperature < 20.0 - 1e-3) | (state.temperature > 600.0 + 1e-3)).sum())
    return float(seen)


def shuffled() -> float:
    """Largest difference [K] between the temperatures of a crowd and of the same crowd in reverse order."""
    made = []
    for order in (1, -1):
        world = room_world(_crowd()[::order], [(9.2, 9.2)])
        state = begin_without_spread(PAPER, world)
        updates(PAPER, state, world, 60)
        made.append(state.temperature[0].flip(0) if order < 0 else state.temperature[0])
    return float((made[0] - made[1]).abs().max())


def after_burning(preset: Fire) -> float:
    """Temperature [C] of a thing ten updates after it is burnt, from `preset`."""
    world = room_world([("book", (10.0, 10.0, 0.0))])
    state = begin(preset, world)
    state.status[:], state.burn_updates[:], state.temperature[:] = BURNING, 299, 600.0
    updates(preset, state, world, 11)
    return float(state.temperature) if int(state.status) == BURNT else NEVER


def broken_rules() -> float:
    """Flames on an open floor that vanished, had no earlier flame beside them, or had more than four successes."""
    world = room_world([], [(10.0, 10.0)], copies=8)
    state, broken = begin(PAPER, world), 0
    before = state.flame_cell.clone()
    for _ in range(150):
        world.chance.frame += 10
        PAPER.advance(state, world, 0.01)
        broken += int(((before >= 0) & (state.flame_cell != before)).sum())
        before = state.flame_cell.clone()
    for cells, births in zip(state.flame_cell.tolist(), state.flame_birth.tolist(), strict=True):
        born = {c: b for c, b in zip(cells, births, strict=True) if c >= 0}
        window = state.free.shape[-1]
        for cell, birth in list(born.items())[1:]:
            beside = (cell - 1, cell + 1, cell - window, cell + window)
            broken += not any(born.get(n, birth) < birth for n in beside)
    return float(broken)
