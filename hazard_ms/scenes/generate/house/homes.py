"""Whole scenes of homes: plans, objects, targets and their values, tools, hazards and the rescuer's start.

The scenes of the split `held_out` are drawn from a hash of their names (`seed_of`), so that no change to the names or
the number of the others can bring one of them into another split; `tests/scenes/test_houses.py` pins what they are.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.check import in_leaves
from hazard_ms.scenes.floor import doorways, free_for, take
from hazard_ms.scenes.generate.arrangement import MIN_GAP, RESTING_HEIGHT, NoPlaceError, models_of
from hazard_ms.scenes.generate.draw import STREAM, Draw
from hazard_ms.scenes.generate.hazard_placement import (
    FLAME_RADIUS,
    MIN_DOORWAY_DISTANCE,
    START_RADIUS,
    start,
)
from hazard_ms.scenes.generate.house.chosen import CHOSEN
from hazard_ms.scenes.generate.house.outbreaks import outbreaks, within
from hazard_ms.scenes.generate.house.plan import House, Plan, build
from hazard_ms.scenes.generate.room_things import TEST_THINGS, TRAIN_THINGS
from hazard_ms.scenes.generate.scatter import TRIES, Scatter, fill
from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import Area, Body, Opening, Room, SceneSpec, Vec2
from hazard_ms.spec.catalogue import CATEGORIES, FIRE_POOL, FLOOD_BOARD, LEAST_VALUE, MOST_VALUE

HELD_OUT = "held_out"
ATTEMPTS = 200  # at one scene [ours]: one in 3 to 10 fits, and takes 0.1 s
NEAR_FRONT_DOOR = 2.5  # from the front door: the rescuer starts, and an extinguisher stands, within it [m] [ours]
FROM_CORNER = 0.3  # of a place along a wall for a tool [m] [ours]
EXTINGUISHER = "fire_extinguisher"  # a tool: it is in no pool of targets
SIZE, MASS = 0.75, 3.3  # of one with 2 kg of powder: 0.41 m high; its mass when full [kg] [data sheets: 3.2 to 3.5]
EXTINGUISHERS = ("hall", "kitchen_1")  # the areas in which one stands each [ours]: by the exit, and where fires begin
# A flood board: 0.05 m longer than an outer door is wide, on both sides, and light enough for an arm [ours]
BOARD_SIZE, BOARD_MASS = (1.05, 0.04, 0.6), 5.0  # [m], [kg]
BESIDE_DOOR = 1.0  # from the middle of the front door: a flood board stands farther away [m] [ours]
FLOODED = "house_flood"  # how the names of places begin whose scenes are for floods

WIDE, MIDDLE, NARROW = (3.8, 4.8), (3.6, 4.0), (2.6, 2.7)  # of columns [m]
PLANS = (
    Plan((WIDE, WIDE), ("kitchen", "living_room"), ("bedroom", "study")),
    Plan((WIDE, WIDE), ("living_room", "bedroom"), ("kitchen", "bedroom"), (("north", 0),)),
    Plan((MIDDLE, NARROW, MIDDLE), ("kitchen", "store", "living_room"), ("bedroom", "bathroom", "study")),
    Plan((MIDDLE, MIDDLE, NARROW), ("living_room", "kitchen", "store"), ("bedroom", "bedroom", "bathroom")),
    Plan((WIDE, WIDE), ("living_room", "kitchen"), ("bedroom", "bedroom"), (("south", 0),)),
    Plan(
        (NARROW, MIDDLE, MIDDLE),
        ("bathroom", "kitchen", "living_room"),
        ("store", "study", "bedroom"),
        (("south", 1),),
    ),
    Plan((MIDDLE, NARROW, WIDE), ("study", "bathroom", "living_room"), ("bedroom", "store", "kitchen")),
    Plan(
        (NARROW, (3.6, 3.7), NARROW, (3.6, 3.7)),
        ("bathroom", "kitchen", "store", "living_room"),
        ("store", "bedroom", "bathroom", "bedroom"),
    ),
)


def make(place: str, name: str, split: str) -> SceneSpec:
    """The scene `name` of the `place` in a `split`; the plans take turns. Raises ValueError if nothing fits."""
    return candidate(layout_of(place, split), name, split, CHOSEN.get(name, 0))


def candidate(layout: House, name: str, split: str, number: int) -> SceneSpec:
    """The scene of this `number` of those that may be the scene `name`. Raises ValueError if nothing fits."""
    seed = seed_of(name, split, number)
    for attempt in range(ATTEMPTS):
        try:
            return _attempt(layout, name, split, seed, attempt)
        except NoPlaceError as problem:
            last = problem
    raise ValueError(f"{name} must fit into its rooms, got no arrangement in {ATTEMPTS} attempts; the last: {last}")


def seed_of(name: str, split: str, number: int = 0) -> str:
    """The text from which all randomness of a candidate for the scene `name` derives.

    It is a hash for those that are held out.
    """
    text = f"{name} candidate {number}" if number else name
    return hashlib.sha256(f"hazard_ms held out {text}".encode()).hexdigest() if split == HELD_OUT else text


def layout_of(place: str, split: str) -> House:
    """The kind of home of a `place`."""
    things = TRAIN_THINGS if split == "train" else TEST_THINGS
    return House(
        name=place,
        parts=(),
        depth=(3.4, 3.6),
        floors=("wood", "light_wood", "parquet"),
        walls=("plaster", "paint_white", "paint_green", "paint_blue"),
        pool=FIRE_POOL,
        things=tuple(t for t in things if t != EXTINGUISHER),
        targets=(16, 20),
        burning_kinds=3,
        bodies=120 - len(EXTINGUISHERS) - 2 * place.startswith(FLOODED),
        fires=(4,),
        inflows=2,
        plans=PLANS,
        boards=place.startswith(FLOODED),
    )


def _attempt(layout: House, name: str, split: str, seed: str, attempt: int) -> SceneSpec:
    draw = Draw(STREAM, seed, attempt)
    plan = layout.plans[int(name.rpartition("/")[2]) % len(layout.plans)]
    made = build(layout, plan, draw)
    scatter = Scatter(made, layout, anywhere=False)
    areas = {area.name: area for area in made.room.areas}
    entrance = _entrance(made.room, areas["hall"])
    for where in EXTINGUISHERS:
        _stand_extinguisher(scatter, entrance if where == "hall" else areas[where], where == "hall", draw)
    for _ in outer_doors(made.room) if layout.boards else ():
        _stand_board(scatter, areas["hall"], _front_door(made.room), draw)
    chosen = fill(scatter, layout)
    room, standing = made.room, (made.boxes, scatter.boxes)
    agent = start(free_for(room, *standing, START_RADIUS) & scatter.free & within(entrance, room.size), draw)
    values = _values(scatter.bodies, chosen, Draw(STREAM, f"{seed}/values", attempt))
    burns = {name: v for name, v in values.items() if CATEGORIES[name.rpartition("_")[0]].flammable}
    targets = [
        (box, burns.get(body.name, 0.0))
        for body, box in zip(scatter.bodies, standing[1], strict=True)
        if body.name in values
    ]
    bare = take(free_for(room, *standing, FLAME_RADIUS), room.size, doorways(room), MIN_DOORWAY_DISTANCE)
    rooms = [area for area in room.areas if area.name != "hall"]
    burning = outbreaks(layout, bare, rooms, agent, targets, room.size, draw)
    side, second = draw.shuffled(sorted({door.wall for door in outer_doors(room)}))
    clear = ((agent.position, START_RADIUS), *((fire, FLAME_RADIUS) for fire in burning))
    scatter.put_down("vacuum_cleaner", clear, Draw(STREAM, f"{seed}/floor", attempt))
    bodies = tuple(
        dataclasses.replace(b, value=values.get(b.name)) for b in sorted(scatter.bodies, key=lambda b: b.name)
    )
    spec = SceneSpec(name, room, tuple(made.fixtures), bodies, chosen, burning, agent, split, side, second)
    barred = next(in_leaves(spec), "")
    if barred:
        raise NoPlaceError(barred)
    return spec


def _values(bodies: list[Body], chosen: tuple[str, ...], draw: Draw) -> dict[str, float]:
    """The value of each target, by name."""
    names = sorted(body.name for body in bodies if body.category in chosen)
    return {name: float(draw.whole(int(LEAST_VALUE), int(MOST_VALUE))) for name in names}


def _entrance(room: Room, hall: Area) -> Area:
    """The part of the hall that is near the front door."""
    if _front_door(room).wall == "west":
        return Area("hall", hall.min, (hall.min[0] + NEAR_FRONT_DOOR, hall.max[1]))
    return Area("hall", (hall.max[0] - NEAR_FRONT_DOOR, hall.min[1]), hall.max)


def _front_door(room: Room) -> Opening:
    """The outer door at one of the hall's ends."""
    return next(door for door in outer_doors(room) if door.wall in ("west", "east"))


