"""What a scene and a task are made of, as plain frozen data. No torch, no SAPIEN.

Lengths in metres, masses in kilograms, angles in radians, temperatures in degrees Celsius. World frame: x right, y forward, z up, the
floor is z = 0, the room's south-west floor corner is the origin. Quaternions are (w, x, y, z).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]

UPRIGHT: Quat = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Body:
    """A thing that moves. `position` is where the middle of its base rests (assets have their base at z = 0)."""

    name: str  # unique in its scene, "bottle_2"
    category: str  # a key of the catalogue
    asset: str  # a key of the asset index
    position: Vec3  # [m]
    rotation: Quat = UPRIGHT
    scale: Vec3 = (1.0, 1.0, 1.0)  # of the asset's own size
    mass: float | None = None  # [kg]; None: the asset's
    wind_resistance: float | None = None  # [-]; None: the category's
    friction: float | None = None  # [-] Coulomb; None: the usual one


@dataclass(frozen=True)
class Fixture:
    """A thing that stays where it is (furniture); it may burn."""

    name: str
    category: str
    asset: str
    position: Vec3  # [m]
    rotation: Quat = UPRIGHT
    scale: Vec3 = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Opening:
    """A door (closed), a window (with panes) or a doorway (open) cut out of a wall."""

    kind: str  # door | window | doorway
    wall: str  # south, east, north, west, or the name of a partition
    centre: float  # along the wall, from its west or south end [m]
    width: float  # [m]
    height: float  # [m]
    sill: float = 0.0  # height of the lower edge [m]


@dataclass(frozen=True)
class Partition:
    """A wall from one outer wall to the opposite one: it parts the room in two, and openings name it as their wall."""

    name: str  # "partition_1"
    axis: str  # along which it runs: x (from west to east) | y (from south to north)
    at: float  # the middle of its thickness on the other axis [m]
    thickness: float = 0.12  # [m]


@dataclass(frozen=True)
class Patch:
    """A rectangle of the ground that looks different: a road, a lawn. Level, without collision; later ones lie on earlier ones."""

    material: str
    min: Vec2  # [m]
    max: Vec2  # [m]


@dataclass(frozen=True)
class Room:
    """A rectangular room, or a piece of open ground, with its south-west floor corner at the origin."""

    size: Vec2  # inner extent along x and y [m]
    height: float = 2.6  # [m]
    floor: str = "wood"  # names of materials, see hazard_ms.scenes.shell
    wall: str = "plaster"
    openings: tuple[Opening, ...] = ()
    partitions: tuple[Partition, ...] = ()
    patches: tuple[Patch, ...] = ()
    open_air: bool = False  # no walls and no ceiling: the ground goes on
    beyond: float = 0.0  # how far things can be carried over every side of `size`, in the open [m]


@dataclass(frozen=True)
class AgentStart:
    """Where the agent stands at frame 0, and where it faces."""

    position: Vec2  # [m]
    heading: float = 0.0  # anticlockwise from +x [rad]


@dataclass(frozen=True)
class SceneSpec:
    """Everything that `World` needs in order to build one scene, and a task in order to play in it."""

    name: str  # "kitchen_a/07"
    room: Room
    fixtures: tuple[Fixture, ...]
    bodies: tuple[Body, ...]
    target_categories: tuple[str, ...]  # every body of these categories is a target
    fires: tuple[Vec2, ...]  # where the floor burns at frame 0 [m]
    agent_start: AgentStart
    split: str = "train"
    flood_side: str = "east"  # from which wall water comes: south | east | north | west
    wind: Vec2 = (0.0, 0.0)  # velocity of the air [m/s]

    @property
    def things(self) -> tuple[Body | Fixture, ...]:
        """Bodies, then fixtures: the order of everything along B."""
        return (*self.bodies, *self.fixtures)

    @property
    def targets(self) -> tuple[Body, ...]:
        return tuple(b for b in self.bodies if b.category in self.target_categories)

    @property
    def containers(self) -> tuple[Fixture, ...]:
        """Fixtures in which things are safe: shopping carts."""
        return tuple(f for f in self.fixtures if f.category == "cart")


@dataclass(frozen=True)
class Task:
    """A rescue task: which scenes, which hazards, for how long, and where things are safe."""

    name: str  # "HazardFire-v1"
    scenes: Callable[[str], tuple[str, ...]]  # split -> scene names
    build: Callable[[str], SceneSpec]  # scene name -> scene
    hazards: tuple[Any, ...]  # hazard_ms.hazards.base.Hazard, in the order in which they advance
    max_frames: int
    splits: tuple[str, ...] = ("train", "test")
    safe_place: str = "bag"  # bag: carried by the agent | cart: containers in the scene

    @property
    def all_scenes(self) -> tuple[str, ...]:
        """Names of the scenes of all splits."""
        return tuple(dict.fromkeys(name for split in self.splits for name in self.scenes(split)))
