"""The things of E scenes as batched tensors, and the calls that cross into the simulator.

Indices along B count the bodies of a scene (they move) and then its fixtures (they do not), padded to the largest scene
of the batch. Hazards see only this class: they know nothing of SAPIEN, and their tests use a World without a simulator
(`handles=None`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor

from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.crew import Crew
from hazard_ms.simulation.handles import Handles
from hazard_ms.simulation.jet import Jet
from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.simulation.mitigation.door_grip import DoorGrip
from hazard_ms.simulation.mitigation.equipment import Equipment
from hazard_ms.simulation.openings import Openings
from hazard_ms.simulation.walls import Walls
from hazard_ms.spec import Body, Build, SceneSpec, checks
from hazard_ms.spec.catalogue import CATEGORIES, value_of


@dataclass
class World:
    """State and properties of all things, in the world frame, SI units and degrees Celsius.

    position          [E, B, 3]  centre of the bounding box, which is the centre of mass [m]
    rotation          [E, B, 4]  unit quaternion w x y z
    velocity          [E, B, 3]  velocity of the centre of mass [m/s]
    angular_velocity  [E, B, 3]  about the world's axes [rad/s]
    extent            [E, B, 3]  edge lengths of the box along the body's own axes [m]
    mass              [E, B]     [kg]
    exists            [E, B]     bool; False where the scene has fewer things than B
    movable           [E, B]     bool; True for bodies and for fixtures that a hazard has set free
    floats            [E, B]     bool; fixtures that the simulator can set free
    category          [E, B]     index into the catalogue; -1 where nothing exists
    target            [E, B]     bool; must be rescued
    value             [E, B]     value of a rescue, 1 or 5
    safe              [E, B]     bool; rescued: hazards no longer touch it (written by the rescue record)
    away              [E, B]     bool; in the agent's bag, so no longer in the scene (written by the episode)
    held              [E, B]     bool; in the agent's hand (written by the agent's hand)
    room              [E, 2]     inner size of the room along x and y [m]
    agent_position    [E, 3]     middle of the agent's base on the floor [m]
    agent_heading     [E]        anticlockwise from +x [rad]

    `fields` holds what hazards tell each other, as functions of points [m], [E, P, 3], with one writer each: `water`,
    the level of the water [m], [E, P], and `air`, the velocity of the air x, y [m/s], [E, P, 2].
    """

    specs: tuple[SceneSpec, ...]
    names: tuple[tuple[str, ...], ...]  # names of the things of each scene, in the order of B
    chance: Chance
    position: Tensor
    rotation: Tensor
    velocity: Tensor
    angular_velocity: Tensor
    extent: Tensor
    mass: Tensor
    exists: Tensor
    movable: Tensor
    floats: Tensor
    category: Tensor
    target: Tensor
    value: Tensor
    safe: Tensor
    away: Tensor
    held: Tensor
    room: Tensor
    agent_position: Tensor
    agent_heading: Tensor
    handles: Handles | None = field(default=None, repr=False)
    jets: list[Jet] = field(default_factory=list)  # of the extinguisher in use of each robot, where there are any
    equipment: Equipment | None = None  # what the agent can pick up and use, in tasks with mitigations
    door_grip: DoorGrip | None = None  # the hand at the handles of doors, in tasks in which leaves follow it
    agent_build: Build | None = None  # mass, width, drag area and friction of the agent's robot
    team: Crew | None = None  # the robots of a team, for each of which there is a world; None: there is one robot
    fields: dict[str, Callable[[Tensor], Tensor]] = field(default_factory=dict, repr=False)
    launches: Launches = field(default_factory=Launches, repr=False)  # prepared launches of its hazards' kernels

    @classmethod
    def of(
        cls,
        specs: tuple[SceneSpec, ...],
        extents: list[list[tuple[float, float, float]]],
        masses: list[list[float]],
        device: torch.device | str = "cpu",
    ) -> World:
        """The world of `specs`, all in place; `extents` [m] and `masses` [kg] are those of bodies, then fixtures."""
        things = [s.things for s in specs]
        shape = (len(specs), max(len(t) for t in things))

        def zeros(*more: int, dtype: torch.dtype = torch.float32) -> Tensor:
            return torch.zeros(*shape, *more, dtype=dtype, device=device)

        marks = ("exists", "movable", "floats", "target", "safe", "away", "held")
        none: Any = {name: zeros(dtype=torch.bool) for name in marks}
        world = cls(
            specs=specs,
            names=tuple(tuple(t.name for t in row) for row in things),
            chance=Chance(len(specs), device),
            position=zeros(3),
            rotation=zeros(4),
            velocity=zeros(3),
            angular_velocity=zeros(3),
            extent=zeros(3),
            mass=zeros(),
            category=zeros(dtype=torch.int64) - 1,
            value=zeros(),
            **none,
            room=torch.tensor([s.room.size for s in specs], device=device),
            agent_position=torch.tensor([[*s.agent_start.position, 0.0] for s in specs], device=device),
            agent_heading=torch.tensor([s.agent_start.heading for s in specs], device=device),
        )
        for e, (spec, row, n) in enumerate(zip(specs, things, map(len, things), strict=True)):
            world.extent[e, :n] = torch.tensor(extents[e], device=device)
            world.mass[e, :n], world.exists[e, :n] = torch.tensor(masses[e], device=device), True
            world.rotation[e, :n] = torch.tensor([t.rotation for t in row], device=device)
            world.movable[e, :n] = torch.tensor([isinstance(t, Body) for t in row], device=device)
            world.category[e, :n] = torch.tensor([[*CATEGORIES].index(t.category) for t in row], device=device)
            wanted = [isinstance(t, Body) and t.category in spec.target_categories for t in row]
            world.target[e, :n] = torch.tensor(wanted, device=device)
            world.value[e, :n] = torch.tensor([value_of(t) for t in row], device=device)
            base = torch.tensor([t.position for t in row], device=device)
            world.position[e, :n] = cls.centre_of(base, world.rotation[e, :n], world.extent[e, :n])
        world.rotation[..., 0] += (~world.exists).float()  # padding: the identity rotation
        return world

    @staticmethod
    def centre_of(base: Tensor, rotation: Tensor, extent: Tensor) -> Tensor:
        """Centres of boxes [m], [..., 3], from the middles of their bases, rotations and extents."""
        return base + rotate(rotation, extent * _half_up(extent.device))

    @staticmethod
    def base_of(centre: Tensor, rotation: Tensor, extent: Tensor) -> Tensor:
        """Middles of the bases of boxes [m], [..., 3], which are their assets' origins, from centres and rotations."""
        return centre - rotate(rotation, extent * _half_up(extent.device))

    @property
    def num_envs(self) -> int:
        """Number of environments, E."""
        return self.position.shape[0]

    @property
    def num_bodies(self) -> int:
        """Number of things in the largest scene, B: bodies and fixtures."""
        return self.position.shape[1]

    @property
    def device(self) -> torch.device:
        """Device on which all tensors live."""
        return self.position.device

    @property
    def robot(self) -> Build:
        """Build of the agent's robot, on which water and wind act. Raises ValueError in a world without an agent."""
        if self.agent_build is None:
            raise ValueError("agent_build must be the build of a robot, got None: this world has no agent")
        return self.agent_build

    @property
    def crew(self) -> Crew:
        """All robots on which hazards act: those of the team, or the one robot."""
        return Crew((self.agent_build,), self.agent_position[:, None]) if self.team is None else self.team

    @property
    def frame(self) -> Tensor:
        """Frames since the start of each episode, [E], int64."""
        return self.chance.frame

    @functools.cached_property
    def walls(self) -> Walls:
        """The inner walls of the scenes, and their doorways, as open as `openings` are."""
        return Walls.of(self.specs, self.device)

    @functools.cached_property
    def openings(self) -> Openings:
        """The doors, windows and doorways of the scenes, and their state."""
        return Openings(self.specs, self.walls, self.device)

    @functools.cached_property
    def targets(self) -> Tensor:
        """Indices along B of the targets, [E, T]; those of a scene with fewer than T begin again with its first."""
        rows = [row.nonzero().flatten() if row.any() else row[:1].long() for row in self.target]
        return torch.stack([row[torch.arange(max(map(len, rows))) % len(row)] for row in rows])

    def lookup(self, attribute: str) -> Tensor:
        """A numeric attribute of the catalogue (temperatures in [C]) of every thing, float32 [E, B]; 0 for padding."""
        of_each = torch.tensor([float(getattr(c, attribute)) for c in CATEGORIES.values()], device=self.device)
        return torch.where(self.exists, of_each[self.category.clamp(min=0)], 0.0)

    def equip(self, kinds: Collection[str]) -> None:
        """Let agents pick up and use the bodies of these `kinds` that are no targets, see Equipment."""
        self.equipment = Equipment(self.specs, self.target, kinds)
        self.jets, self.equipment.hands = [self.equipment.jet], [(self.equipment.jet, self.held)]

    @property
    def takeable(self) -> Tensor:
        """The things that a hand takes, bool [E, B]: targets, and tools."""
        return self.target if self.equipment is None else self.equipment.takes

    def index(self, env: int, name: str) -> int:
        """Index along B of the thing called `name` in scene `env`. Raises ValueError if no thing has that name."""
        return self.names[env].index(checks.one_of(name, self.names[env], f"a thing in {self.specs[env].name}"))

    def read(self) -> None:
        """Refresh positions, rotations and velocities from the simulator."""
        if self.handles is not None:
            self.handles.read(self)

    def place(self, rows: Tensor) -> None:
        """Put the bodies of the environments `rows` [R] at rest in the simulator, at the world's `position` [m]."""
        if self.handles is not None:
            self.handles.place(rows, self.base_of(self.position, self.rotation, self.extent), self.rotation)

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Keep the bodies of the mask `frozen`, [E, B], at `base` [m], [E, B, 3], and `rotation`; free all others."""
        if self.handles is not None:
            self.handles.freeze(frozen, base, rotation)

    def loosen(self, loose: Tensor) -> None:
        """Set the furniture of the mask `loose`, [E, B], free, as far as the simulator can; all other stands."""
        self.movable.copy_(torch.where(self.floats, loose, self.movable))
        if self.handles is not None:
            self.handles.loosen(loose & self.floats)

    def push(self, force: Tensor, torque: Tensor | None = None) -> None:
        """Send the summed force [N] and torque [N m] of all hazards, [E, B, 3], once per physics step."""
        if self.handles is not None:
            self.handles.push(force, torque)


@functools.cache
def _half_up(device: torch.device) -> Tensor:
    """From the base of a box to its centre, in shares of its extent, [3]."""
    return torch.tensor([0.0, 0.0, 0.5], device=device)


def rotate(rotation: Tensor, vector: Tensor, back: bool = False) -> Tensor:
    """`vector` [..., 3], in any unit, turned by the unit quaternion `rotation` [..., 4], or `back` by it."""
    w, u = rotation[..., :1], -rotation[..., 1:] if back else rotation[..., 1:]
    twice = 2.0 * torch.cross(u, vector, dim=-1)
    return vector + w * twice + torch.cross(u, twice, dim=-1)
