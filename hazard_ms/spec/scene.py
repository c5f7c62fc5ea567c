"""The data that a scene is made of, plain and frozen. No torch, no SAPIEN.

Lengths in metres, masses in kilograms, angles in radians, temperatures in degrees Celsius. World frame: x right, y
forward, z up, the floor is z = 0, the room's south-west floor corner is the origin. Quaternions are (w, x, y, z).
"""

from __future__ import annotations

from dataclasses import dataclass

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]

UPRIGHT: Quat = (1.0, 0.0, 0.0, 0.0)  # no rotation


@dataclass(frozen=True)
class Body:
    """A thing that moves. `position` is that of the middle of its base (assets have their base at z = 0)."""

    name: str  # unique in its scene, "bottle_2"
    category: str  # a key of the catalogue
    asset: str  # a key of the asset index
    position: Vec3  # [m]
    rotation: Quat = UPRIGHT
    scale: Vec3 = (1.0, 1.0, 1.0)  # of the asset's own size
    mass: float | None = None  # [kg]; None: the asset's
    wind_resistance: float | None = None  # [-]; None: the category's
    friction: float | None = None  # [-] Coulomb; None: the usual one
    value: float | None = None  # if it is rescued; None: the category's


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
    """A door, a window (with panes) or a doorway (open, without a leaf) cut out of a wall."""

    kind: str  # door | window | doorway
    wall: str  # south, east, north, west, or the name of a partition
    centre: float  # along the wall, from its west or south end [m]
    width: float  # [m]
    height: float  # [m]
    sill: float = 0.0  # height of the lower edge [m]
    open: float | None = None  # share of a door's width that is open at frame 0; None: 0, closed

    @property
    def share(self) -> float:
        """Share of its width that is open at frame 0."""
        return (1.0 if self.kind == "doorway" else 0.0) if self.open is None else self.open


@dataclass(frozen=True)
class Partition:
    """A wall from one outer wall to the opposite one, which divides the room; openings name it as their wall."""

    name: str  # "partition_1"
    axis: str  # along which it runs: x (from west to east) | y (from south to north)
    at: float  # the middle of its thickness on the other axis [m]
    thickness: float = 0.12  # [m]


@dataclass(frozen=True)
class Patch:
    """A rectangle of the ground that looks different: a road, a lawn.

    Level, without collision; later ones lie on earlier ones.
    """

    material: str
    min: Vec2  # [m]
    max: Vec2  # [m]


@dataclass(frozen=True)
class Area:
    """A rectangle of the floor with a name: one of the rooms of a home. Nothing follows from it in the simulation."""

    name: str  # what it is for and a number, "kitchen_1"; "hall"
    min: Vec2  # [m]
    max: Vec2  # [m]

    def holds(self, place: tuple[float, ...]) -> bool:
        """Whether a place x, y [m] lies in it."""
        return all(low <= at <= high for low, at, high in zip(self.min, place, self.max, strict=False))


@dataclass(frozen=True)
class Room:
    """A rectangular room, or a piece of open ground, with its south-west floor corner at the origin."""

    size: Vec2  # inner extent along x and y [m]
    height: float = 2.6  # [m]
    floor: str = "wood"  # names of materials, see hazard_ms.scenes.materials
    wall: str = "plaster"
    openings: tuple[Opening, ...] = ()
    partitions: tuple[Partition, ...] = ()
    patches: tuple[Patch, ...] = ()
    open_air: bool = False  # no walls and no ceiling: the ground goes on
    beyond: float = 0.0  # how far things can be carried over every side of `size`, in the open [m]
    areas: tuple[Area, ...] = ()  # the rooms of a home


@dataclass(frozen=True)
class AgentStart:
    """The place and the heading of the agent at frame 0."""

    position: Vec2  # [m]
    heading: float = 0.0  # anticlockwise from +x [rad]


@dataclass(frozen=True)
class Parameter:
    """A number that a scene gives to a hazard which has no field of its own in `SceneSpec`."""

    hazard: str  # name of the hazard
    name: str
    value: float


@dataclass(frozen=True)
class SceneSpec:
    """All that `World` needs to build one scene, and a task to play in it."""

    name: str  # "kitchen_a/07"
    room: Room
    fixtures: tuple[Fixture, ...]
    bodies: tuple[Body, ...]
    target_categories: tuple[str, ...]  # every body of these categories is a target
    fires: tuple[Vec2, ...]  # where the floor burns at frame 0 [m]
    agent_start: AgentStart
    split: str = "train"
    flood_side: str = "east"  # from which wall water comes: south | east | north | west
    second_flood_side: str | None = None  # another wall from which it comes at the same time
    wind: Vec2 = (0.0, 0.0)  # velocity of the air [m/s]
    parameters: tuple[Parameter, ...] = ()  # of hazards that third parties bring

    def parameter(self, hazard: str, name: str, default: float) -> float:
        """The scene's number `name` for a hazard; `default` if the scene gives none."""
        return next((p.value for p in self.parameters if (p.hazard, p.name) == (hazard, name)), default)

    @property
    def things(self) -> tuple[Body | Fixture, ...]:
        """Bodies, then fixtures: the order of everything along B."""
        return (*self.bodies, *self.fixtures)

    @property
    def targets(self) -> tuple[Body, ...]:
        """Bodies that are to be rescued: all of the target categories."""
        return tuple(b for b in self.bodies if b.category in self.target_categories)

    @property
    def containers(self) -> tuple[Fixture, ...]:
        """Fixtures in which things are safe: shopping carts."""
        return tuple(f for f in self.fixtures if f.category == "cart")
