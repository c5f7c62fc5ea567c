"""Generates outdoor scenes: a region, three shopping carts, things that can blow away, a wind, and fires."""

from __future__ import annotations

import math

from hazard_ms.assets.index import asset
from hazard_ms.scenes import boxes
from hazard_ms.scenes.floor import centre_of, free_for
from hazard_ms.scenes.generate.arrangement import Arrangement, NoPlaceError, models_of
from hazard_ms.scenes.generate.draw import STREAM, Draw
from hazard_ms.scenes.generate.hazard_placement import FLAME_RADIUS, START_RADIUS, fires, start
from hazard_ms.scenes.generate.region_layout import lay_out
from hazard_ms.scenes.generate.regions import REGION_SIZE, REGIONS, Region
from hazard_ms.scenes.generate.scatter import ROBOT_RADIUS, Scatter
from hazard_ms.spec import Fixture, SceneSpec, Vec2
from hazard_ms.spec.catalogue import CATEGORIES, HIGH_VALUE, WIND_POOL

CARTS = 3  # in a scene [docs/benchmark.md 1]
BETWEEN_CARTS = 4.0  # at least [m] [ours]
CART_SPACE = 0.5  # from a cart's box to anything else [m] [ours]: a robot must get to it
FIRES = (1, 2, 3)  # numbers of fires, for tasks in which it burns outdoors, equally likely
TRIES = 400  # draws for the carts
ATTEMPTS = 60  # at one scene


def make(place: str, name: str, split: str) -> SceneSpec:
    """The scene `name` of the region `place`, a key of REGIONS. Raises ValueError if nothing fits."""
    for attempt in range(ATTEMPTS):
        try:
            return _compose(REGIONS[place], name, split, Draw(STREAM, name, attempt))
        except NoPlaceError as problem:
            last = problem
    raise ValueError(f"{name} must fit into its region, got no arrangement in {ATTEMPTS} attempts; the last: {last}")


def _compose(region: Region, name: str, split: str, draw: Draw) -> SceneSpec:
    """A scene of a region. Raises NoPlaceError where things do not fit this time."""
    made = lay_out(region, draw)
    _carts(made)
    scatter = Scatter(made, region, hollow=("cart",), in_the_open=0.8)
    for category in _wanted(region.targets, draw):
        if not scatter.place(category, on_floor=draw.uniform() < 0.9):
            raise NoPlaceError(f"a {category} finds no place in {region.name}")
    agent = start(free_for(made.room, made.boxes, scatter.boxes, START_RADIUS) & scatter.free, draw)
    targets = scatter.boxes
    burning = fires(
        draw.one(FIRES),
        scatter.free,
        free_for(made.room, made.boxes, targets, FLAME_RADIUS),
        agent,
        targets,
        made.room.size,
        draw,
    )
    bodies = tuple(sorted(scatter.bodies, key=lambda b: b.name))
    kinds = tuple(sorted({b.category for b in bodies}))
    return SceneSpec(
        name, made.room, tuple(made.fixtures), bodies, kinds, burning, agent, split, wind=_wind(region, draw)
    )


def _wanted(count: int, draw: Draw) -> list[str]:
    """Categories of `count` targets; both values are among them."""
    pool = [c for c in WIND_POOL if models_of(c)]
    while True:
        chosen = [draw.one(pool) for _ in range(count)]
        if len({CATEGORIES[c].value == HIGH_VALUE for c in chosen}) == 2:
            return sorted(chosen, key=lambda c: (-max(asset(m).extent[0] for m in models_of(c)), c))


def _carts(made: Arrangement) -> None:
    """Carts on open ground, far from each other, with space around them."""
    draw, places = made.draw, list[Vec2]()
    open_ground = free_for(made.room, made.boxes, [], ROBOT_RADIUS + CART_SPACE)
    x_count, y_count = open_ground.shape
    for _ in range(TRIES):
        cell = draw.whole(0, x_count - 1), draw.whole(0, y_count - 1)
        at = centre_of(cell)
        if not open_ground[cell] or any(math.dist(at, other) < BETWEEN_CARTS for other in places):
            continue
        model = draw.one(models_of("cart"))
        turn = boxes.turned(draw.uniform(-math.pi, math.pi))
        cart = Fixture(f"cart_{len(places) + 1}", "cart", model, (*at, 0.0), turn)
        made.fixtures.append(cart)
        made.boxes.append(boxes.box_of(cart, asset(model).extent))
        places.append(at)
        if len(places) == CARTS:
            return
    raise NoPlaceError(f"{CARTS} carts find no place {BETWEEN_CARTS} m from each other in {REGION_SIZE} m")


def _wind(region: Region, draw: Draw) -> Vec2:
    """The velocity of the air [m/s]."""
    speed, direction = draw.uniform(*region.wind), draw.uniform(-math.pi, math.pi)
    return round(speed * math.cos(direction), 4), round(speed * math.sin(direction), 4)
