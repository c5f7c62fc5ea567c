"""The contract that every hazard keeps: parameters (frozen) + state (declared tensors) + three verbs.

A quantity is declared once; allocation, partial reset, save, restore and documentation all come from the declaration.
"""

from __future__ import annotations

import abc
import dataclasses
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import torch
from torch import Tensor

from hazard_ms.simulation.openings import Strain
from hazard_ms.simulation.state import DTYPES, State, quantity
from hazard_ms.spec import Level, Quantity, SceneSpec

if TYPE_CHECKING:
    from hazard_ms.simulation.world import World

__all__ = ["DTYPES", "Hazard", "Level", "Push", "State", "begin", "loosened", "none_set", "quantity", "summed"]


def loosened(hazards: Iterable[Hazard], spec: SceneSpec) -> frozenset[str]:
    """Names of the furniture of a scene that some of the `hazards` can set free."""
    return frozenset().union(*(hazard.loosens(spec) for hazard in hazards))


def pushes(hazards: Iterable[Hazard]) -> bool:
    """Whether any of the hazards moves things, so that a simulator is needed."""
    return any(type(hazard).force is not Hazard.force for hazard in hazards)


def none_set(mask: Tensor) -> bool:
    """Whether `mask`, [...], holds nowhere, so that work can be skipped.

    False on a GPU, where asking would make the host wait.
    """
    return mask.is_cpu and not bool(mask.any())


@dataclasses.dataclass
class Push:
    """The push of a hazard on the bodies over the coming physics step, [E, B, 3], world frame.

    Mean force [N], and torque about the centre of mass [N m]. They hold until the hazard is asked again; until then
    nobody changes them.
    """

    force: Tensor
    torque: Tensor | None = None


def summed(parts: list[Tensor], like: Tensor) -> Tensor:
    """The sum of one or several forces [N] or torques [N m], [E, B, 3] as `like`; one that is like that, itself."""
    total = parts[0] if len(parts) == 1 else torch.stack(parts).sum(0)
    if (total.shape, total.dtype) == (like.shape, like.dtype) and total.is_contiguous() and not total.requires_grad:
        return total
    return total.detach().to(like.dtype).expand_as(like).contiguous()


class Flames(NamedTuple):
    """The places where something burns: things as along B, then flames on the floor, P in all."""

    place: Tensor  # [m], [E, P, 3], world frame
    lit: Tensor  # [E, P], bool


class Hazard(abc.ABC):
    """One physical process. Parameters live on the hazard (a frozen dataclass), evolving tensors on its state."""

    name: ClassVar[str]
    state_type: ClassVar[type[State]]
    level: ClassVar[Level]
    fills: ClassVar[bool] = False  # it shows in the space between things: as water, haze or smoke
    open_air: ClassVar[bool] = False  # it needs a scene in the open
    tells: ClassVar[dict[str, Quantity]] = {}  # what each key of `agent_info` is
    # what sensors notice of it, "package.module:Class", see hazard_ms.sensing.senses.signals; empty: nothing
    signals: ClassVar[str] = ""
    # fields of the world that it writes: name -> its method (state, world, points)
    provides: ClassVar[dict[str, str]] = {}
    uses: ClassVar[tuple[str, ...]] = ()  # fields of the world that it reads, where another hazard provides them

    @property
    def shown_level(self) -> Level:
        """The level with the range of colours that suits these parameters, for films and pictures.

        Observations and learners keep that of `level`, which is the same for all parameters.
        """
        return self.level

    def sizes(self, world: World) -> dict[str, int]:
        """Lengths of the axes of its quantities beyond E and B."""
        return {}

    @abc.abstractmethod
    def reset(self, state: Any, world: World, rows: Tensor) -> None:
        """Start an episode in the environments `rows`, indices [R], which have their fill values; touch no others."""

    def loosens(self, spec: SceneSpec) -> frozenset[str]:
        """Names of the furniture of a scene that it can set free in an episode. By default none."""
        return frozenset()

    def loose(self, state: Any, world: World) -> Tensor | None:
        """Furniture that it has set free by now, [E, B], bool; None: it never does."""
        return None

    def force(self, state: Any, world: World, dt: float) -> Push | None:
        """The push on the bodies over the coming physics step of `dt` seconds; None: never any.

        Changes nothing.
        """
        return None

    @abc.abstractmethod
    def advance(self, state: Any, world: World, dt: float) -> None:
        """Carry `state` over one frame of `dt` seconds. Changes `state` and nothing else."""

    @abc.abstractmethod
    def damaged(self, state: Any, world: World) -> Tensor:
        """Bodies that this hazard is damaging now, [E, B], bool. The damage record keeps what was ever damaged."""

    @abc.abstractmethod
    def image(self, state: Any, world: World, points: Tensor) -> Tensor:
        """The hazard's level at `points` [m], [E, P, 3], world frame -> [E, P], in the unit of `level`."""

    def threatens(self, target: Any, level: float, height: float) -> bool:
        """Whether a thing is damaged where this hazard's level is `level`: what agents are told of the hazard.

        `target` has the catalogue's properties `flammable`, `waterproof` and `ignition_temperature` [C], as
        `hazard_ms.sensing.target_table.Target` has them; `height`: of its middle above the floor [m]. By default never.
        """
        return False

    def withstands(self, category: str) -> tuple[float, ...]:
        """Pressure of the air from which each model of a `category` slides, a square of a wind speed [m^2/s^2].

        What agents are told where wind carries things off for good; by default nothing.
        """
        return ()

    def forbids(self, state: Any, world: World, points: Tensor) -> Tensor:
        """Whether an agent that the hazard affects must avoid `points` [m], [E, P, 3]: [E, P]. By default none."""
        return torch.zeros(points.shape[:2], dtype=torch.bool, device=points.device)

    def slow(self, state: Any, world: World) -> Tensor:
        """The motion that is left to an agent that the hazard affects, [E, 3].

        The share of its own velocity, and the velocity x, y [m/s] that comes on top. By default all of it, and nothing.
        """
        return torch.eye(3, device=world.device)[:1].expand(world.num_envs, 3)

    def fallen(self, state: Any, world: World) -> Tensor | None:
        """Whether an agent that the hazard affects lies on the ground, [E], bool; None: it never falls."""
        return None

    def strain(self, state: Any, world: World) -> Strain | None:
        """The load and heat that it puts on doors and windows now, see `Strain`; None: none. Changes nothing.

        It is asked every openings.EVERY frames, after `advance`.
        """
        return None

    def flames(self, state: Any, world: World) -> Flames | None:
        """The flames that an extinguisher can be aimed at now; None: none ever. Changes nothing."""
        return None

    def smother(self, state: Any, world: World, things: Tensor) -> None:  # noqa: B027 most have nothing to do
        """Keep the air from the things of the mask `things`, [E, B], for good: what burns of them goes out."""

    @property
    def clock(self) -> float:
        """Seconds of the hazard in a second of the episode: how fast the charge of extinguishers is used up [-]."""
        return 1.0

    def agent_info(self, state: Any, world: World) -> dict[str, Tensor]:
        """The numbers of `info` about the agent, by name, [E] each; with units as the hazard declares."""
        return {}


def begin(hazard: Hazard, world: World) -> Any:
    """The state of `hazard` in an episode that begins in all environments of `world`."""
    sizes = {"E": world.num_envs, "B": world.num_bodies, **hazard.sizes(world)}
    state = hazard.state_type.allocate(sizes, world.device)
    hazard.reset(state, world, torch.arange(world.num_envs))
    return state
