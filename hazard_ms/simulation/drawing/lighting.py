"""Light of scenes: day, evening, night, lamps that fail during the episode, or one of these drawn by the seed.

Light never changes physics or labels. Lights are made when a scene is built. A picture then only sets their colours, as
a function of the seed and the frame: the same state gives the same pixels, and the random numbers come from a stream of
their own, so that no hazard is affected.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import sapien
import torch
from sapien.render import RenderBodyComponent
from torch import Tensor

from hazard_ms.assets.index import asset, asset_path
from hazard_ms.simulation.building import extent_of, lamp_places
from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.names import plain_name
from hazard_ms.spec import SceneSpec, Vec3
from hazard_ms.spec.checks import one_of

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


class Mood(NamedTuple):
    """The light of one kind of place at one time of the day.

    Colours are linear red, green and blue in SAPIEN's units. All values are [ours].
    """

    toward: Vec3  # direction in which the light of sun, moon or windows travels
    sun: Vec3
    lamp: Vec3  # of each lamp that is on
    lit: float  # share of the lamps that are on
    ambient: Vec3 = (0.0, 0.0, 0.0)
    pane: Vec3 = (0.0, 0.0, 0.0)  # light that shines through windows
    air: Vec3 = (1.0, 1.0, 1.0)  # light on haze, smoke, water and flying things, as a share of that of a bright day
    sky: str = ""  # asset of the sky that lights scenes in the open instead of `ambient`


INDOORS = {
    "day": Mood((0.4, 0.6, -1.0), (0.90, 0.87, 0.80), (2.0, 1.9, 1.7), 1.0, (0.45, 0.44, 0.42), (0.55, 0.70, 0.85)),
    "evening": Mood(
        (0.9, 0.5, -0.7),
        (0.30, 0.16, 0.07),
        (4.2, 2.8, 1.45),
        1.0,
        (0.20, 0.16, 0.13),
        (0.30, 0.16, 0.10),
        (0.60, 0.46, 0.36),
    ),
    "night": Mood(
        (0.3, -0.6, -1.0),
        (0.020, 0.030, 0.055),
        (0.75, 0.44, 0.20),
        0.5,
        (0.030, 0.034, 0.048),
        (0.008, 0.013, 0.030),
        (0.09, 0.08, 0.08),
    ),
    "failing": Mood(
        (0.3, -0.6, -1.0),
        (0.030, 0.040, 0.065),
        (3.6, 3.3, 2.8),
        1.0,
        (0.055, 0.058, 0.065),
        (0.008, 0.013, 0.030),
        (0.20, 0.19, 0.18),
    ),
}
DAYS = {  # in the open, by sky
    "sky_day": Mood((0.38, 0.55, -0.74), (2.9, 2.7, 2.3), (0.0, 0.0, 0.0), 0.0, sky="sky_day"),
    "sky_storm": Mood((0.44, 0.63, -0.64), (0.75, 0.78, 0.80), (0.0, 0.0, 0.0), 0.0, sky="sky_storm"),
}
EVENING = Mood(
    (0.98, -0.17, -0.30), (2.6, 1.6, 0.85), (8.0, 5.1, 2.4), 1.0, air=(0.95, 0.66, 0.48), sky="sky_evening"
)  # the sun stands a little higher than in the picture of the sky, so that shadows end
MOONLIGHT = (0.41, -0.58, -0.70), (0.045, 0.060, 0.100)  # `toward` and `sun` of clear nights [ours]
NIGHTS = {
    "night": Mood(*MOONLIGHT, (20.0, 12.8, 6.4), 1.0, air=(0.060, 0.066, 0.090), sky="sky_night"),
    "failing": Mood(*MOONLIGHT, (20.0, 16.8, 12.4), 1.0, air=(0.060, 0.066, 0.090), sky="sky_night"),
}


@dataclass
class _Lights:
    """The lights of one scene."""

    scene: sapien.Scene
    moods: dict[str, Mood]
    sun: Any  # RenderDirectionalLightComponent
    lamps: list[Any]  # RenderPointLightComponent
    panes: list[Any]  # RenderMaterial
    shown: tuple[str, tuple[float, ...]] | None = None

    def show(self, name: str, levels: tuple[float, ...]) -> None:
        """Switch to the light called `name`, with the lamps at `levels` from 0 to 1."""
        if (name, levels) == self.shown:
            return
        mood = self.moods[name]
        if self.shown is None or self.shown[0] != name:
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
        self.shown = (name, levels)


class Lighting:
    """The light in each of E scenes, made when the scenes are built."""

    def __init__(self, scene: Any, specs: tuple[SceneSpec, ...], mode: str = "day") -> None:
        """Make the light of `mode` (see LIGHTINGS) for the sub-scenes of ManiSkill's `scene`.

        Raises ValueError for an unknown mode.
        """
        self.mode = one_of(mode, LIGHTINGS, "lighting")
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
        names = self.chosen(seed)
        levels = self._failing(seed, frame)
        for lights, name, row in zip(self._lights, names, levels.tolist(), strict=True):
            lit = lights.moods[name].lit * len(lights.lamps)
            steady = tuple(float(k < lit) for k in range(len(lights.lamps)))
            lights.show(name, tuple(row[: len(lights.lamps)]) if name == "failing" else steady)

    def air(self) -> list[Vec3]:
        """Colour of the light on haze, smoke, water and flying things in each scene, as last shown; 1 by day."""
        return [lights.moods[lights.shown[0]].air for lights in self._lights if lights.shown is not None]

    def chosen(self, seed: Tensor) -> list[str]:
        """Names of the light that the episodes of `seed` [E] have."""
        if self.mode != "random":
            return [self.mode] * len(seed)
        return [
            DRAWN[int(u * len(DRAWN))]
            for u in self._uniform("lighting", seed, torch.zeros_like(seed), 1)[:, 0].tolist()
        ]

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


def moods_of(spec: SceneSpec) -> dict[str, Mood]:
    """Every light that the scene of `spec` can have, by name.

    In the open some days are bright and some stormy, depending on the scene's name.
    """
    if not spec.room.open_air:
        return INDOORS
    return {"day": list(DAYS.values())[zlib.crc32(spec.name.encode()) % len(DAYS)], "evening": EVENING, **NIGHTS}


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
