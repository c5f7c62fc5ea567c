"""Rooms for checks of fire: a World without a simulator, things anywhere, any number of copies."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire.fire import Fire, FireState
from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec

ORIGINAL = ("paper", "shipped")  # presets that follow the laws of the original; `realistic` has tests of its own
FAR = (1000.0, 1000.0)  # place of an agent that must not matter: its weight is below 1e-6 [m]


def room_world(
    bodies: Sequence[tuple[str, tuple[float, float, float]]] = (),
    fires: Sequence[tuple[float, float]] = (),
    fixtures: Sequence[tuple[tuple[float, float, float], tuple[float, float, float], float]] = (),
    size: tuple[float, float] = (20.0, 20.0),
    copies: int = 1,
    agent: tuple[float, float] = FAR,
    extent: tuple[float, float, float] = (0.02, 0.02, 0.02),
) -> World:
    """A room with `bodies` (category, base [m]) and tables as `fixtures` (base [m], extent [m], angle about z [rad]).

    With neither of them there is one pan, far away.
    """
    things = list(bodies) if bodies or fixtures else [("pan", (*FAR, 0.0))]
    spec = SceneSpec(
        name="test/fire",
        room=Room(size=size),
        fixtures=tuple(
            Fixture(f"table_{k}", "table", "none", base, about_z(angle)) for k, (base, _, angle) in enumerate(fixtures)
        ),
        bodies=tuple(Body(f"thing_{k}", category, "none", base) for k, (category, base) in enumerate(things)),
        target_categories=("book",),
        fires=tuple(fires),
        agent_start=AgentStart(agent),
    )
    extents = [extent] * len(things) + [e for _, e, _ in fixtures]
    return repeat(World.of((spec,), [extents], [[1.0] * len(extents)]), copies)


def about_z(angle: float) -> tuple[float, float, float, float]:
    """The rotation by `angle` [rad] about the vertical."""
    half = torch.tensor(angle / 2, dtype=torch.float64)
    return (float(half.cos()), 0.0, 0.0, float(half.sin()))


def repeat(world: World, copies: int) -> World:
    """A world of `copies` of the environment of `world`, with the seeds 0, 1, 2 and so on."""
    made = {
        f.name: getattr(world, f.name).repeat_interleave(copies, 0)
        for f in dataclasses.fields(world)
        if isinstance(getattr(world, f.name), torch.Tensor)
    }
    chance = Chance(copies, world.device)
    chance.seed[:] = torch.arange(copies)
    return dataclasses.replace(world, specs=world.specs * copies, names=world.names * copies, chance=chance, **made)


def one_source(distances: Sequence[float], sources: int = 1) -> World:
    """A world with a pan, which ignites at 3000 C, at each of `distances` [m] from `sources` flames in one place.

    Each distance has an environment of its own.
    """
    world = room_world([("pan", (10.0, 10.0, 0.0))], [(10.0, 10.0)] * sources, copies=len(distances))
    world.position[:, 0, 0] += torch.tensor(distances)
    return world


def begin_without_spread(fire: Fire, world: World) -> FireState:
    """The state of `begin`, but the first flames have used up all their directions: they stay alone."""
    state = begin(fire, world)
    state.flame_used[:] = 15
    return state


def updates(fire: Fire, state: FireState, world: World, count: int) -> None:
    """Make `count` heat updates without the frames between them."""
    for _ in range(count):
        world.chance.frame += 5
        fire.advance(state, world, 0.01)


def run(fire: Fire, state: FireState, world: World, frames: int) -> None:
    """Advance the fire by this many frames, one by one."""
    for _ in range(frames):
        world.chance.tick()
        fire.advance(state, world, 0.01)
