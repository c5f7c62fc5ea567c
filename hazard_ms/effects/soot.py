"""Soot on walls and ceiling above what burns, and how much of it settles on furniture.

The amount is a function of how long each place has burnt, so it only grows, and the same state gives the same stains.
One small texture per scene holds it as a map of the room; thin quads before walls and ceiling show it, drawn into the
picture alone. See SOOT_FRAG in shaders/soot.py.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import partial

import numpy as np
import sapien
from sapien.render import RenderMaterial, RenderShapeTriangleMesh, RenderTexture2D

from hazard_ms.effects.entities import PREFIX, Effect, make_effect
from hazard_ms.effects.shaders.common import SOOT
from hazard_ms.effects.textures import noise
from hazard_ms.simulation.building import wall_pieces
from hazard_ms.spec import Room

MAP_SIDE = 64  # of the map [texels]
EVERY = 30  # frames from one state of the map to the next
TIME = 700.0  # frames of one burning cell of floor that blacken what is right above it by 63 % [ours]
# widths of the stain above one cell [m], and their weights: the plume, and the smoke below the ceiling [ours]
SPREADS = ((0.45, 1.0), (1.5, 0.10))
SHEET = PREFIX + "soot_"  # of the names of the quads' entities
APART = 0.006  # of the quads from what they blacken [m]
LARGEST = 2.0  # edge of a quad [m]
FAINT = 0.03  # amount that is not shown

Array = np.ndarray
Quad = list[list[float]]  # four corners [m]


class Soot:
    """The soot of one scene."""

    def __init__(self, scene: sapien.Scene, room: Room) -> None:
        self._extent, self._height = max(room.size), room.height
        self._at = (np.arange(MAP_SIDE) + 0.5) / MAP_SIDE * self._extent  # of the map's texels [m]
        self._data = np.repeat((noise(MAP_SIDE, seed=3) * 255).astype(np.uint8)[..., None], 4, -1)
        self._data[..., 1] = 0
        self._texture = RenderTexture2D(self._data, "R8G8B8A8Unorm", mipmap_levels=1)
        self._known: tuple[bytes, ...] = ()
        self.amount = np.zeros((MAP_SIDE, MAP_SIDE))  # 0..1, [Y, X]
        self._sheets: list[tuple[Effect, slice, slice]] = []
        for number, quads in enumerate(_sheets(room)):
            corners = np.array(quads, np.float32)
            effect = make_effect(scene, self._texture, partial(_mesh, corners, self._extent), number)
            if effect is not None:
                effect.entity.name = f"{SHEET}{number}"
                self._sheets.append((effect, *self._part(corners)))

    def show(self, place: Array, burnt: Array, frame: int) -> None:
        """Show the soot above `place` [m], [F, 3], which have burnt for the frames `burnt`, [F], until `frame`."""
        late = frame % EVERY
        since = np.maximum(burnt - late, 0)
        sources = place[since > 0], since[since > 0]
        known = tuple(s.tobytes() for s in sources)
        if known != self._known:
            self._known = known
            self.amount = self._amount(*sources)
            self._data[..., 1] = (self.amount * 255 + 0.5).astype(np.uint8)
            self._texture.upload(self._data)
        for effect, rows, columns in self._sheets:
            if self.amount[rows, columns].max() > FAINT:
                effect.show(sapien.Pose(), self._height, 0.0)
            else:
                effect.hide()

    def above(self, place: Array) -> Array:
        """The amount of soot, 0..1, [N], right above `place` [m], [N, 3]."""
        x, y = (np.clip(place[:, k] / self._extent * MAP_SIDE, 0, MAP_SIDE - 1).astype(int) for k in (0, 1))
        return np.asarray(self.amount[y, x])

    def _amount(self, place: Array, burnt: Array) -> Array:
        total = np.zeros_like(self.amount)
        for width, weight in SPREADS:
            x, y = (np.exp(-0.5 * np.square((self._at - place[:, k, None]) / width)) for k in (0, 1))
            total += weight * (y * (burnt / TIME)[:, None]).T @ x
        return np.asarray(1.0 - np.exp(-total))

    def _part(self, corners: Array) -> tuple[slice, slice]:
        """The part of the map, rows and columns, below the quads `corners` [m], [Q, 4, 3]."""
        low, high = (f(corners[..., :2], (0, 1)) / self._extent * MAP_SIDE for f in (np.min, np.max))
        first = np.clip(low.astype(int) - 1, 0, MAP_SIDE - 1)
        last = np.clip(high.astype(int) + 2, 1, MAP_SIDE)
        return slice(first[1], last[1]), slice(first[0], last[0])


def _mesh(corners: Array, extent: float, material: RenderMaterial) -> RenderShapeTriangleMesh:
    """Quads, [Q, 4, 3] [m], as shaders/common.py wants them; `extent` of the map [m]."""
    points = corners.reshape(-1, 3)
    data = np.column_stack([points[:, :2], np.full(len(points), SOOT)]).astype(np.float32)
    places = np.column_stack([points[:, 2], np.full(len(points), extent)]).astype(np.float32)
    first = 4 * np.arange(len(corners))[:, None]
    faces = (first + np.array([[0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0]])).reshape(-1, 3).astype(np.uint32)  # both sides
    return RenderShapeTriangleMesh(np.zeros_like(points), faces, data, places, material)


def _sheets(room: Room) -> Iterator[list[Quad]]:
    """Quads before what soot settles on: each wall as one sheet, the ceiling as four."""
    if room.open_air:
        return
    for _, wall in itertools.groupby(wall_pieces(room), key=lambda piece: piece[0]):
        quads = [quad for _, centre, size in wall for quad in _faces(centre, size, room)]
        if quads:
            yield quads
    (x, y), z = room.size, room.height - APART
    for west, south in itertools.product((0.0, x / 2), (0.0, y / 2)):
        yield [
            [[a, c, z], [b, c, z], [b, d, z], [a, d, z]]
            for a, b in _cuts(west, west + x / 2)
            for c, d in _cuts(south, south + y / 2)
        ]


def _faces(centre: Array, size: Array, room: Room) -> Iterator[Quad]:
    """The faces of a piece of wall, [3] [m] each, that look into the room, in pieces."""
    across = int(np.argmin(size[:2]))  # the axis through the wall
    along = 1 - across
    low, high = (centre + side * size / 2 for side in (-1, 1))
    for at in (low[across] - APART, high[across] + APART):
        if not 0.0 < at < room.size[across]:
            continue
        for a, b in _cuts(max(low[along], 0.0), min(high[along], room.size[along])):
            quad = [[a, low[2]], [b, low[2]], [b, high[2]], [a, high[2]]]
            yield [[at, s, z] if across == 0 else [s, at, z] for s, z in quad]


def _cuts(low: float, high: float) -> Iterator[tuple[float, float]]:
    """Equal parts of an interval, none longer than LARGEST."""
    ends = np.linspace(low, high, max(1, math.ceil((high - low) / LARGEST)) + 1)
    yield from itertools.pairwise(ends.tolist())
