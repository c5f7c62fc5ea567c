"""Generates outdoor scenes: a region, three shopping carts, things that can blow away, a wind, and fires."""

from __future__ import annotations

import math

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.floor import cell_of, centre_of, free_for
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
BAY = 1.6  # from cart to cart side by side [m] [ours]: a robot gets behind each
BAY_SWAY = 0.1  # by which such carts stand aslant, at most [rad] [ours]
BAY_EDGE = 2.0  # from the middles of such carts to the edge of the region [m] [ours]
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
    _carts(made, region.parked)
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


def _carts(made: Arrangement, parked: bool) -> None:
    """Carts on open ground with space around them: far from each other, or `parked` side by side at an edge."""
    draw, places = made.draw, list[Vec2]()
    open_ground = free_for(made.room, made.boxes, [], ROBOT_RADIUS + CART_SPACE)
    x_count, y_count = open_ground.shape
    for _ in range(TRIES):
        if parked:
            places, facing = _bay(draw)
            if all(open_ground[cell_of(place)] for place in places):
                for place in places:
                    _stand(made, place, facing - math.pi / 2.0 + draw.uniform(-BAY_SWAY, BAY_SWAY))
                return
            continue
        cell = draw.whole(0, x_count - 1), draw.whole(0, y_count - 1)
        at = centre_of(cell)
        if not open_ground[cell] or any(math.dist(at, other) < BETWEEN_CARTS for other in places):
            continue
        _stand(made, at)
        places.append(at)
        if len(places) == CARTS:
            return
    raise NoPlaceError(f"{CARTS} carts find no place in {REGION_SIZE} m")


def _bay(draw: Draw) -> tuple[list[Vec2], float]:
    """Places of carts side by side at one of the four edges [m], and which way is into the region [rad]."""
    turns, first = draw.whole(0, 3), draw.uniform(BAY_EDGE, REGION_SIZE - BAY_EDGE - BAY * (CARTS - 1))
    facing, middle = turns * math.pi / 2.0, REGION_SIZE / 2.0
    out, along = BAY_EDGE - middle, [first + BAY * k - middle for k in range(CARTS)]
    ahead, aside = (
        (round(math.cos(facing)), round(math.sin(facing))),
        (-round(math.sin(facing)), round(math.cos(facing))),
    )
    return [
        (round(middle + out * ahead[0] + x * aside[0], 4), round(middle + out * ahead[1] + x * aside[1], 4))
        for x in along
    ], facing


def _stand(made: Arrangement, at: Vec2, facing: float | None = None) -> None:
    """Stand a cart there, turned by `facing` [rad], or any way."""
    number = 1 + sum(f.category == "cart" for f in made.fixtures)
    model = made.draw.one(models_of("cart"))
    turn = boxes.turned(made.draw.uniform(-math.pi, math.pi) if facing is None else facing)
    cart = Fixture(f"cart_{number}", "cart", model, (*at, 0.0), turn)
    made.fixtures.append(cart)
    made.boxes.append(boxes.box_of(cart, asset(model).extent))


def _wind(region: Region, draw: Draw) -> Vec2:
    """The velocity of the air [m/s]."""
    speed, direction = draw.uniform(*region.wind), draw.uniform(-math.pi, math.pi)
    return round(speed * math.cos(direction), 4), round(speed * math.sin(direction), 4)
