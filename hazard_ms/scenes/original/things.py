"""The things of a scene of the original while its log is replayed: where they are, and what is attached to what."""

from __future__ import annotations

from dataclasses import dataclass, field

from hazard_ms.scenes.original.axes import inverse, times, turn
from hazard_ms.scenes.original.reading import Record
from hazard_ms.spec import Quat, Vec3

TDW_MASS = 1.0  # of things whose mass is never set [kg]: docs/physics.md 0.2
MOST_STEPS = 100_000  # between things attached to each other, in one log: the published ones take 83 at most [ours]


@dataclass
class Thing:
    """An object of the original, in the original's frame, as far as the log has come."""

    id: int
    name: str  # of its model
    category: str  # in the original's words
    place: str  # of the command that added it, for errors
    position: Vec3  # of its pivot: the middle of its base [m]
    rotation: Quat
    scale_factor: float  # as it was added; the model's table says what size that is
    scale: Vec3 = (1.0, 1.0, 1.0)  # set after that
    kinematic: bool = False
    mass: float = TDW_MASS  # [kg]
    friction: float | None = None  # [-]
    parent: int | None = None
    # heights above the base at which it holds other things, at its scale factor [m]
    floors: list[float] = field(default_factory=list)


class Log:
    """The things that a log has added so far, and its room."""

    def __init__(self) -> None:
        self.things: dict[int, Thing] = {}
        self.children: dict[int, set[int]] = {}  # ids of what is parented to a thing
        self.room = ""
        self._steps = 0

    def thing(self, r: Record, key: str = "id") -> Thing:
        """The thing that a command names. Raises ValueError if there is none."""
        if r.id(key) not in self.things:
            raise ValueError(f"{r.place}: {key} must be the id of an object that exists here, got {r.id(key)}")
        return self.things[r.id(key)]

    def attach(self, thing: Thing, parent: int | None) -> None:
        """Parent a thing to the thing of the id `parent`, or to nothing."""
        if thing.parent is not None:
            self.children[thing.parent].discard(thing.id)
        thing.parent = parent
        if parent is not None:
            self.children.setdefault(parent, set()).add(thing.id)

    def step(self, place: str) -> None:
        """Count a step from one thing to another. Raises ValueError that names the `place` where they are too many."""
        self._steps += 1
        if self._steps > MOST_STEPS:
            raise ValueError(f"{place}: a log must move at most {MOST_STEPS} things with others, got more")

    def carry(self, r: Record, position: Vec3, rotation: Quat) -> None:
        """Move the thing that a command names to `position` [m] and `rotation`, with all that is parented to it."""
        moved = [(self.thing(r), position, rotation)]
        while moved:
            thing, position, rotation = moved.pop()
            turned, pivot = times(rotation, inverse(thing.rotation)), thing.position
            thing.position, thing.rotation = position, rotation
            for child in (self.things[i] for i in self.children.get(thing.id, ())):
                self.step(r.place)
                x, y, z = turn(turned, _minus(child.position, pivot))
                there = (position[0] + x, position[1] + y, position[2] + z)
                moved.append((child, there, times(turned, child.rotation)))


def _minus(a: Vec3, b: Vec3) -> Vec3:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
