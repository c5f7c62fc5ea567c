"""The space of a scene, which lies between a camera and what it sees: water, haze, a layer of smoke.

One small texture per scene tells it to the materials of everything solid, in the slot for transmission, which only ray
tracing reads; there its red, 0, says: none. Row 0 holds facts, the other rows a map of the room, south to north:

    fact 0   south-west corner of the map x, y [m], time [s]
    fact 1   size of the map x, y [m], height of the ceiling [m], 0 in the open
    fact 2   1 if there is water, density of haze [1/m], how far the wind has blown x [m]
    fact 3   height of the smoke's lower side [m], its density [1/m], how far the wind has blown y [m]
    fact 4   colour of haze, linear
    fact 5   density of the smoke below that side [1/m], 0, 0
    map      level of the water [m], light on the ceiling, 0

Hazards write what is theirs; `show` sends it to the renderer in one go. So any of them can meet in one scene.
"""

from __future__ import annotations

import math

import numpy as np
import sapien
from sapien.render import RenderTexture2D

from hazard_ms.effects.entities import solid_materials
from hazard_ms.simulation.building import lamp_places
from hazard_ms.spec import Room, SceneSpec

FACTS = 6  # texels of the texture's first row
MAP_CELL, FINE_CELL = 0.5, 0.06  # of the map; the finer one in rooms with partitions, less than their thickness [m]
DRY = -10.0  # level where there is no water, or further below [m]: linear filtering must not meet huge numbers
LAMP_WIDTH = 0.5  # of the bright spot on the ceiling above a lamp [m] [ours]
LAMP_LIGHT, CEILING_LIGHT = 2.2, 0.85  # in a mirror of water; 1 is white [ours]
HAZE_COLOUR = (0.55, 0.55, 0.53)  # linear RGB of dusty air [ours]


class Surroundings:
    """The water, haze and smoke of one scene, as one texture."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec) -> None:
        room = spec.room
        size = np.array(room.size) + 2 * room.beyond
        self.corner = np.array([-room.beyond, -room.beyond])
        cell = FINE_CELL if room.partitions else MAP_CELL
        wide, deep = (max(math.ceil(s / cell) + 1, FACTS) for s in size)
        x, y = (self.corner[k] + np.linspace(0.0, size[k], n) for k, n in enumerate((wide, deep)))
        self.places = np.stack(np.meshgrid(x, y), -1)  # of the map's cells [m], [Y, X, 2]
        self._data = np.zeros((deep + 1, wide, 4), np.float32)
        self._data[0, 0, 1:3], self._data[0, 1, 1:3] = self.corner, size
        self._data[0, 1, 3] = 0.0 if room.open_air else room.height
        self._data[0, 4, 1:] = HAZE_COLOUR
        self._data[1:, :, 1], self._data[1:, :, 2] = DRY, _ceiling(room, self.places)
        self.texture = RenderTexture2D(
            self._data, "R32G32B32A32Sfloat", mipmap_levels=1, filter_mode="linear", address_mode="edge"
        )
        for material in solid_materials(scene):
            material.transmission_texture = self.texture
            # a texture is only seen after a scalar has been set (SAPIEN 3.0.3)
            material.transmission = material.transmission
        self._sent = self._data.copy()

    def water(self, level: np.ndarray, time: float) -> None:
        """Set the level of the water [m], [Y, X], below 0 where it is dry, at `time` [s]."""
        wet = bool(level.max() > 0.0)
        self._data[0, 2, 1] = float(wet)
        self._data[0, 0, 3] = time if wet else 0.0
        self._data[1:, :, 1] = np.maximum(level, DRY) if wet else DRY

    def haze(self, density: float, drift: tuple[float, float]) -> None:
        """Set the density of the haze [1/m], and how far its clouds have drifted [m]."""
        self._data[0, 2, 2] = density
        self._data[0, 2:4, 3] = drift

    def smoke(self, height: float, density: float, below: float = 0.0) -> None:
        """Set the density of the smoke [1/m] above `height` [m], and `below` it."""
        self._data[0, 3, 1:3] = height, density
        self._data[0, 5, 1] = below

    def light(self, air: tuple[float, float, float]) -> None:
        """Set the light that falls on haze, water and things in the water: linear red, green, blue, 1 by day."""
        self._data[0, 4, 1:] = np.multiply(HAZE_COLOUR, air)

    def show(self, veiled: bool = True) -> None:
        """Send what has changed to the renderer; smoke and haze only if `veiled`."""
        if not veiled:
            self._data[0, 2, 2] = self._data[0, 3, 2] = 0.0
        if not np.array_equal(self._sent, self._data):
            self.texture.upload(self._data)
            self._sent[:] = self._data


def _ceiling(room: Room, places: np.ndarray) -> np.ndarray:
    """The brightness of the ceiling above `places` [m], [Y, X, 2]: [Y, X]."""
    light = np.full(places.shape[:2], CEILING_LIGHT)
    for lamp in () if room.open_air else lamp_places(room):
        apart = np.square(places - np.array(lamp)).sum(-1)
        light += LAMP_LIGHT * np.exp(-apart / (2.0 * LAMP_WIDTH**2))
    return light