def outer_doors(room: Room) -> list[Opening]:
    """The doors in the outer walls of a home."""
    return [o for o in room.openings if o.kind == "door" and o.wall in WALLS]


def _stand_extinguisher(scatter: Scatter, area: Area, along: bool, draw: Draw) -> None:
    """Stand an extinguisher at a wall of an `area`; `along`: at one that runs from west to east."""
    model = draw.one(models_of(EXTINGUISHER))
    size = SIZE * max(asset(model).extent[:2])
    body = Body(EXTINGUISHER, EXTINGUISHER, model, (0.0, 0.0, RESTING_HEIGHT), boxes.turned(0.0), (SIZE,) * 3, MASS)
    _stand(scatter, body, size, area, along, draw)


def _stand_board(scatter: Scatter, hall: Area, door: Opening, draw: Draw) -> None:
    """Stand a flood board at a wall of the `hall`, beside its front `door`: rooms have no wall left for one."""
    x = hall.min[0] if door.wall == "west" else hall.max[0]
    place = (0.0, 0.0, RESTING_HEIGHT)
    body = Body(FLOOD_BOARD, "box", "plain_box", place, boxes.turned(0.0), BOARD_SIZE, BOARD_MASS)
    _stand(scatter, body, BOARD_SIZE[1], hall, False, draw, (x, door.centre))


