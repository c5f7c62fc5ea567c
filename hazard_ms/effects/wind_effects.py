"""What a wind carries past the camera, its haze, and foliage that sways, driven by the state of `hazard_ms.hazards.wind.Wind`.

Leaves, paper and streaks are three meshes per scene, blown along the heading by the mean speed; a gust makes more of them fly, and bends
trees and hedges more. Labels are those of trees at rest.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import sapien
from sapien.render import RenderMaterial, RenderShapeTriangleMesh
from torch import Tensor

from hazard_ms.effects import meshes, shader_pack
from hazard_ms.effects.entities import FRAMES_PER_SECOND, Effect, canvas, make_effect
from hazard_ms.effects.glsl import LEAF, PAPER, STREAK
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.effects.sway import foliage
from hazard_ms.effects.textures import noise_texture
from hazard_ms.effects.wind_glsl import BOX
from hazard_ms.hazards.wind import WindState
from hazard_ms.spec import SceneSpec
from hazard_ms.world import World

NUMBERS = {  # of each kind in a box of air, full and fast [ours]
    LEAF: (900, 450),
    PAPER: (50, 25),
    STREAK: (180, 90),
}
HALF = {LEAF: (0.042, 0.062), PAPER: (0.09, 0.125), STREAK: (0.007, 0.5)}  # width and height [m] [ours]
HIGHEST = {LEAF: 5.5, PAPER: 3.0, STREAK: 4.5}  # highest place [m] [ours]
USUAL = 0.6  # wind at which 63 % of all fly [m/s] [ours]
GUST = 0.17  # share of the mean wind of one standard deviation of gusts [physics.md 3.3]
HAZE = 0.008  # density of haze in a strong wind [1/m] [ours]


class _SceneWind:
    """The wind of one scene."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec, around: Surroundings, rich: bool) -> None:
        self._around = around
        texture = noise_texture()
        made = [make_effect(scene, texture, partial(flying, kind, NUMBERS[kind][0 if rich else 1]), kind) for kind in NUMBERS]
        self._parts: list[Effect] = [e for e in made if e is not None]
        self._foliage = foliage(scene, spec) if rich else None

    def show(self, heading: tuple[float, float], speed: float, gust: float, time: float) -> None:
        """A wind of `speed` [m/s] towards `heading`, a unit vector; `gust` in standard deviations."""
        strength = 1.0 - math.exp(-max(speed * (1.0 + GUST * gust), 0.0) / USUAL)
        half = math.atan2(heading[1], heading[0]) / 2
        drift = heading[0] * speed * time, heading[1] * speed * time
        self._around.haze(HAZE * strength, drift)
        for part in self._parts:
            part.show(sapien.Pose([*drift, time], [math.cos(half), 0.0, 0.0, math.sin(half)]), strength, time)
        if self._foliage is not None:
            self._foliage.show(sapien.Pose([heading[0] * strength, heading[1] * strength, time]), strength, time)


class WindEffects:
    """What a wind looks like, in each of E scenes."""

    def __init__(self, scenes: list[_SceneWind], mode: str, device: sapien.Device | None) -> None:
        self._scenes, self._mode, self._device = scenes, mode, device

    @classmethod
    def build(
        cls, scenes: list[sapien.Scene], specs: tuple[SceneSpec, ...], world: World, mode: str, around: list[Surroundings]
    ) -> WindEffects:
        """Effects of `mode` (full; fast: less flies, no clouds of dust, nothing sways; off) for `scenes` with the things of `specs`.

        Without a renderer, or with a SAPIEN whose shaders are unknown, nothing is shown.
        """
        device, shown = canvas(scenes, mode)
        if not shown:
            return cls([], mode, device)
        rows = zip(scenes, specs, around, strict=True)
        return cls([_SceneWind(scene, spec, air, mode == "full") for scene, spec, air in rows], mode, device)

    def update(self, world: World, wind: WindState, frame: Tensor) -> None:
        """Show `wind` at `frame` [E]. Call it before a picture is taken; it changes nothing but the picture."""
        if self._device is not None:
            shader_pack.keep_warm(self._mode, self._device)
        if not self._scenes:
            return
        heading, speed, gust, time = (t.cpu().tolist() for t in (wind.heading, wind.speed, wind.gust, frame / FRAMES_PER_SECOND))
        for e, scene in enumerate(self._scenes):
            scene.show(heading[e], speed[e], gust[e], time[e])


def flying(kind: int, count: int, material: RenderMaterial) -> RenderShapeTriangleMesh:
    """`count` quads of `kind`, spread over a box of air, more of them near the ground."""
    draw = np.random.default_rng(kind)  # the same air in every scene
    place = draw.random((count, 3)) * [BOX, BOX, 1.0]
    place[:, 2] = 0.03 + HIGHEST[kind] * place[:, 2] ** 2.2
    sizes = np.array(HALF[kind]) * (0.65 + 0.7 * draw.random((count, 1)))
    seeds = np.arange(1, count + 1) * meshes.GOLDEN % 1
    return meshes.quads(place, sizes, np.full(count, kind), seeds, material)
