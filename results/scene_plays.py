"""What abstract agents make of a home: they walk, pick up, put away and take measures in usual times, and know all.

Three agents: nearest first, by value over way; the exact plan of rescues alone; the best plan that fetches
extinguishers and puts out fires, or shuts doors and sets flood boards, before it rescues
(`sketch/planning/beginning.py`). Each has the share of what would be lost that it averts. Nobody explores here, so all
numbers are higher than those of agents in the simulator.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes import solids
from hazard_ms.scenes.walls import WALLS, on_wall, thickness_of
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.planning.averting import kept
from hazard_ms.sketch.planning.beginning import MOST_MEASURES, best_course
from hazard_ms.sketch.planning.measures import Measure, Measures
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.spec import Area, Body, Opening, SceneSpec
from hazard_ms.spec.catalogue import FLOOD_BOARD
from results.scene_futures import BOTH_AT, FIRE, Change

FETCH, PUT_OUT, SHUT = 100.0, 100.0, 200.0  # frames, without ways [ours: of the first tries in the simulator]
SET = 200.0  # frames of a flood board, without ways [of two set in house_flood_test_1/03]
PUT_DOWN = 30.0  # frames in which an extinguisher is put down [ours]
FIRES_EACH = 2  # fires that one extinguisher puts out [ours]
EXTINGUISHER = "fire_extinguisher"
JET = 1.0  # reach of a jet beyond where a walk ends [m] [ours]
BESIDE = 1e-4  # what a rescue counts that averts nothing: it decides among equals only
EFFORT = (400, 40)  # labels and beam of plans with measures
LIMIT = 3000.0


@dataclass(frozen=True)
class Play:
    """Shares of the loss that are averted, 0 to 1, and how much would be lost."""

    risk: float  # share of the targets' value that is lost if nobody acts
    nearest: float
    plain: float  # the exact plan without measures
    best: float  # with measures
    measures: int  # that the best plan takes

    def tells(self, env_id: str) -> bool:
        """Whether the scene tells agents apart, and nobody saturates."""
        return self.margin(env_id) >= 0.0 and self.best - self.plain >= OVER_PLAIN[env_id == FIRE]

    def margin(self, env_id: str) -> float:
        """By how much all criteria are met, but for what measures gain; below 0 if one is not."""
        most = MOST_RISK[env_id == FIRE]
        ahead = self.best - self.nearest - OVER_NEAREST
        return min(self.risk - LEAST_RISK, most - self.risk, ahead, MOST_BEST - self.best)


LEAST_RISK, MOST_RISK = 0.35, (0.9, 0.75)  # most: flood, fire
OVER_PLAIN = (0.08, 0.10)  # least: flood, fire
OVER_NEAREST, MOST_BEST = 0.25, 0.97


def changes(env_id: str, spec: SceneSpec) -> list[Change]:
    """The measures that a scene offers: fires put out, one or two; each group of joined rooms, and each room, shut.

    Two fires together may hold what neither would without the other, since both heat what is between them. In floods
    also boards, in one outer door and in both.
    """
    if env_id == FIRE:
        every = range(len(spec.fires))
        return [Change(fires=f) for f in (*((k,) for k in every), *itertools.combinations(every, 2))]
    doors = {number: _room(spec, o) for number, o in enumerate(spec.room.openings) if _inner(o) and o.share > 0.0}
    groups = [tuple(d for d, room in doors.items() if room in group) for group in joined(spec)]
    shut = [Change(doors=group) for group in dict.fromkeys((*groups, *((d,) for d in doors))) if group]
    inlets = [number for number, o in enumerate(spec.room.openings) if o.kind == "door" and o.wall in WALLS]
    return [*shut, *(Change(blocked=(d,)) for d in inlets), Change(blocked=tuple(inlets), at=BOTH_AT)]


def play(
    env_id: str,
    spec: SceneSpec,
    alone: NDArray[np.float64],
    made: Sequence[tuple[Change, NDArray[np.float64]]],
    quick: bool,
) -> Play:
    """What the agents avert. `alone`: frames at which targets are lost if nobody acts, [T]; `made`: after changes.

    `quick`: if the scene cannot tell agents apart whatever measures do, they are not planned.
    """
    values = np.array([target.value for target in spec.targets], np.float64)
    lost = alone <= LIMIT
    risk = float(values[lost].sum())
    if risk == 0.0:
        return Play(0.0, 1.0, 1.0, 1.0, 0)
    times = skill_times.shipped("fetch")
    pick, bag = (times.typical(skill)[1] for skill in (skill_times.PICK_UP, skill_times.BAG))
    table = _table(spec)
    count, total = len(values), len(values) + 1
    taken = _measures(spec, made, table[total:, total:], pick)
    measures, enter, leave = ([*row] for row in zip(*taken, strict=True))
    enter, leave = np.array(enter) + total, np.array(leave) + total
    problem = Problem(
        StaticTravel(table[:total, :total]),
        values=values,
        damaged_at=np.where(lost, alone - 1.0, np.inf).tolist(),
        pick=[pick] * count,
        drop=[bag] * count,
        limit=LIMIT,
    )
    saved = nearest_first(table[:total, :total], values, np.where(lost, alone, np.inf), pick + bag)
    share, nearest = risk / float(values.sum()), float(values[saved & lost].sum()) / risk
    whole = risk * (1.0 - problem.damaged_share)
    ways = table[:total][:, enter], table[leave][:, enter], table[leave, :count]
    offered = Measures(measures, *ways, put_down=PUT_DOWN)
    plain = (best_course(problem, offered, 0, beside=BESIDE).value - kept(problem)) / whole
    best, steps = plain, 0
    if not quick or Play(share, nearest, plain, MOST_BEST, 0).tells(env_id):  # else measures make no difference
        course = best_course(problem, offered, MOST_MEASURES, *EFFORT, beside=BESIDE)
        best = max(plain, (course.value - kept(problem)) / whole)
        steps = len(course.steps) if best > plain else 0
    return Play(share, nearest, plain, best, steps)


def nearest_first(
    table: NDArray[np.float64], values: NDArray[np.float64], lost: NDArray[np.float64], handling: float
) -> NDArray[np.bool_]:
    """Which targets are rescued whole, [T], by who takes the highest value over way next, as long as there is time."""
    here, frame = len(values), 0.0
    left, saved = np.ones(len(values), bool), np.zeros(len(values), bool)
    while left.any():
        ways = table[here, :-1]
        chosen = int(np.argmax(np.where(left, values / (ways + 1.0), -1.0)))
        left[chosen] = False
        if frame + ways[chosen] + handling > LIMIT:
            continue
        frame, here = frame + ways[chosen] + handling, chosen
        saved[chosen] = frame < lost[chosen]
    return saved


def _measures(
    spec: SceneSpec, made: Sequence[tuple[Change, NDArray[np.float64]]], ways: NDArray[np.float64], pick: float
) -> list[tuple[Measure, int, int]]:
    """The measures, each with the numbers of the places where it begins and ends.

    `ways` from place to place and `pick`, to pick up a board [frames]. Places are extinguishers and boards, then fires,
    then openings, in the order of the scene.
    """
    tools, nothing = _tools(spec), [0.0] * len(spec.targets)
    first_door = len(tools) + len(spec.fires)
    found = [
        (Measure(f"fetch {tool.name}", FETCH, nothing, charge=FIRES_EACH * PUT_OUT), k, k)
        for k, tool in enumerate(tools)
        if tool.category == EXTINGUISHER
    ]
    boards = [k for k, tool in enumerate(tools) if tool.category != EXTINGUISHER]
    for change, lost in made:
        until = np.where(lost <= LIMIT, lost - 1.0, np.inf).tolist()
        for order in itertools.permutations([len(tools) + fire for fire in change.fires]):
            uses = PUT_OUT * len(order)
            frames = uses + sum(float(ways[pair]) for pair in itertools.pairwise(order))
            for tool in range(len(tools) if order else 0):
                found.append((Measure(f"out {order}", frames, until, needs=tool, uses=uses), order[0], order[-1]))
        if change.doors:
            places = [first_door + door for door in change.doors]
            frames = SHUT * len(places) + sum(float(ways[pair]) for pair in itertools.pairwise(places))
            found.append((Measure(f"shut {change.doors}", frames, until), places[0], places[-1]))
        for doors in itertools.permutations(change.blocked):
            places = [first_door + door for door in doors]
            carried = [min(boards, key=lambda board, door=place: float(ways[board, door])) for place in places]
            frames = sum(pick + float(ways[k, place]) + SET for k, place in zip(carried, places, strict=True))
            frames += sum(float(ways[pair]) for pair in zip(places, carried[1:], strict=False))
            if doors:
                found.append((Measure(f"block {doors}", frames, until), carried[0], places[-1]))
    return found


def _tools(spec: SceneSpec) -> list[Body]:
    return [b for b in spec.bodies if b.category == EXTINGUISHER or b.name.startswith(FLOOD_BOARD)]


def _table(spec: SceneSpec) -> NDArray[np.float64]:
    """Frames of walks from each to each: targets, the start, then the places of measures."""
    room = spec.room
    doors = [on_wall(room, o.wall, o.centre, 0.0, thickness_of(room, o.wall) / 2)[:2] for o in room.openings]
    places = [*(tool.position[:2] for tool in _tools(spec)), *spec.fires, *doors]
    at = np.array([*(t.position[:2] for t in spec.targets), spec.agent_start.position, *places])
    sizes = [float(np.hypot(*solids.extent_of(t)[:2])) / 2 for t in spec.targets]
    edge = np.array([*sizes, 0.0, *[0.0] * len(_tools(spec)), *[JET] * len(spec.fires), *[0.0] * len(doors)])
    made = Ways(spec).frames(at[:, None], at[None], edge=np.broadcast_to(edge, (len(at), len(at))))
    np.fill_diagonal(made, 0.0)
    return made


def _inner(o: Opening) -> bool:
    return o.kind == "door" and o.wall not in WALLS


def _room(spec: SceneSpec, o: Opening) -> str:
    """The room, not the hall, that a door or a doorway of the hall leads to."""
    (name,) = set(_sides(spec, o)) - {"hall"}
    return name


def joined(spec: SceneSpec) -> list[set[str]]:
    """Groups of rooms that doorways join, without the hall."""
    groups = [{a.name} for a in spec.room.areas if a.name != "hall"]
    for o in spec.room.openings:
        sides = _sides(spec, o) if o.kind == "doorway" else []
        if len(sides) == 2 and "hall" not in sides:
            both = [g for g in groups if g & set(sides)]
            groups = [g for g in groups if g not in both] + [set().union(*both)]
    return groups


def _sides(spec: SceneSpec, o: Opening) -> list[str]:
    """The areas on both sides of an opening in an inner wall."""
    thick = thickness_of(spec.room, o.wall)
    points = [on_wall(spec.room, o.wall, o.centre, 0.0, deep)[:2] for deep in (-0.1, thick + 0.1)]
    return [a.name for point in points for a in spec.room.areas if _inside(a, point)]


def _inside(area: Area, point: tuple[float, ...]) -> bool:
    return all(low <= p <= high for low, p, high in zip(area.min, point, area.max, strict=True))