def _stand(
    scatter: Scatter, body: Body, deep: float, area: Area, along: bool, draw: Draw, door: Vec2 | None = None
) -> None:
    """Stand a `body`, `deep` from front to back [m], with its back at a wall of an `area`, and give it its number.

    `along`: at a wall that runs from west to east; `door`: beside this place [m], not in front of it. Raises
    NoPlaceError if there is no place.
    """
    name = f"{body.name}_{1 + sum(b.name.startswith(body.name) for b in scatter.bodies)}"
    off = deep / 2 + MIN_GAP
    for _ in range(10 * TRIES):
        axis = 0 if along else draw.whole(0, 1)  # along which the wall runs
        at = [0.0, 0.0]
        at[axis] = draw.uniform(area.min[axis] + FROM_CORNER, area.max[axis] - FROM_CORNER)
        at[1 - axis] = draw.one((area.min[1 - axis] + off, area.max[1 - axis] - off))
        if door is not None and math.dist(at, door) < BESIDE_DOOR:
            continue
        position = (round(at[0], 4), round(at[1], 4), RESTING_HEIGHT)
        turn = boxes.turned(axis * math.pi / 2 if door is not None else 0.0)
        placed = dataclasses.replace(body, name=name, position=position, rotation=turn)
        if scatter.add(placed, boxes.box_of(placed, asset(body.asset).extent), -1, None):
            return
    raise NoPlaceError(f"a {body.name} must have a place in {area.name}, got none")
