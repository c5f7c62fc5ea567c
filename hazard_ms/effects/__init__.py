"""How hazards look. Pictures only: nothing here changes physics, chance or labels."""

from __future__ import annotations

from typing import Any, Protocol

import sapien
from torch import Tensor

from hazard_ms.effects.fire_effects import FireEffects
from hazard_ms.effects.shader_pack import shader_config
from hazard_ms.hazards.base import Hazard
from hazard_ms.spec import SceneSpec
from hazard_ms.world import World


class Effects(Protocol):
    """What one hazard looks like, in each of E scenes. Made when the scenes are built, never shared."""

    def update(self, world: World, state: Any, frame: Tensor) -> None:
        """Show `world` and the hazard's `state` at `frame` [E]: same input, same pixels. It changes nothing but the picture."""


MAKERS: dict[str, Any] = {"fire": FireEffects}  # by the name of the hazard


class Looks:
    """What all hazards of a task look like together."""

    def __init__(
        self, hazards: tuple[Hazard, ...], scenes: list[sapien.Scene], specs: tuple[SceneSpec, ...], world: World, mode: str
    ) -> None:
        """Effects of `mode` (full, fast, off) for `scenes` in which the things of `specs` stand."""
        self._parts: dict[str, Effects] = {h.name: MAKERS[h.name].build(scenes, specs, world, mode) for h in hazards if h.name in MAKERS}

    def update(self, world: World, states: dict[str, Any], frame: Tensor) -> None:
        """Show the hazards' `states` at `frame` [E]; to be called before a picture is taken."""
        for name, part in self._parts.items():
            part.update(world, states[name], frame)


__all__ = ["Effects", "FireEffects", "Looks", "shader_config"]
