"""Measures what the laws of hazards cost, in milliseconds of one thread, and how that grows with the environments.

The sizes are those of docs/physics.md 4: 1,024 environments of 64 bodies.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import torch

from hazard_ms.hazards import presets
from hazard_ms.hazards.base import begin
from hazard_ms.hazards.flood.buoyancy import BALL
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.hazards.presets import PRESETS
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition, Room, SceneSpec
from hazard_ms.validation.experiments import probes

ENVIRONMENTS, BODIES = 1024, 64
FEWER = 16  # times fewer environments, to compare with [ours]
WATER = 0.4  # depth in the room of `realistic` [m] [ours]
REPEATS = 10  # calls, of which the fastest counts
STEP = 0.01  # [s]

Kernel = Callable[[], object]


def law_kernels(environments: int, bodies: int) -> dict[str, Kernel]:
    """Single laws, on bodies of all shapes in all attitudes near the surface."""
    count = environments * bodies
    chance = torch.Generator().manual_seed(0)

    def random(*more: int) -> torch.Tensor:
        return torch.rand(count, *more, generator=chance)

    rotation = torch.nn.functional.normalize(random(4) - 0.5, dim=-1)
    extent, velocity, mass = 0.1 + 0.2 * random(3), random(3) - 0.5, 0.1 + random()
    kind, height, slope = (3 * random()).long(), 0.2 * (random() - 0.5), 0.05 * random(2)
    return {
        "flood: 3x3 columns": lambda: probes.immersion(height, slope, rotation, extent, kind),
        "flood, wind: drag per face": lambda: probes.drag(velocity, rotation, extent, mass, kind == BALL, STEP),
        "flood, wind: drag of turning": lambda: probes.spin_drag(velocity, rotation, extent, mass, 1000.0, STEP),
    }


def flood_kernels(environments: int, bodies: int) -> dict[str, Kernel]:
    """A whole step of each preset, and a frame, on bodies in all attitudes at the surface of a room of two parts."""
    room = Room(
        (8.0, 8.0), partitions=(Partition("wall", "x", 4.0),), openings=(Opening("doorway", "wall", 4.0, 1.0, 2.0),)
    )
    world = _room_of_boxes(room, (), environments, bodies)
    chance = torch.Generator().manual_seed(0)
    world.rotation[:] = torch.nn.functional.normalize(torch.rand(world.rotation.shape, generator=chance) - 0.5, dim=-1)
    world.velocity[:] = torch.rand(world.velocity.shape, generator=chance) - 0.5
    made: dict[str, Kernel] = {}
    for name in PRESETS:
        hazard = presets.flood(name)
        state = begin(hazard, world)
        state.time[:] = 20.0
        if isinstance(state, InundationState):
            state.depth[state.bed < WATER] = WATER
        hazard.advance(state, world, STEP)
        made[f"flood: force, {name}"] = partial(hazard.force, state, world, STEP)
        made[f"flood: a frame, {name}"] = partial(hazard.advance, state, world, STEP)
    return made


def fire_kernels(environments: int, bodies: int) -> dict[str, Kernel]:
    """An update of each preset, which is due every few frames, on bodies in a room in whose middle a fire burns."""
    world = _room_of_boxes(Room((8.0, 8.0)), ((4.0, 4.0),), environments, bodies)
    made: dict[str, Kernel] = {}
    for name in PRESETS:
        hazard = presets.fire(name)
        state = begin(hazard, world)
        made[f"fire: an update, {name}"] = partial(hazard.advance, state, world, 1 / 30)
    return made


def _room_of_boxes(room: Room, fires: tuple[tuple[float, float], ...], environments: int, bodies: int) -> World:
    """Copies of a room with boxes in a row and fires at places [m], 600 frames after the start of an episode."""
    things = tuple(Body(f"box_{k}", "box", "", (0.1 * k, 1.0 + 0.1 * k, 0.0)) for k in range(bodies))
    spec = SceneSpec("bench/room", room, (), things, ("box",), fires, AgentStart((1.0, 1.0)))
    world = World.of(
        (spec,) * environments, [[(0.3, 0.2, 0.25)] * bodies] * environments, [[1.0] * bodies] * environments
    )
    world.chance.frame[:] = 600
    return world


def wind_kernels(environments: int, bodies: int) -> dict[str, Kernel]:
    """A whole step of each preset, and a frame, on bodies in all attitudes in a street with three carts and a hedge."""
    carts = tuple(Fixture(f"cart_{k}", "cart", "", (4.0 * k + 2.0, 8.0, 0.0)) for k in range(3))
    hedge = Fixture("hedge_1", "hedge", "", (8.0, 4.0, 0.0))
    moving = tuple(Body(f"bag_{k}", "bag", "", (0.3 * k, 6.0, 0.0)) for k in range(max(1, bodies - 4)))
    street = Room((16.0, 16.0), open_air=True, beyond=4.0)
    spec = SceneSpec(
        "bench/street", street, (*carts, hedge), moving, ("bag",), (), AgentStart((1.0, 1.0)), wind=(3.0, 2.0)
    )
    extents = [(0.3, 0.2, 0.25)] * len(moving) + [(0.54, 0.94, 1.03)] * 3 + [(5.0, 0.6, 1.4)]
    world = World.of((spec,) * environments, [extents] * environments, [[1.0] * len(extents)] * environments)
    chance = torch.Generator().manual_seed(0)
    world.rotation[:] = torch.nn.functional.normalize(torch.rand(world.rotation.shape, generator=chance) - 0.5, dim=-1)
    world.velocity[:] = torch.rand(world.velocity.shape, generator=chance) - 0.5
    made: dict[str, Kernel] = {}
    for name in PRESETS:
        hazard = presets.wind(name)
        state = begin(hazard, world)
        world.chance.tick()
        hazard.advance(state, world, STEP)
        made[f"wind: force, {name}"] = partial(hazard.force, state, world, STEP)
        made[f"wind: a frame, {name}"] = partial(hazard.advance, state, world, STEP)
    return made


KERNELS: tuple[Callable[[int, int], dict[str, Kernel]], ...] = (law_kernels, flood_kernels, fire_kernels, wind_kernels)


def milliseconds(kernel: Kernel, repeats: int = REPEATS) -> float:
    """The least time of one call in this thread, after a first one [ms].

    Other work on the machine is left out as far as possible.
    """
    kernel()
    spans = []
    for _ in range(repeats):
        start = time.thread_time()
        kernel()
        spans.append(time.thread_time() - start)
    return 1e3 * min(spans)


def report(environments: int = ENVIRONMENTS, bodies: int = BODIES, repeats: int = REPEATS) -> str:
    """A table of all laws, one thread each, beside a sixteenth of the environments.

    Raises ValueError for numbers that are not positive.
    """
    for name, value in (("environments", environments), ("bodies", bodies), ("repeats", repeats)):
        if not value > 0:
            raise ValueError(f"{name} must be positive, got {value}")
    few, threads = max(1, environments // FEWER), torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        rows = [_row(make, few, environments, bodies, repeats) for make in KERNELS]
    finally:
        torch.set_num_threads(threads)
    head = f"{environments} environments of {bodies} bodies, beside {few}, one thread, best of {repeats} calls"
    return "\n".join([head, *(line for row in rows for line in row)])


def _row(make: Callable[[int, int], dict[str, Kernel]], few: int, many: int, bodies: int, repeats: int) -> list[str]:
    """A line for each of the kernels that `make` makes: `many` environments, and each of them over each of `few`."""
    less = {name: milliseconds(kernel, repeats) for name, kernel in make(few, bodies).items()}
    more = {name: milliseconds(kernel, repeats) for name, kernel in make(many, bodies).items()}
    return [f"  {name:30s} {ms:8.2f} ms, each {ms / many / (less[name] / few):.2f} times" for name, ms in more.items()]
