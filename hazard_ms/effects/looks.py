"""The looks of hazards in pictures; nothing here changes physics, chance or labels."""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar, Protocol

import sapien
from torch import Tensor

from hazard_ms.effects.entities import PREFIX, draws, materials
from hazard_ms.effects.scene_effects import SceneEffects
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.shaders.pack import shader_config
from hazard_ms.effects.streets import street
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.hazards.base import Hazard
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.progress import say
from hazard_ms.spec.registry import HAZARDS, load


class Effects(Protocol):
    """The effects of one hazard in each of E scenes, made when the scenes are built, never shared.

    The registry names the class of each hazard (`looks`).
    """

    layer: ClassVar[int]  # lower ones are drawn first, and hide more

    @classmethod
    def build(
        cls,
        scenes: list[sapien.Scene],
        specs: tuple[SceneSpec, ...],
        world: World,
        mode: str,
        around: list[Surroundings],
    ) -> Effects:
        """Effects of `mode` (full, fast, off) for `scenes`, drawn or not; `around`: what fills their space."""

    def update(self, world: World, state: Any, frame: Tensor) -> None:
        """Show `world` and the hazard's `state` at `frame` [E]: same input, same pixels.

        It changes nothing but the picture.
        """


def makers(hazards: tuple[Hazard, ...]) -> dict[str, type[Effects]]:
    """Classes of the effects of those of `hazards` that have any, by the hazards' names, in the order of drawing."""
    looks = {h.name: load(HAZARDS[h.name].looks) for h in hazards if h.name in HAZARDS and HAZARDS[h.name].looks}
    return dict(sorted(looks.items(), key=lambda item: item[1].layer))


class Looks:
    """The effects of all hazards of a task together."""

    def __init__(
        self,
        hazards: tuple[Hazard, ...],
        scenes: list[sapien.Scene],
        specs: tuple[SceneSpec, ...],
        world: World,
        mode: str,
    ) -> None:
        """Effects of `mode` (full, fast, off) for `scenes` in which the things of `specs` stand."""
        shader_config(mode)
        shown = pack.available(mode) and all(draws(s) for s in scenes)
        self._towns = [
            street.build(scene, spec) if shown and spec.room.open_air and spec.room.patches else []
            for scene, spec in zip(scenes, specs, strict=True)
        ]
        filled = shown and any(h.fills for h in hazards)
        self._around = [Surroundings(*row) for row in zip(scenes, specs, strict=True)] if filled else []
        self._parts: dict[str, Effects] = {
            name: maker.build(scenes, specs, world, mode, self._around) for name, maker in makers(hazards).items()
        }
        self._lit = [
            [m for e in s.entities if e.name.startswith(PREFIX) for m in materials(e)] for s in scenes if draws(s)
        ]
        self._air: list[tuple[float, float, float]] = []
        self.veiled = True  # whether smoke and haze dim what is behind them; spectators always see them do so

    def light(self, air: list[tuple[float, float, float]]) -> None:
        """Set the light on smoke, water, haze and things in the air: linear red, green, blue, 1 by day, per scene."""
        if air == self._air:
            return
        self._air = list(air)
        for row, colour in zip(self._lit, air, strict=True):
            for material in row:
                material.base_color = [*colour, 1.0]
        for town, colour in zip(self._towns, air, strict=True):
            street.shine(town, colour)
        for around, colour in zip(self._around, air, strict=False):
            around.light(colour)

    def update(self, world: World, states: dict[str, Any], frame: Tensor, spectator: bool = False) -> None:
        """Show the hazards' `states` at `frame` [E]; to be called before a picture is taken.

        For a `spectator` smoke is thinner, so that the picture can be read.
        """
        for name, part in self._parts.items():
            if isinstance(part, SceneEffects):
                part.spectator = spectator
            part.update(world, states[name], frame)
        for around in self._around:
            around.show(self.veiled or spectator)


@cache
def tell_of_first_picture(on_cpu: bool) -> None:
    """Tell, once per process, of the table of reflections that SAPIEN computes before its first picture."""
    if on_cpu:  # 14 s of one core's time; a GPU takes a moment
        say("preparing the first picture (once per process, about 10 s)")
