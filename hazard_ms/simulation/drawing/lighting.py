"""Light of scenes: day, evening, night, lamps that fail during the episode, or one of these drawn by the seed.

Light never changes physics or labels. Lights are made when a scene is built. A picture then only sets their colours, as
a function of the seed and the frame: the same state gives the same pixels, and the random numbers come from a stream of
their own, so that no hazard is affected.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sapien
import torch
from sapien.render import RenderBodyComponent
from torch import Tensor

from hazard_ms.scenes.assets.index import asset, asset_path
from hazard_ms.scenes.solids import extent_of
from hazard_ms.simulation.building import lamp_places
from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.drawing import relighting
from hazard_ms.simulation.drawing.moods import Mood, moods_of
from hazard_ms.spec import SceneSpec, Vec3
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.names import plain_name

DRAWN = ("day", "evening", "night", "failing")  # what "random" chooses from
LIGHTINGS = (*DRAWN, "random")
LAMP_DROP = 0.4  # distance from the ceiling down to the lamps [m] [ours]
# category of the fixtures that shine, and the distance from their upper end down to their lamp [m] [ours]
STREET_LAMP, HEAD = "street_lamp", 0.60
MOST_LAMPS = 8  # lamps of a scene at most: SAPIEN's shaders take 10 point lights, and one belongs to the fire
FIRST_FAILURE, LAST_FAILURE = 60, 900  # frames between which a failing lamp goes out [ours]
UNSTEADY = 150  # frames for which a lamp flickers before it goes out [ours]
SHELL = "shell_"  # prefix of the names of floor, walls and windows
BLINK = 4  # frames for which a flickering lamp stays as it is: at 30 frames a second about 7 Hz [ours]
DIM = 0.15  # share of its light that a flickering lamp gives at its darkest [ours]


@dataclass
class _Lights:
    """The lights of one scene."""

    scene: sapien.Scene
    moods: dict[str, Mood]
    sun: Any  # RenderDirectionalLightComponent
    lamps: list[Any]  # RenderPointLightComponent
    panes: list[Any]  # RenderMaterial
    shown: tuple[Mood, tuple[float, ...]] | None = None

    def show(self, mood: Mood, levels: tuple[float, ...]) -> None:
        """Switch to the light `mood`, with the lamps at `levels` from 0 to 1."""
        if (mood, levels) == self.shown:
            return
        if self.shown is None or self.shown[0] != mood:
            self.scene.set_ambient_light(list(mood.ambient))
            self.sun.pose = sapien.Pose(
                [0.0, 0.0, 0.0], sapien.math.shortest_rotation([1.0, 0.0, 0.0], list(mood.toward))
            )
            self.sun.color = list(mood.sun)
            if mood.sky:
                self.scene.set_environment_map(_sky(mood.sky))
            for pane in self.panes:
                pane.emission = [*mood.pane, 1.0]
        for lamp, level in zip(self.lamps, levels, strict=True):
            lamp.color = [c * level for c in mood.lamp]
        self.shown = (mood, levels)


class Lighting:
    """The light in each of E scenes, made when the scenes are built."""

    def __init__(self, scene: Any, specs: tuple[SceneSpec, ...], mode: str = "day", level: int = 0) -> None:
        """Make the light of `mode` (see LIGHTINGS) for the sub-scenes of ManiSkill's `scene`.

        `level`: how far it is from that, by the seed (see `relighting`); 0: not at all.

        Raises ValueError for an unknown mode.
        """
        self.mode, self.level = one_of(mode, LIGHTINGS, "lighting"), level
        pairs = zip(scene.sub_scenes, specs, strict=True) if scene.can_render() else ()
        # beyond the reach of shadows, light would shine through the ceiling
        wide = max(float(np.hypot(*s.room.size)) for s in specs)
        self._lights = [_lights(sub, spec, wide) for sub, spec in pairs]
        self._chance = Chance(len(specs))
        self.show(torch.zeros(len(specs), dtype=torch.int64), torch.zeros(len(specs), dtype=torch.int64))

    def show(self, seed: Tensor, frame: Tensor) -> None:
        """Light the scenes as in the episodes of `seed` [E] at `frame` [E]; call it before a picture is taken."""
        if not self._lights:
            return
        seed, frame = seed.cpu(), frame.cpu()
        names, changes = self.chosen(seed), self.changes(seed)
        levels = self._failing(seed, frame)
        for lights, name, change, row in zip(self._lights, names, changes, levels.tolist(), strict=True):
            lit = lights.moods[name].lit * len(lights.lamps)
            steady = tuple(float(k < lit) for k in range(len(lights.lamps)))
            mood = lights.moods[name] if change is None else relighting.relit(lights.moods[name], change)
            lights.show(mood, tuple(row[: len(lights.lamps)]) if name == "failing" else steady)

    def air(self) -> list[Vec3]:
        """Colour of the light on haze, smoke, water and flying things in each scene, as last shown; 1 by day."""
        return [lights.shown[0].air for lights in self._lights if lights.shown is not None]

    def chosen(self, seed: Tensor) -> list[str]:
        """Names of the light that the episodes of `seed` [E] have."""
        if self.mode != "random":
            return [self.mode] * len(seed)
        return [
            DRAWN[int(u * len(DRAWN))]
            for u in self._uniform("lighting", seed, torch.zeros_like(seed), 1)[:, 0].tolist()
        ]

    def changes(self, seed: Tensor) -> list[relighting.Change | None]:
        """The difference of the light in the episodes of `seed` [E] from that of training; None where there is none."""
        if not self.level:
            return [None] * len(seed)
        numbers = self._uniform("perturbed lighting", seed, torch.zeros_like(seed), relighting.DRAWS)
        return [relighting.drawn(self.level, row) for row in numbers.tolist()]

    def _failing(self, seed: Tensor, frame: Tensor) -> Tensor:
        """Levels from 0 to 1 of lamps that fail, [E, MOST_LAMPS]: steady, then flickering, then dark."""
        start = torch.zeros_like(seed)
        out = FIRST_FAILURE + (LAST_FAILURE - FIRST_FAILURE) * self._uniform("lamp fails", seed, start, MOST_LAMPS)
        blink = self._uniform("lamp flickers", seed, torch.div(frame, BLINK, rounding_mode="floor"), MOST_LAMPS)
        left = out - frame[:, None]
        flicker = torch.where(blink < 0.5, DIM, blink)
        return torch.where(left > UNSTEADY, 1.0, torch.where(left > 0.0, flicker, 0.0))

    def _uniform(self, stream: str, seed: Tensor, frame: Tensor, count: int) -> Tensor:
        self._chance.seed, self._chance.frame = seed, frame
        return self._chance.uniform(stream, count)


def _lights(scene: sapien.Scene, spec: SceneSpec, wide: float) -> _Lights:
    """Add the lights of `spec` to `scene`, still dark; shadows reach `wide` [m]."""
    pixels = 2048 if spec.room.open_air else 1024
    sun = scene.add_directional_light([0, 0, -1], [0, 0, 0], shadow=True, shadow_scale=wide, shadow_map_size=pixels)
    lamps = [scene.add_point_light(list(p), [0, 0, 0]) for p in _lamps(spec)]
    shell = [e for e in scene.entities if plain_name(e.name).startswith(SHELL)]
    parts = [p for e in shell for s in e.find_component_by_type(RenderBodyComponent).render_shapes for p in s.parts]
    panes = [p.material for p in parts if any(p.material.emission[:3])]
    return _Lights(scene, moods_of(spec), sun, lamps, panes)


def _lamps(spec: SceneSpec) -> list[Vec3]:
    """Places of the lamps [m]: under the ceiling, or at the street lamps nearest to the middle."""
    x, y = spec.room.size
    if not spec.room.open_air:
        return [(a, b, spec.room.height - LAMP_DROP) for a, b in lamp_places(spec.room)][:MOST_LAMPS]
    posts = [f for f in spec.fixtures if f.category == STREET_LAMP]
    posts.sort(key=lambda f: (f.position[0] - x / 2) ** 2 + (f.position[1] - y / 2) ** 2)
    return [(*f.position[:2], f.position[2] + extent_of(f)[2] - HEAD) for f in posts[:MOST_LAMPS]]


@cache
def _sky(name: str) -> Any:
    """The light of a sky, as SAPIEN takes it; made once per process, since filtering it takes seconds on a CPU."""
    return sapien.render.RenderCubemap(str(asset_path(asset(name).visual)))
