"""The measures that there are in a running episode, as who sees everything knows them, and their ways."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.agents.mitigating import costs
from hazard_ms.env import HazardEnv
from hazard_ms.hazards.fire.fire_state import BURNING, FireState
from hazard_ms.scenes.walls import WALLS
from hazard_ms.simulation.jet import KINDS
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import OUT, SHUT, fire_of
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.extinguishers import EXTINGUISHERS

Array = NDArray[np.float64]
FETCH = "fetch"
THREAT = 3.0  # distance from a target that would be lost within which a fire is fought [m] [ours]
MOST_FUTURES = 11  # beside that in which nobody acts [ours]
SPRAY_FROM = 1.0  # from flames to where they are fought [m] [ours]
ANY_WAY = 1e6  # longer than any way [m]


class Seat(NamedTuple):
    """A seat of fire as it is now."""

    number: int
    place: Array  # the middle of what burns [m], [2]
    burning: int  # number of flames and things


class Prospect(NamedTuple):
    """Something that can be done: a tool fetched, seats of fire put out, a door shut."""

    kind: str  # FETCH, OUT or SHUT
    numbers: tuple[int, ...]  # of the thing along B, of the seats in their order, or of the opening along O
    first: Array  # place at which it begins [m], [2]
    last: Array  # place at which it ends [m], [2]
    edge: float  # distance from these at which it is done, beyond that of walks [m]
    frames: float  # that it takes there
    jet: float = 0.0  # frames of discharge among these
    charge: float = 0.0  # frames that a tool lasts


def seats_of(base: HazardEnv) -> list[Seat]:
    """The seats of fire that burn now."""
    fire = fire_of(base.episode)
    if fire is None:
        return []
    floor, goods, places = _burning(fire, base)
    every = np.concatenate([floor, goods])
    return [
        Seat(int(n), places[every == n].mean(0), int((every == n).sum())) for n in np.unique(every[every >= 0]).tolist()
    ]


def _burning(fire: FireState, base: HazardEnv) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """The seats of all flames, [F], and things, [B], -1 for none, and the places of both [m], [F + B, 2]."""
    world = base.world
    floor = seats.flames(fire, world.frame)[0]
    goods = torch.where(fire.status == BURNING, seats.things(fire, world), -1)[0]
    places = torch.cat([fire.flame_place[0, :, :2], world.position[0, :, :2]])
    return floor.cpu().numpy(), goods.cpu().numpy(), places.cpu().numpy().astype(np.float64)


def charge_of(base: HazardEnv, index: int) -> float:
    """Frames that the extinguisher `index` along B still lasts; 0 for other things."""
    tools = base.world.equipment
    number = -1 if tools is None else int(tools.kinds[0, index])
    if tools is None or number < 0:
        return 0.0
    left = float(tools.state.charge[0, index]) / EXTINGUISHERS[KINDS[number]].rate
    return left / float(base.control_timestep)


def tools_of(base: HazardEnv, scene: RescueScene) -> list[Prospect]:
    """The extinguishers that still hold something: to fetch them."""
    made, equipment = [], base.world.equipment
    rows = [] if equipment is None else equipment.tool[0].nonzero()[:, 0].tolist()
    for b in rows:
        charge = charge_of(base, b)
        if charge > 0.0:
            at = base.world.position[0, b, :2].cpu().numpy().astype(np.float64)
            made.append(Prospect(FETCH, (b,), at, at, float(scene.edges[b]), scene.pick, charge=charge))
    return made


def fights(base: HazardEnv, lost: Array, here: Array) -> list[Prospect]:
    """Seats, pairs of them and all of them put out that threaten things at `lost` [m], [L, 2], nearest first."""
    near = [seat for seat in seats_of(base) if _gap(seat.place, lost) <= THREAT]
    near.sort(key=lambda seat: float(np.hypot(*(seat.place - here))))
    sets: list[Sequence[Seat]] = [[seat] for seat in near]
    sets += [near] if len(near) > 2 else []
    sets += list(itertools.combinations(near, 2))
    return [_fight(group) for group in sets]


def _fight(group: Sequence[Seat]) -> Prospect:
    jet = sum(costs.FLAME * seat.burning for seat in group)
    numbers = tuple(seat.number for seat in group)
    return Prospect(OUT, numbers, group[0].place, group[-1].place, SPRAY_FROM, costs.FIGHT * len(group) + jet, jet)


def doors(base: HazardEnv, lost: Array) -> list[Prospect]:
    """The open doors in inner walls: to shut them, those nearest to what would be `lost` [m], [L, 2], first."""
    made, openings, spec = [], base.world.openings, base.specs[0]
    for number, o in enumerate(spec.room.openings):
        leaf = o.kind == "door" and o.wall not in WALLS and not bool(openings.state.broken[0, number])
        if leaf and float(openings.share[0, number]) > 0.0:
            at = openings.plan.beside[0, number, :, :2].mean(0).cpu().numpy().astype(np.float64)
            made.append(Prospect(SHUT, (number,), at, at, 0.0, costs.DOOR))
    return sorted(made, key=lambda door: _gap(door.first, lost))


def _gap(place: Array, others: Array) -> float:
    return float(np.hypot(*(others - place).T).min(initial=np.inf))


def as_now(spec: SceneSpec, shares: Iterable[float], here: tuple[float, float]) -> SceneSpec:
    """The scene with its doors as far open as `shares` say, [O], and the robot `here` [m]."""
    rows = zip(spec.room.openings, shares, strict=True)
    made = [dataclasses.replace(o, open=share) if o.kind == "door" else o for o, share in rows]
    room = dataclasses.replace(spec.room, openings=tuple(made))
    return dataclasses.replace(spec, room=room, agent_start=dataclasses.replace(spec.agent_start, position=here))


def closes(spec: SceneSpec, door: int, radius: float, here: tuple[float, float], goals: Array, edges: Array) -> Array:
    """Which `goals` [m], [G, 2], nobody gets to from `here` [m] once a door of `spec` is shut: numbers.

    Limit: what lies within reach of a walk behind a thin wall counts as reached.
    """
    shares = [0.0 if number == door else o.share for number, o in enumerate(spec.room.openings)]
    ways = Ways(as_now(spec, shares, here), radius=radius)
    frames = ways.frames(np.array([here]), goals, edge=edges)
    return np.flatnonzero(~np.isfinite(frames))


def ways_between(
    scene: RescueScene, here: Array, goals: Array, edges: Array, made: Sequence[Prospect]
) -> dict[str, Array]:
    """The ways to and from what can be done, by the names that `Measures` has for them; `goals` [m], [G, 2]."""
    ways, own = scene.ways, np.array([p.edge for p in made])
    first, last = np.stack([p.first for p in made]), np.stack([p.last for p in made])
    stands = np.vstack([ways.along(here[None], goals, ANY_WAY, edges), here[None]])
    after = ways.along(here[None], last, ANY_WAY, own)
    return {
        "to": ways.frames(stands[:, None], first[None], edge=own),
        "between": ways.frames(after[:, None], first[None], edge=own),
        "onward": ways.frames(after[:, None], goals[None], edge=edges),
    }
