"""The measures that there are in a running episode, as who sees everything knows them, and their ways."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.mitigating import costs
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import BLOCK, OUT, SHUT, fire_of
from hazard_ms.sketch.futures.surroundings import Home, charge_of, free_boards, hidden, inlets_of, inner_doors
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.skills.mitigations.views import facing
from hazard_ms.spec import SceneSpec

Array = NDArray[np.float64]
Part = tuple[str, int]  # of a prospect: its kind, and one of its numbers
FETCH = "fetch"
THREAT = 3.0  # distance from a target that would be lost within which a fire is fought [m] [ours]
MOST_FUTURES = 11  # beside that in which nobody acts [ours]
JET = 3.0  # from flames to where they are fought [m] [ours: a view of them from farther away may need another step]
EYES, LOW = 0.8, 0.1  # heights of the nozzle and of flames on the floor [m] [ours]
ASIDE = 0.25  # to both sides of a place, from where flames must be in view, too: the hand is off the middle [m] [ours]
ANY_WAY = 1e6  # longer than any way [m]


class Seat(NamedTuple):
    """A seat of fire as it is now."""

    number: int
    place: Array  # the middle of what burns [m], [2]
    burning: int  # number of flames and things


class Prospect(NamedTuple):
    """Something that can be done: a tool fetched, seats of fire put out, a door shut, flood boards fetched and set."""

    kind: str  # FETCH, OUT, SHUT or BLOCK
    numbers: tuple[int, ...]  # of the thing along B, of the seats in their order, or of the openings along O
    first: Array  # place at which it begins [m], [2]
    last: Array  # place at which it ends [m], [2]
    edge: float  # distance from these at which it is done, beyond that of walks [m]
    frames: float  # that it takes there
    jet: float = 0.0  # frames of discharge among these
    charge: float = 0.0  # frames that a tool lasts
    between: float = 0.0  # frames of ways from seat to seat among these

    @property
    def parts(self) -> frozenset[Part]:
        """All of it that only one robot at a time should be at."""
        return frozenset((self.kind, number) for number in self.numbers)


def seats_of(base: Home) -> list[Seat]:
    """The seats of fire that burn now."""
    fire = fire_of(base.episode)
    if fire is None:
        return []
    world = base.world
    every = np.concatenate([seats.flames(fire, world.frame)[0].cpu(), seats.alight(fire, world)[0].cpu()])
    places = np.concatenate([fire.flame_place[0, :, :2].cpu(), world.position[0, :, :2].cpu()]).astype(np.float64)
    return [
        Seat(int(n), places[every == n].mean(0), int((every == n).sum())) for n in np.unique(every[every >= 0]).tolist()
    ]


def tools_of(base: Home, scene: RescueScene) -> list[Prospect]:
    """The extinguishers that still hold something: to fetch them."""
    made, equipment = list[Prospect](), base.world.equipment
    if equipment is None:
        return made
    for b in equipment.tool[0].nonzero()[:, 0].tolist():
        charge = charge_of(base, b)
        if charge > 0.0:
            at = base.world.position[0, b, :2].cpu().numpy().astype(np.float64)
            pin = costs.PIN if equipment.state.charge[0, b] >= equipment.full[0, b] else 0.0
            made.append(Prospect(FETCH, (b,), at, at, float(scene.edges[b]), scene.pick + pin, charge=charge))
    return made


def fights(base: Home, scene: RescueScene, lost: Array, start: Array) -> list[Prospect]:
    """Seats, pairs of them and all of them put out that threaten things at `lost` [m], [L, 2].

    Ways lead from `start` [m], [2], to where each seat is in view: those of one fight one after another, the nearest
    next.
    """
    near = [seat for seat in seats_of(base) if _gap(seat.place, lost) <= THREAT]
    stands = {seat.number: stand for seat in near if (stand := view_of(base, scene.ways, seat, start)) is not None}
    near = [seat for seat in near if seat.number in stands]
    sets: list[Sequence[Seat]] = [[seat] for seat in near]
    sets += [near] if len(near) > 2 else []
    sets += list(itertools.combinations(near, 2))
    return [fight(group, stands, scene.ways, start) for group in sets]


def view_of(base: Home, ways: Ways, seat: Seat, start: Array) -> Array | None:
    """The place [m], [2], with the shortest way from `start` [m] from which the jet gets to a seat; None for none."""
    places = ways.places[np.hypot(*(ways.places - seat.place).T) <= JET]
    aim = np.array([*seat.place, LOW])
    for side in (-ASIDE, ASIDE):
        places = places[~hidden(base.world, facing(places, aim, np.array([0.0, side, EYES])), aim)]
    return np.asarray(places[int(np.argmin(ways.frames(places, start)))]) if len(places) else None


def fight(group: Sequence[Seat], stands: Mapping[int, Array], ways: Ways, start: Array) -> Prospect:
    """The seats of a `group` put out, the nearest next, from their `stands` [m], [2] each; it begins at `start` [m]."""
    left, order, walked = {seat.number: stands[seat.number] for seat in group}, list[int](), list[float]()
    here = start
    while left:
        away = ways.frames(here, np.stack(list(left.values())))
        best = int(np.argmin(away))
        order.append(list(left)[best])
        walked.append(float(away[best]))
        here = left.pop(order[-1])
    jet, between = sum(costs.FLAME * seat.burning for seat in group), sum(walked[1:])
    frames = costs.FIGHT * len(group) + jet + between
    return Prospect(OUT, tuple(order), stands[order[0]], here, 0.0, frames, jet, between=between)


def doors(base: Home, lost: Array) -> list[Prospect]:
    """The open doors in inner walls: to shut them, those nearest to what would be `lost` [m], [L, 2], first."""
    share = base.world.openings.share[0]
    made = [
        Prospect(SHUT, (number,), at, at, 0.0, costs.DOOR)
        for number, at in inner_doors(base.world).items()
        if float(share[number]) > 0.0
    ]
    return sorted(made, key=lambda door: _gap(door.first, lost))


def blocks(base: Home, scene: RescueScene, start: Array, others: Collection[Part] = ()) -> list[Prospect]:
    """The openings that water comes in through, alone and all together: boards set into them, from `start` [m], [2].

    Each has the board that is nearest to it and in no other; those together are set one after another, nearest next.
    Boards that `others` are at are left out.
    """
    inlets = inlets_of(base.world)
    boards = [board for board in free_boards(base.world) if (FETCH, board) not in others]
    places = base.world.position[0, :, :2].cpu().numpy().astype(np.float64)
    singly = [one for number in inlets if (one := _set_into({number: inlets[number]}, boards, places, scene, start))]
    both = _set_into(inlets, boards, places, scene, start) if len(inlets) > 1 else None
    return [*([both] if both else []), *singly]


def _set_into(
    inlets: Mapping[int, Array], boards: Sequence[int], places: Array, scene: RescueScene, start: Array
) -> Prospect | None:
    """The prospect of boards set into all `inlets`; None where there are too few boards, or no way leads there."""
    left, free, here, frames, order = dict(inlets), [*boards], start, 0.0, list[int]()
    first = start
    while left:
        fetched = [(float(scene.ways.frames(places[b], at)), b, n) for n, at in left.items() for b in free]
        if not fetched:
            return None
        nearest = min(left, key=lambda n: float(scene.ways.frames(here, left[n])))
        carried, board, number = min(one for one in fetched if one[2] == nearest)
        if not order:
            first = places[board]
        else:
            frames += float(scene.ways.frames(here, places[board]))
        frames += scene.pick + carried + costs.BOARD
        free.remove(board)
        here = left.pop(number)
        order.append(number)
    return Prospect(BLOCK, tuple(order), first, here, 0.0, frames) if np.isfinite(frames) else None


def _gap(place: Array, others: Array) -> float:
    return float(np.hypot(*(others - place).T).min(initial=np.inf))


def as_now(spec: SceneSpec, shares: Iterable[float], here: tuple[float, float]) -> SceneSpec:
    """The scene with its doors as far open as `shares` say, [O], and the robot `here` [m]."""
    rows = zip(spec.room.openings, shares, strict=True)
    made = [dataclasses.replace(o, open=share) if o.kind == "door" else o for o, share in rows]
    room = dataclasses.replace(spec.room, openings=tuple(made))
    return dataclasses.replace(spec, room=room, agent_start=dataclasses.replace(spec.agent_start, position=here))


def closes(
    spec: SceneSpec, door: int, radius: float, here: tuple[float, float], goals: Array, edges: Array
) -> list[int]:
    """The numbers of the `goals` [m], [G, 2], that nobody gets to from `here` [m] once a door of `spec` is shut.

    Limit: what lies within reach of a walk behind a thin wall counts as reached.
    """
    shares = [0.0 if number == door else o.share for number, o in enumerate(spec.room.openings)]
    ways = Ways(as_now(spec, shares, here), radius=radius)
    frames = ways.frames(np.array([here]), goals, edge=edges)
    return [int(n) for n in np.flatnonzero(~np.isfinite(frames))]


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
