"""Names of scenes, which split holds them, and the scene of each name."""

from __future__ import annotations

import functools

from hazard_ms.scenes.arrangement import NoPlaceError
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.endangering import FLAME, START, fires, start
from hazard_ms.scenes.floor import free_for
from hazard_ms.scenes.layout import Layout
from hazard_ms.scenes.placement import furnish
from hazard_ms.scenes.rooms import LAYOUTS
from hazard_ms.scenes.scatter import Scatter, fill
from hazard_ms.spec import SceneSpec

GENERATOR = "1"  # goes up whenever the same name would give another scene
ATTEMPTS = 60  # at one scene
NUMBERS = {"train": range(0, 20), "test": range(20, 25)}  # of the scenes of every room


def split_names() -> tuple[str, ...]:
    """Names of the splits."""
    return tuple(NUMBERS)


def scene_names(split: str) -> tuple[str, ...]:
    """Names of the scenes of a split: "kitchen_a/00", ..."""
    if split not in NUMBERS:
        raise ValueError(f"no split is called {split!r}; there are {', '.join(NUMBERS)}")
    return tuple(f"{room}/{n:02d}" for room in LAYOUTS for n in NUMBERS[split])


def all_scene_names() -> tuple[str, ...]:
    """Names of all scenes."""
    return tuple(name for split in NUMBERS for name in scene_names(split))


@functools.lru_cache(maxsize=256)
def scene(name: str) -> SceneSpec:
    """The scene called `name`: always the same."""
    for split in NUMBERS:
        if name in scene_names(split):
            return generate(LAYOUTS[name.split("/")[0]], name, split)
    known = ", ".join(f"{room}/00 to {room}/{max(max(n) for n in NUMBERS.values()):02d}" for room in LAYOUTS)
    raise ValueError(f"no scene is called {name!r}; there are {known}")


def generate(layout: Layout, name: str, split: str) -> SceneSpec:
    """A scene of the kind `layout`; `name` is the seed."""
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
    chosen = fill(scatter)
    size, standing = made.room.size, (made.boxes, scatter.boxes)
    agent = start(free_for(size, *standing, START) & scatter.free, draw)
    targets = [box for body, box in zip(scatter.bodies, standing[1], strict=True) if body.category in chosen]
    bare = free_for(size, *standing, FLAME)
    burning = fires(draw.one(layout.fires), scatter.free, bare, agent, targets, size, draw)
    bodies = tuple(sorted(scatter.bodies, key=lambda b: b.name))
    return SceneSpec(name, made.room, tuple(made.fixtures), bodies, chosen, burning, agent, split)
