"""The effects of a wind: things that fly past the camera, haze, and foliage that sways, all driven by its state.

Leaves, paper and streaks are three meshes per scene, blown along the heading by the mean speed; a gust makes more of
them fly, and bends trees and hedges more. Where a gust front comes, they fly as soon as it is anywhere near. Labels are
those of trees at rest.
"""

from __future__ import annotations

import math
from functools import partial
from typing import ClassVar

import numpy as np
import sapien
from sapien.render import RenderMaterial, RenderShapeTriangleMesh
from torch import Tensor

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import FRAMES_PER_SECOND, Effect, make_effect
from hazard_ms.effects.scene_effects import Place, SceneEffects
from hazard_ms.effects.shaders.common import LEAF, PAPER, STREAK
from hazard_ms.effects.shaders.wind import BOX
from hazard_ms.effects.streets.street import Breeze
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.effects.sway import foliage
from hazard_ms.effects.textures import noise_texture
from hazard_ms.hazards.wind.gale_state import GaleState
from hazard_ms.hazards.wind.wind_state import WindState
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec

NUMBERS = {  # of each kind in a box of air, full and fast [ours]
    LEAF: (1100, 550),
    PAPER: (50, 25),
    STREAK: (180, 90),
}
HALF_SIZES = {LEAF: (0.042, 0.062), PAPER: (0.09, 0.125), STREAK: (0.007, 0.5)}  # width and height [m] [ours]
MOST_HEIGHTS = {LEAF: 5.5, PAPER: 3.0, STREAK: 4.5}  # highest place [m] [ours]
USUAL_SPEED = 0.6  # wind at which 63 % of all fly [m/s] [ours]
GUST_SHARE = 0.17  # share of the mean wind of one standard deviation of gusts [docs/physics.md 3.3]
HAZE_DENSITY = 0.008  # density of haze in a strong wind [1/m] [ours]


class _SceneWind:
    """The wind of one scene."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec, around: Surroundings, rich: bool) -> None:
        self._around = around
        texture = noise_texture()
        made = [
            make_effect(scene, texture, partial(flying, kind, NUMBERS[kind][0 if rich else 1]), kind)
            for kind in NUMBERS
        ]
        self._parts: list[Effect] = [e for e in made if e is not None]
        self._foliage = foliage(scene, spec) if rich else None
        self._breeze = Breeze(scene)

    def show(
        self, heading: tuple[float, float], speed: float, gust: float, time: float, drift: tuple[float, float]
    ) -> None:
        """Show a wind of `speed` [m/s] towards `heading`, a unit vector, that has come by `drift` [m] in `time` [s].

        `gust` in standard deviations.
        """
        strength = 1.0 - math.exp(-max(speed * (1.0 + GUST_SHARE * gust), 0.0) / USUAL_SPEED)
        half = math.atan2(heading[1], heading[0]) / 2
        self._around.haze(HAZE_DENSITY * strength, drift)
        for part in self._parts:
            part.show(sapien.Pose([*drift, time], [math.cos(half), 0.0, 0.0, math.sin(half)]), strength, time)
        told = sapien.Pose([heading[0] * strength, heading[1] * strength, time])
        self._breeze.show(told)
        if self._foliage is not None:
            self._foliage.show(told, strength, time)


class WindEffects(SceneEffects):
    """The effects of a wind in each of E scenes. In the mode `fast` less flies, and nothing sways."""

    layer: ClassVar[int] = 2

    @classmethod
    def of_scene(cls, place: Place) -> _SceneWind:
        assert place.around is not None  # a wind fills the space of its scene with haze
        return _SceneWind(place.scene, place.spec, place.around, place.rich)

    def show(self, world: World, wind: WindState, frame: Tensor) -> None:
        heading, speed, gust, time = (
            t.cpu().tolist() for t in (wind.heading, wind.speed, wind.gust, frame / FRAMES_PER_SECOND)
        )
        for e, scene in enumerate(self._scenes):
            drift = heading[e][0] * speed[e] * time[e], heading[e][1] * speed[e] * time[e]
            if isinstance(wind, GaleState):  # what flies shows that a front is coming
                east, north = wind.blown[e].tolist()
                drift, speed[e] = (east, north), float(wind.lifted[e])
            scene.show(heading[e], speed[e], gust[e], time[e], drift)


def flying(kind: int, count: int, material: RenderMaterial) -> RenderShapeTriangleMesh:
    """A mesh of `count` quads of `kind`, spread over a box of air, more of them near the ground."""
    draw = np.random.default_rng(kind)  # the same air in every scene
    place = draw.random((count, 3)) * [BOX, BOX, 1.0]
    place[:, 2] = 0.03 + MOST_HEIGHTS[kind] * place[:, 2] ** 2.2
    sizes = np.array(HALF_SIZES[kind]) * (0.65 + 0.7 * draw.random((count, 1)))
    seeds = np.arange(1, count + 1) * meshes.GOLDEN % 1
    return meshes.quads(place, sizes, np.full(count, kind), seeds, material)
