"""Generates rooms and flats: the scenes of fire and flood."""

from __future__ import annotations

from hazard_ms.scenes.floor import doorways, free_for, take
from hazard_ms.scenes.generate.arrangement import NoPlaceError
from hazard_ms.scenes.generate.draw import STREAM, Draw
from hazard_ms.scenes.generate.furnishing import furnish
from hazard_ms.scenes.generate.hazard_placement import (
    FLAME_RADIUS,
    MIN_DOORWAY_DISTANCE,
    START_RADIUS,
    fires,
    flood_side,
    start,
)
from hazard_ms.scenes.generate.kitchens import KITCHEN_A, KITCHEN_B, KITCHEN_B_HARD, KITCHEN_B_NEW
from hazard_ms.scenes.generate.layout import Layout
from hazard_ms.scenes.generate.living_rooms import CRAFT_ROOM_A, FLAT_A, LIVING_ROOM_A
from hazard_ms.scenes.generate.scatter import Scatter, fill
from hazard_ms.spec import SceneSpec

LAYOUTS: dict[str, Layout] = {
    layout.name: layout
    for layout in (KITCHEN_A, KITCHEN_B, LIVING_ROOM_A, CRAFT_ROOM_A, FLAT_A, KITCHEN_B_NEW, KITCHEN_B_HARD)
}
ATTEMPTS = 60  # at one scene


def make(place: str, name: str, split: str) -> SceneSpec:
    """The scene `name` of the room `place`, a key of LAYOUTS. Raises ValueError if nothing fits."""
    return generate(LAYOUTS[place], name, split)


def generate(layout: Layout, name: str, split: str) -> SceneSpec:
    """A scene of the kind `layout`; all randomness derives from `name`.

    Raises ValueError if the layout asks for more than fits into it.
    """
    for attempt in range(ATTEMPTS):
        try:
            return _attempt(layout, name, split, attempt)
        except NoPlaceError as problem:
            last = problem
    raise ValueError(f"{name} must fit into its room, got no arrangement in {ATTEMPTS} attempts; the last: {last}")


def _attempt(layout: Layout, name: str, split: str, attempt: int) -> SceneSpec:
    draw = Draw(STREAM, name, attempt)
    made = furnish(layout, draw)
    scatter = Scatter(made, layout, anywhere=layout.anywhere)
    chosen = fill(scatter, layout)
    room, standing = made.room, (made.boxes, scatter.boxes)
    agent = start(free_for(room, *standing, START_RADIUS) & scatter.free, draw)
    targets = [box for body, box in zip(scatter.bodies, standing[1], strict=True) if body.category in chosen]
    bare = take(free_for(room, *standing, FLAME_RADIUS), room.size, doorways(room), MIN_DOORWAY_DISTANCE)
    burning = fires(draw.one(layout.fires), scatter.free, bare, agent, targets, room.size, draw)
    side = flood_side(room, draw)
    second = flood_side(room, draw, dry=(side,)) if layout.inflows > 1 else None
    clear = ((agent.position, START_RADIUS), *((fire, FLAME_RADIUS) for fire in burning))
    scatter.put_down("vacuum_cleaner", clear, Draw(STREAM, f"{name}/floor", attempt))
    bodies = tuple(sorted(scatter.bodies, key=lambda b: b.name))
    return SceneSpec(name, room, tuple(made.fixtures), bodies, chosen, burning, agent, split, side, second)
