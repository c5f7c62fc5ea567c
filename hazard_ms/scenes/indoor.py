"""Rooms and flats: the scenes of fire and flood."""

from __future__ import annotations

from hazard_ms.scenes.arrangement import NoPlaceError
from hazard_ms.scenes.draw import GENERATOR, Draw
from hazard_ms.scenes.endangering import FLAME, FROM_DOORWAYS, START, fires, flood_side, start
from hazard_ms.scenes.floor import doorways, free_for, take
from hazard_ms.scenes.furnishing import furnish
from hazard_ms.scenes.layout import Layout
from hazard_ms.scenes.rooms import LAYOUTS
from hazard_ms.scenes.scatter import Scatter, fill
from hazard_ms.spec import SceneSpec

ATTEMPTS = 60  # at one scene


def make(place: str, name: str, split: str) -> SceneSpec:
    """The scene `name` of the room `place`, a key of LAYOUTS."""
    return generate(LAYOUTS[place], name, split)


def generate(layout: Layout, name: str, split: str) -> SceneSpec:
    """A scene of the kind `layout`; `name` is the seed. Raises ValueError when the layout leaves no room for what it wants."""
    for attempt in range(ATTEMPTS):
        draw = Draw(GENERATOR, name, attempt)
        try:
            return _attempt(layout, name, split, draw)
        except NoPlaceError as problem:
            last = problem
    raise ValueError(f"{name} could not be laid out in {ATTEMPTS} attempts; the last: {last}")


def _attempt(layout: Layout, name: str, split: str, draw: Draw) -> SceneSpec:
    made = furnish(layout, draw)
    scatter = Scatter(made, layout)
    chosen = fill(scatter, layout)
    room, standing = made.room, (made.boxes, scatter.boxes)
    agent = start(free_for(room, *standing, START) & scatter.free, draw)
    targets = [box for body, box in zip(scatter.bodies, standing[1], strict=True) if body.category in chosen]
    bare = take(free_for(room, *standing, FLAME), room.size, doorways(room), FROM_DOORWAYS)
    burning = fires(draw.one(layout.fires), scatter.free, bare, agent, targets, room.size, draw)
    bodies = tuple(sorted(scatter.bodies, key=lambda b: b.name))
    return SceneSpec(name, room, tuple(made.fixtures), bodies, chosen, burning, agent, split, flood_side(room, draw))
