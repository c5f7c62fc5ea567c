"""How hazards look. Pictures only: nothing here changes physics, chance or labels."""

from __future__ import annotations

import dataclasses
from typing import Any, Protocol

import sapien
from torch import Tensor

from hazard_ms.effects import shader_pack
from hazard_ms.effects.entities import PREFIX, draws, materials
from hazard_ms.effects.fire_effects import FireEffects
from hazard_ms.effects.flood_effects import FloodEffects
from hazard_ms.effects.shader_pack import shader_config
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.effects.wind_effects import WindEffects
from hazard_ms.hazards.base import Hazard
from hazard_ms.spec import SceneSpec
from hazard_ms.world import World

MAKERS: dict[str, Any] = {"fire": FireEffects, "wind": WindEffects, "flood": FloodEffects}  # by hazard; what is drawn later hides less


class Effects(Protocol):
    """What one hazard looks like, in each of E scenes. Made when the scenes are built, never shared."""

    def update(self, world: World, state: Any, frame: Tensor) -> None:
        """Show `world` and the hazard's `state` at `frame` [E]: same input, same pixels. It changes nothing but the picture."""


def fills(hazard: Hazard) -> bool:
    """Whether a hazard shows in the space between things: as water, haze or a layer of smoke."""
    return hazard.name in ("flood", "wind") or "smoke_density" in {f.name for f in dataclasses.fields(hazard.state_type)}  # type: ignore[arg-type]


class Looks:
    """What all hazards of a task look like together."""

    def __init__(
        self, hazards: tuple[Hazard, ...], scenes: list[sapien.Scene], specs: tuple[SceneSpec, ...], world: World, mode: str
    ) -> None:
        """Effects of `mode` (full, fast, off) for `scenes` in which the things of `specs` stand."""
        shader_config(mode)
        present = {h.name for h in hazards}
        filled = shader_pack.available(mode) and all(draws(s) for s in scenes) and any(fills(h) for h in hazards)
        self._around = [Surroundings(*row) for row in zip(scenes, specs, strict=True)] if filled else []
        self._parts: dict[str, Effects] = {
            name: maker.build(scenes, specs, world, mode, self._around) for name, maker in MAKERS.items() if name in present
        }
        self._lit = [[m for e in s.entities if e.name.startswith(PREFIX) for m in materials(e)] for s in scenes if draws(s)]
        self._air: list[tuple[float, float, float]] = []

    def light(self, air: list[tuple[float, float, float]]) -> None:
        """Let light fall on smoke, water, haze and what flies: linear red, green, blue, 1 by day, per scene; flames shine by themselves."""
        if air == self._air:
            return
        self._air = list(air)
        for row, colour in zip(self._lit, air, strict=True):
            for material in row:
                material.base_color = [*colour, 1.0]
        for around, colour in zip(self._around, air, strict=False):
            around.light(colour)

    def update(self, world: World, states: dict[str, Any], frame: Tensor) -> None:
        """Show the hazards' `states` at `frame` [E]; to be called before a picture is taken."""
        for name, part in self._parts.items():
            part.update(world, states[name], frame)
        for around in self._around:
            around.show()


__all__ = ["Effects", "FireEffects", "Looks", "shader_config"]
