"""The effects of one hazard in a batch of scenes: built with them, and shown before a picture is taken."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import sapien
from torch import Tensor
from typing_extensions import Self

from hazard_ms.effects.entities import canvas
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec


class Place(NamedTuple):
    """One scene, with all that its effects are made from."""

    scene: sapien.Scene
    spec: SceneSpec
    names: tuple[str, ...]  # of its things
    around: Surroundings | None  # what fills its space; None: nothing does
    rich: bool  # with the effects that the mode `full` alone has
    batch: tuple[SceneSpec, ...]  # all scenes that are built together


class SceneEffects(abc.ABC):
    """The effects of one hazard in each of E scenes. It keeps the contract of `hazard_ms.effects.looks.Effects`."""

    layer: ClassVar[int]

    def __init__(self, scenes: list[Any], mode: str, device: sapien.Device | None) -> None:
        self._scenes, self._mode, self._device = scenes, mode, device
        self.spectator = False  # the coming picture is taken in third person

    @classmethod
    def build(
        cls,
        scenes: list[sapien.Scene],
        specs: tuple[SceneSpec, ...],
        world: World,
        mode: str = "full",
        around: Sequence[Surroundings] = (),
    ) -> Self:
        """Effects of `mode` (full, fast, off) for `scenes`, in which the things of `specs` stand.

        `around`: what fills the space of each scene. Without a renderer, or with a SAPIEN whose shaders are unknown,
        nothing is shown. Raises ValueError for unknown modes.
        """
        device, shown = canvas(scenes, mode)
        spaces: Sequence[Surroundings | None] = around or [None] * len(scenes)
        rows = zip(scenes, specs, world.names, spaces, strict=True)
        made = [cls.of_scene(Place(*row, mode == "full", specs)) for row in rows] if shown else []
        return cls(made, mode, device)

    def update(self, world: World, state: Any, frame: Tensor) -> None:
        """Show `world` and the hazard's `state` at `frame`, [E]. It changes nothing but the next picture."""
        if self._device is not None:
            pack.keep_warm(self._mode, self._device)
        if self._scenes:
            self.show(world, state, frame)

    @classmethod
    @abc.abstractmethod
    def of_scene(cls, place: Place) -> Any:
        """The effects of one scene, hidden."""

    @abc.abstractmethod
    def show(self, world: World, state: Any, frame: Tensor) -> None:
        """Show `world` and the hazard's `state` in every scene at `frame`, [E]."""
