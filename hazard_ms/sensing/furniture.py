"""The true heights of what stays where it is: furniture and walls, as a map holds them after looks from everywhere.

They are taken from the models themselves, so only who may see what is hidden is told them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sapien.render import RenderBodyComponent, RenderShapeBox

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.building import partitions
from hazard_ms.spec import SceneSpec

Points = NDArray[np.float64]

SAMPLES = 4  # points of a surface along the edge of a cell of the map [ours]
JUST = 1e-3  # by which a cell may reach into an outer wall and count as free [m] [ours]
CORNERS = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])  # of a box, by its half
SIDES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))  # corners of its faces
FACES = np.array([face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))])  # [12, 3]


def told(seen: SemanticMap, spec: SceneSpec, fixtures: Iterable[Any]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """The heights [m] of all that stays in the scene `spec`, and which cells lie in it, [Y, X] each, as in `seen`.

    `fixtures`: their actors. Heights are those of the highest points below the map's ceiling; 0 where nothing stays.
    """
    y, x = np.mgrid[: len(seen.explored), : len(seen.explored)]
    centre, room = seen.centre_of(y, x), spec.room
    size, half = np.asarray(room.size), seen.cell / 2
    around = room.beyond + seen.cell
    within: NDArray[np.bool_] = np.all((centre > -around) & (centre < size + around), axis=-1)
    height: NDArray[np.float32] = np.zeros(within.shape, np.float32)
    if not room.open_air:
        walled = ((centre < half - JUST) | (centre > size - half + JUST)).any(-1)
        height[within & walled] = np.nextafter(np.float32(min(room.height, seen.ceiling)), np.float32(0.0))
    for triangles in (*map(_triangles, partitions(spec)), *(t for f in fixtures for t in _surfaces(f))):
        for points in _points(triangles, seen.cell / SAMPLES):
            column, row = np.floor((points[:, :2] - seen.origin) / seen.cell).astype(np.int64).T
            kept = (points[:, 2] < seen.ceiling) & (points[:, 2] > 0.0)
            kept &= (np.minimum(row, column) >= 0) & (np.maximum(row, column) < len(height))
            np.maximum.at(height, (row[kept], column[kept]), points[kept, 2].astype(np.float32))
    return height, within


def _triangles(box: tuple[Points, Points]) -> Points:
    """The surface of an upright box, given by its middle and its half size [m], [3] each: [12, 3, 3]."""
    middle, half = box
    return np.asarray((middle + CORNERS * half)[FACES])


def _surfaces(actor: Any) -> Iterator[Points]:
    """The surfaces of an actor as it is drawn, as triangles in the world [m], [T, 3, 3] each."""
    for entity in actor._objs:
        for shape in entity.find_component_by_type(RenderBodyComponent).render_shapes:
            pose = (entity.pose * shape.local_pose).to_transformation_matrix().astype(np.float64)
            if isinstance(shape, RenderShapeBox):
                drawn = [_triangles((np.zeros(3), np.asarray(shape.half_size, np.float64)))]
            else:
                drawn = [np.asarray(part.vertices * shape.scale, np.float64)[part.triangles] for part in shape.parts]
            for triangles in drawn:
                yield triangles @ pose[:3, :3].T + pose[:3, 3]


def _points(triangles: Points, spacing: float) -> Iterator[Points]:
    """Points of the surfaces of `triangles`, [T, 3, 3], at most `spacing` apart [m], [P, 3] in each part."""
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1).max(-1)
    parts = np.maximum(1, np.ceil(longest / spacing)).astype(np.int64)
    for number in np.unique(parts):
        a, b = np.mgrid[: number + 1, : number + 1]
        a, b = a[a + b <= number] / number, b[a + b <= number] / number
        share = np.stack([a, b, 1.0 - a - b], axis=-1)  # [P, 3]
        yield np.einsum("pc,tcx->tpx", share, triangles[parts == number]).reshape(-1, 3)
