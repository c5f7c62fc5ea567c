"""The contract that every hazard keeps: parameters (frozen) + state (declared tensors) + three verbs.

A quantity is declared once; allocation, partial reset, save, restore and documentation all come from the declaration.
"""

from __future__ import annotations

import abc
import dataclasses
import math
from typing import TYPE_CHECKING, Any, ClassVar

import torch
from torch import Tensor

from hazard_ms.spec import Level, Quantity

if TYPE_CHECKING:
    from hazard_ms.simulation.world import World

DTYPES = {"float": torch.float32, "int": torch.int64, "bool": torch.bool}


def quantity(
    shape: str,
    unit: str,
    meaning: str,
    dtype: str = "float",
    fill: float = 0,
    low: float = -math.inf,
    high: float | str = math.inf,
) -> Any:
    """A field of a state.

    `shape` names its axes: E environments, B bodies, a number, or a name that the hazard's `sizes` has. Raises
    ValueError for other shapes and types of numbers.

    Saved states are restored only with numbers from `low` to `high`. A name as `high` is for indices: of things ("B"),
    or into another quantity of the state.
    """
    if not shape.split() or shape.split()[0] != "E":
        raise ValueError(f"shape of the quantity {meaning!r} must begin with the axis E, got {shape!r}")
    if dtype not in DTYPES:
        raise ValueError(f"dtype of the quantity {meaning!r} must be one of {', '.join(DTYPES)}, got {dtype!r}")
    return dataclasses.field(
        metadata={
            "shape": shape.split(),
            "unit": unit,
            "meaning": meaning,
            "dtype": dtype,
            "fill": fill,
            "low": low,
            "high": high,
        }
    )


def none_set(mask: Tensor) -> bool:
    """Whether `mask`, [...], holds nowhere, so that work can be skipped.

    False on a GPU, where asking would make the host wait.
    """
    return mask.device.type == "cpu" and not bool(mask.any())


class State:
    """Base of hazard states: dataclasses whose fields are all `quantity(...)`."""

    @classmethod
    def allocate(cls, sizes: dict[str, int], device: torch.device | str) -> Any:
        """All quantities at their fill value; `sizes` gives each axis letter its length."""
        made = {}
        for f in dataclasses.fields(cls):  # type: ignore[arg-type]
            shape = [int(axis) if axis.isdigit() else sizes[axis] for axis in f.metadata["shape"]]
            made[f.name] = torch.full(shape, f.metadata["fill"], dtype=DTYPES[f.metadata["dtype"]], device=device)
        return cls(**made)

    def clear(self, rows: Tensor) -> None:
        """Put the environments `rows`, indices [R], back to the fill values."""
        for f in dataclasses.fields(self):  # type: ignore[arg-type]
            getattr(self, f.name)[rows] = f.metadata["fill"]

    def save(self) -> dict[str, Tensor]:
        """Copies of all fields by name, [E, ...], in the units of the fields."""
        return {f.name: getattr(self, f.name).clone() for f in dataclasses.fields(self)}  # type: ignore[arg-type]

    def restore(self, saved: dict[str, Tensor], rows: Tensor | slice = slice(None)) -> None:
        """Write `saved`, as `save` gave it, [R, ...], into the environments `rows`, indices [R].

        Raises ValueError for other fields than those of this state.
        """
        names = {f.name for f in dataclasses.fields(self)}  # type: ignore[arg-type]
        if set(saved) != names:
            raise ValueError(f"saved state of {type(self).__name__} must have {sorted(names)}, got {sorted(saved)}")
        for name in names:
            getattr(self, name)[rows] = saved[name].to(getattr(self, name))


@dataclasses.dataclass
class Push:
    """The push of a hazard on the bodies over the coming physics step, [E, B, 3], world frame; never changed in place.

    Mean force [N], and torque about the centre of mass [N m].
    """

    force: Tensor
    torque: Tensor | None = None


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

    def agent_info(self, state: Any, world: World) -> dict[str, Tensor]:
        """The numbers of `info` about the agent, by name, [E] each; with units as the hazard declares."""
        return {}
