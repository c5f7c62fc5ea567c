"""A mesh that grows quad by quad; its texture is the atlas of painting.py."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hazard_ms.effects.meshes import FACES

Array = np.ndarray
Point = tuple[float, float, float]
Cell = tuple[float, float, float, float]  # of an atlas: left, upper, right, lower, 0 to 1

CORNERS = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])  # lower left, lower right, upper right, upper left


class Frame(NamedTuple):
    """A place on the ground [m] and a turn [rad]: pieces face -y of their own frame."""

    x: float
    y: float
    turn: float = 0.0
    z: float = 0.0

    def at(self, points: Sequence[Sequence[float]] | Array) -> Array:
        """Points of this frame, [P, 3], in the world [m], [P, 3]."""
        p = np.asarray(points, float)
        c, s = math.cos(self.turn), math.sin(self.turn)
        return np.column_stack(
            [self.x + c * p[:, 0] - s * p[:, 1], self.y + s * p[:, 0] + c * p[:, 1], self.z + p[:, 2]]
        )

    def moved(self, x: float, y: float, turn: float = 0.0, z: float = 0.0) -> Frame:
        """The frame at x, y, z [m] of this one, turned by `turn` [rad]."""
        (px, py, pz) = self.at([(x, y, z)])[0]
        return Frame(float(px), float(py), self.turn + turn, float(pz))


class Mesh:
    """Quads with a texture. `loose`: how far the wind moves a corner [m]."""

    def __init__(self) -> None:
        self._vertices: list[Array] = []
        self._normals: list[Array] = []
        self._uvs: list[Array] = []

    def quad(
        self,
        frame: Frame,
        corners: Sequence[Sequence[float]],
        cell: Cell,
        loose: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
    ) -> None:
        """A quad: lower left, lower right, upper right, upper left as seen from its front [m]."""
        left, upper, right, lower = cell
        places = np.column_stack([left + (right - left) * CORNERS[:, 0], upper + (lower - upper) * CORNERS[:, 1]])
        self.shape(frame, corners, places, loose)

    def shape(
        self,
        frame: Frame,
        corners: Sequence[Sequence[float]],
        places: Sequence[Sequence[float]] | Array,
        loose: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
    ) -> None:
        """Four corners [m] in order around a flat shape, and their places in the atlas, [4, 2]."""
        points = frame.at(corners)
        across = np.cross(points[2] - points[0], points[3] - points[1])
        length = float(np.linalg.norm(across))
        normal = across / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
        self._vertices.append(points)
        self._normals.append(normal[None] * (1.0 + np.asarray(loose, float)[:, None]))
        self._uvs.append(np.asarray(places, float))

    def box(self, frame: Frame, low: Point, high: Point, side: Cell, top: Cell | None = None) -> None:
        """A box between two corners [m], without its underside."""
        (a, b, c), (d, e, f) = low, high
        for corners in (
            [(a, b, c), (d, b, c), (d, b, f), (a, b, f)],
            [(d, e, c), (a, e, c), (a, e, f), (d, e, f)],
            [(a, e, c), (a, b, c), (a, b, f), (a, e, f)],
            [(d, b, c), (d, e, c), (d, e, f), (d, b, f)],
        ):
            self.quad(frame, corners, side)
        self.quad(frame, [(a, b, f), (d, b, f), (d, e, f), (a, e, f)], top or side)

    def flat(self, frame: Frame, size: tuple[float, float], cell: Cell, height: float) -> None:
        """A rectangle on the ground around the frame's place, of a `size` [m]."""
        x, y = size[0] / 2, size[1] / 2
        self.quad(frame, [(-x, -y, height), (x, -y, height), (x, y, height), (-x, y, height)], cell)

    def __len__(self) -> int:
        return len(self._vertices)

    @property
    def vertices(self) -> Array:
        """All corners [m], [V, 3], world frame."""
        return np.concatenate(self._vertices) if self._vertices else np.zeros((0, 3))

    def arrays(self) -> tuple[Array, Array, Array, Array]:
        """Corners [m], [V, 3]; faces, [T, 3]; normals, [V, 3]; places in the atlas, [V, 2]."""
        count = len(self._vertices)
        faces = (FACES[None] + 4 * np.arange(count, dtype=np.uint32)[:, None, None]).reshape(-1, 3)
        return (
            self.vertices.astype(np.float32),
            faces.astype(np.uint32),
            np.concatenate(self._normals).astype(np.float32),
            np.concatenate(self._uvs).astype(np.float32),
        )
