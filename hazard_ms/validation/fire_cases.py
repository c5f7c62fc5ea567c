"""Fire of the original's laws: cases F of physics.md 2.1, in tensors; the presets `paper` and `shipped`."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from functools import partial

import torch

from hazard_ms.hazards import spread
from hazard_ms.hazards.fire import BURNING, BURNT, NORMAL, Fire
from hazard_ms.hazards.heat import Mean, Sources, exchange
from hazard_ms.hazards.presets import fire
from hazard_ms.validation.cases import Case, table
from hazard_ms.validation.fire_room import ORIGINAL, begin, begin_without_spread, one_source, room_world, run, updates

PAPER, SHIPPED = (preset for preset in map(fire, ORIGINAL) if isinstance(preset, Fire))
F1 = {0.05: 577.6923, 0.1: 577.6923, 0.22: 505.925, 0.25: 484.0, 0.3: 446.471, 0.5: 310.0}
F1 |= {0.75: 198.462, 1.0: 136.0, 1.5: 78.0, 2.0: 54.1176, 3.0: 35.676}
F4 = {1: 194.6, 10: 152.7363, 50: 59.2518, 100: 28.5595}
F12 = {60: 1.8371, 100: 1.25, 200: 0.7454, 300: 0.5175, 400: 0.3627, 500: 0.2282, 560: 0.1361}
NEVER = math.inf
F13 = {  # threshold, distance: updates
    **{(60, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (3, 3, 4, 5, 8), strict=True)},
    **{(100, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (6, 6, 7, 11, 18), strict=True)},
    **{(200, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (13, 16, 19, 32, 83), strict=True)},
    **{(300, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (23, 29, 36, 111, NEVER), strict=True)},
    **{(400, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (38, 51, 73, NEVER, NEVER), strict=True)},
    **{(500, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (65, 145, NEVER, NEVER, NEVER), strict=True)},
}
F17 = {0.1: 591.589, 0.5: 444.014, 1.0: 254.674, 2.0: 104.228, 4.0: 43.631}
F18 = {0.5: 5, 1.0: 14, 1.5: 39, 2.0: NEVER}
CELLS = 10_000  # flames of which the ages at success are counted


def equilibrium(preset: Fire, distance: float) -> float:
    """Temperature [C] of a thing `distance` [m] from one flame, in the end."""
    world = one_source([distance])
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 350)
    return float(state.temperature)


@functools.cache
def cooling() -> dict[int, float]:
    """Temperature [C] of a thing of 200 C in an empty room after so many updates."""
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
    """As `pair`, 0.5 m apart, without a room, after 200 updates."""
    points, temperature = torch.tensor([[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]]), torch.tensor([[300.0, 20.0]])
    mean = Mean(20.0, 0.0, 0.5, 0.1)
    for _ in range(200):
        around = mean.at(points, Sources(points, temperature, torch.ones(1, 2, dtype=torch.bool)), apart=True)
        temperature = exchange(temperature, around, torch.tensor(True), 0.03)
    return float(temperature[0, thing])


def ignites(threshold: float, distance: float) -> float:
    """1 if a thing ignites within 500 updates, else 0."""
    world = one_source([distance])
    state = begin_without_spread(SHIPPED, world)
    state.threshold[:] = threshold
    updates(SHIPPED, state, world, 500)
    return float(state.status != NORMAL)


def ignition_update(case: tuple[float, float]) -> float:
    """At which update a thing of a threshold [C] ignites at a distance [m] from one flame."""
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


F26 = {200: (1.77, 0.49), 500: (4.62, 1.13), 1000: (18.39, 2.93), 1500: (41.47, 5.28)}
SPREADS = {"F-20": ((0, 0, 100), 183.761, 18.546), "F-21": ((1, 1, 100), 187.804, 18.326), "F-22": ((0, 200, 200), 156.832, 54.783)}


def cases() -> Iterator[Case]:
    """All of them."""
    yield from table("F-1", "equilibrium at {} m from a flame (shipped)", F1, 1e-4, lambda d: equilibrium(SHIPPED, d), unit="C")
    near = {0.05: 310.0, 0.3: 310.0, 0.5: 310.0, 1.0: 136.0}
    yield from table("F-2", "equilibrium at {} m from a flame (paper)", near, 1e-4, lambda d: equilibrium(PAPER, d), unit="C")
    yield from table("F-4", "cooling from 200 C, after {} updates", F4, 1e-4, lambda n: cooling()[n], unit="C")
    yield from table("F-5", "two things 0.5 m apart, thing {}", {0: 99.7621, 1: 71.7512}, 1e-4, lambda k: pair(0.5, k), unit="C")
    yield from table("F-6", "two things 0.1 m apart, thing {}", {0: 158.895, 1: 145.399}, 1e-4, lambda k: pair(0.1, k), unit="C")
    yield from table("F-8", "two things without a room, thing {}", {0: 160.00059, 1: 159.99941}, 1e-6, isolated, unit="C")
    inside, outside = {t: 1.0 for t in F12}, {t: 0.0 for t in F12}
    yield from table("F-12", "threshold {} C ignites 1 % inside its distance", inside, 0, lambda t: ignites(t, 0.99 * F12[t]))
    yield from table("F-12", "threshold {} C does not 1 % outside", outside, 0, lambda t: ignites(t, 1.01 * F12[t]))
    yield from table("F-13", "updates to ignition, (threshold C, distance m) {}", F13, 0, ignition_update)
    yield Case("F-14", "a threshold of 600 C at 0.05 m never ignites", 0.0, 0, lambda: ignites(600.0, 0.05))
    yield Case("F-16", "frames from ignition to burnt", 1500, 0, burnt_after)
    yield from table("F-17", "observed temperature at {} m from a flame", F17, 1e-4, observed, unit="C")
    yield from table("F-18", "updates until the agent at {} m is overheated", F18, 0, overheated)
    for name, (arguments, mean, sd) in SPREADS.items():
        width = 4 * sd / math.sqrt(CELLS)
        yield Case(name, "mean age at success", mean, width, partial(age_at_success, arguments, 0), "frames", absolute=True, slow=True)
        yield Case(name, "its deviation", sd, 0.04, partial(age_at_success, arguments, 1), "frames", slow=True)
    yield Case("F-23", "updates to success, one draw per update", 25.459, 1e-3, literal_mean, absolute=True)
    for frame, (mean, sd) in F26.items():
        width = 4 * sd * math.sqrt(1 / 400 + 1 / 120) + 0.005
        yield Case("F-26", f"burning cells after {frame} frames", mean, width, partial(burning_cells, frame), absolute=True, slow=True)
