"""The sight of a robot's head camera in a scene, without a renderer.

A thing counts as seen where at least SEEN_PIXELS of its pixels would be in the image. Their number is estimated from
the solid angle of its box at the camera, and from the share of a few points of the box that are in the picture and
have a clear line to the camera. Lines are blocked by the boxes that furniture is made of (so one sees under a table
and between the boards of a shelf), by walls and by bodies. `./run python -m tests.sketch.sight_rates` compares this
with real looks.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hazard_ms.scenes.boxes import matrix_of
from hazard_ms.scenes.floor import partitions
from hazard_ms.scenes.solids import half_size, parts_of
from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.spec import Body, Fixture, SceneSpec

Floats = NDArray[np.floating]
Bools = NDArray[np.bool_]
Part = tuple[int, Floats, Floats, Floats]  # its thing, -1 for a wall; its middle and half size [m], its turn [3, 3]


@dataclass(frozen=True)
class Eye:
    """The head camera of a robot: a square image, looking ahead."""

    ahead: float  # of the base's middle [m]
    height: float  # above the floor [m]
    down: float  # how far below the horizon it looks [rad]
    fov: float = 2 * np.pi / 3  # horizontal and vertical field of view [rad], as robots.planar.HEAD_FOV
    pixels: int = 256  # of the image each way

    @property
    def focal(self) -> float:
        """The distance of the image from the camera, in pixels."""
        return float(self.pixels / 2 / np.tan(self.fov / 2))


FETCH = Eye(0.168, 1.101, 0.35)  # at rest [measured: tests/sketch/test_sight_long.py]
G1 = Eye(0.07, 1.215, np.pi / 6)
# points of a box whose lines to the camera are traced: its middle, and most of the way to each corner [half sizes]
PROBES = np.array([(0.0, 0.0, 0.0), *(0.9 * np.array(list(itertools.product((-1, 1), repeat=3))))], np.float32)
FILLED = 0.7  # share of a box's outline that the thing in it fills [measured by tests.sketch.sight_rates]
SEE_THROUGH = ("chair", "cart")  # backs with slats, and wire [measured: what is behind them was seen in real looks]
LAST = 0.01  # length of the end of a line that nothing blocks: things lie against what they stand on [m] [ours]
AT_ONCE = 1 << 17  # lines that are traced at once: more only take memory [ours]


class Sight:
    """The sight of one scene from anywhere in it; things are numbered as in the scene's `things`, along B."""

    def __init__(self, spec: SceneSpec, eye: Eye = FETCH, bodies: Iterable[str] | None = None) -> None:
        """Prepare the sight of a robot with the camera `eye` in `spec`.

        `bodies` names those that block the view where they are at the start: all but the targets where it is None.
        """
        self.eye = eye
        targets = {target.name for target in spec.targets}
        names = {body.name for body in spec.bodies} - targets if bodies is None else set(bodies)
        blocking = [n for n, t in enumerate(spec.things) if isinstance(t, Fixture) or t.name in names]
        blocking = [n for n in blocking if spec.things[n].category not in SEE_THROUGH]
        self._parts = [part for n in blocking for part in _parts(n, spec.things[n])]
        for wall in partitions(spec.room):
            middle, half = (wall.x, wall.y, (wall.low + wall.high) / 2), (wall.half_x, wall.half_y, wall.high / 2)
            self._parts.append((-1, _row(middle), _row(half) - _row((0, 0, wall.low / 2)), np.eye(3, dtype=np.float32)))
        self._turn = np.array([matrix_of(thing.rotation) for thing in spec.things], np.float32).reshape(-1, 3, 3)
        self._half = np.array([half_size(thing) for thing in spec.things], np.float32).reshape(-1, 3)
        upright = np.einsum("bij,bj->bi", self._turn, self._half * _row((0, 0, 1)))
        self._middle = np.array([t.position for t in spec.things], np.float32).reshape(-1, 3) + upright

    def visible(
        self, places: ArrayLike, heading: ArrayLike | None, things: ArrayLike, positions: ArrayLike | None = None
    ) -> Bools:
        """Whether a robot at `places` [m], [P, 2], sees `things`, numbers along B, [S]: [P, S].

        It has `heading` [rad], [P], and looks once; None: it looks all around. `positions` [m], [S, 3] or [P, S, 3]:
        the middles of the things' boxes; None: as at the start of the scene.
        """
        return self.pixels(places, heading, things, positions) >= SEEN_PIXELS

    def pixels(
        self, places: ArrayLike, heading: ArrayLike | None, things: ArrayLike, positions: ArrayLike | None = None
    ) -> Floats:
        """The approximate number of pixels of things in looks, [P, S]; without a `heading`, looking at each of them.

        Other arguments as for `visible`.
        """
        eyes, facing = self._eyes(places, heading)
        own = np.asarray(things, np.int64)
        middle = self._middle[own] if positions is None else np.asarray(positions, np.float32)
        middle = np.broadcast_to(middle, (len(eyes), len(own), 3))
        made = np.zeros((len(eyes), len(own)), np.float32)
        step = max(1, AT_ONCE // max(1, len(own) * len(PROBES)))
        for first in range(0, len(eyes), step):
            rows = slice(first, first + step)
            made[rows] = self._pixels(eyes[rows], None if facing is None else facing[rows], own, middle[rows])
        return made

    def _pixels(self, eyes: Floats, facing: Floats | None, own: NDArray[np.int64], middle: Floats) -> Floats:
        probes = np.einsum("sij,skj->ski", self._turn[own], PROBES * self._half[own, None])
        points = middle[:, :, None] + probes
        inside, _ = self._in_picture(eyes, facing, points)
        share = (inside & self._clear(eyes, points, own)).mean(axis=-1)
        _, cosine = self._in_picture(eyes, facing, middle[:, :, None])
        off = np.einsum("psi,sij->psj", middle - eyes[:, None], self._turn[own])  # in the frames of the boxes
        far = np.linalg.norm(off, axis=-1)
        faces = 4 * self._half[own][:, [1, 2, 0]] * self._half[own][:, [2, 0, 1]]
        angle = (np.abs(off) * faces).sum(axis=-1) / far**3  # [sr]
        return np.asarray(FILLED * share * angle * self.eye.focal**2 / cosine[..., 0] ** 3)

    def _in_picture(self, eyes: Floats, facing: Floats | None, points: Floats) -> tuple[Bools, Floats]:
        """Whether `points` [P, S, K, 3] are in the picture; the cosine of their angle from its middle, in the picture.

        Both [P, S, K]; `eyes` [P, 3], `facing` [P] or None for looking at each.
        """
        x, y, up = np.moveaxis(points - eyes[:, None, None], -1, 0)
        if facing is None:
            ahead, aside = np.hypot(x, y), np.zeros_like(x)
        else:
            cos, sin = np.cos(facing)[:, None, None], np.sin(facing)[:, None, None]
            ahead, aside = x * cos + y * sin, y * cos - x * sin
        cos, sin = np.cos(self.eye.down), np.sin(self.eye.down)
        depth, above = ahead * cos - up * sin, ahead * sin + up * cos
        most = np.tan(self.eye.fov / 2)
        inside = (depth > 0.0) & (np.abs(aside) <= most * depth) & (np.abs(above) <= most * depth)
        cosine = depth / np.maximum(np.sqrt(x**2 + y**2 + up**2), 1e-6)
        return inside, np.maximum(cosine, 1.0 / np.sqrt(1.0 + 2.0 * most**2)).astype(np.float32)

    def clear(self, places: ArrayLike, points: ArrayLike) -> Bools:
        """Whether nothing blocks the line from a robot's camera at `places` [m], [P, 2], to `points` [m], [S, 3].

        Returns [P, S]. The picture's edges play no part.
        """
        eyes, _ = self._eyes(places, None)
        goals = np.asarray(points, np.float32).reshape(1, -1, 1, 3)
        made = np.zeros((len(eyes), goals.shape[1]), bool)
        step = max(1, AT_ONCE // max(1, goals.shape[1]))
        for first in range(0, len(eyes), step):
            rows = slice(first, first + step)
            made[rows] = self._clear(eyes[rows], goals, np.full(goals.shape[1], -2))[..., 0]
        return made

    def _clear(self, eyes: Floats, points: Floats, own: NDArray[np.int64]) -> Bools:
        """Whether lines from `eyes` [P, 3] to `points` [P, S, K, 3] of the things `own` [S] are free, [P, S, K]."""
        lines = points - eyes[:, None, None]
        most = 1.0 - LAST / np.maximum(np.linalg.norm(lines, axis=-1), LAST)
        apart = np.linalg.norm(points - points[:, :, :1], axis=-1).max(axis=-1)
        free = np.ones(most.shape, bool)
        for thing, middle, half, turn in self._parts:
            reach = np.linalg.norm(np.abs(turn) @ half)
            row, of = np.nonzero((_passing(eyes, lines[:, :, 0], middle) < reach + apart) & (own != thing))
            if len(row):
                near, far = _crossing((eyes[row] - middle) @ turn, lines[row, of] @ turn, half)
                free[row, of] &= (near >= far) | (near <= 0.0) | (near >= most[row, of])
        return free

    def _eyes(self, places: ArrayLike, heading: ArrayLike | None) -> tuple[Floats, Floats | None]:
        """Where the camera is [m], [P, 3], and where it faces [rad], [P]; over the base's middle without a heading."""
        base: Floats = np.asarray(places, np.float32)
        if base.ndim != 2 or base.shape[1] != 2:
            raise ValueError(f"places must have shape [P, 2], got {list(base.shape)}")
        facing = None if heading is None else np.broadcast_to(np.asarray(heading, np.float32), (len(base),))
        if facing is not None:
            base = base + self.eye.ahead * np.stack([np.cos(facing), np.sin(facing)], axis=-1)
        height = np.full((len(base), 1), self.eye.height, np.float32)
        return np.concatenate([base, height], axis=1).astype(np.float32), facing


def _passing(start: Floats, line: Floats, point: Floats) -> Floats:
    """Distances [m], [P, S], at which lines from `start` [P, 3], as long as `line` [P, S, 3], pass a `point` [3]."""
    off = (point - start)[:, None]
    share = (off * line).sum(axis=-1) / np.maximum((line**2).sum(axis=-1), LAST**2)
    return np.asarray(np.linalg.norm(off - share.clip(0.0, 1.0)[..., None] * line, axis=-1))


def _crossing(start: Floats, line: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Where lines enter and leave a box around the origin, as shares of their length; where they miss it, in > out.

    `start` [P, 3], `line` [P, K, 3], `half`: half size of the box, [3], all in its frame and in metres. [P, K] each.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        one, two = (-half - start[:, None]) / line, (half - start[:, None]) / line
    return np.minimum(one, two).max(axis=-1), np.maximum(one, two).min(axis=-1)


def _row(values: Iterable[float]) -> Floats:
    return np.array(list(values), np.float32)


def _parts(number: int, thing: Body | Fixture) -> Iterator[Part]:
    turn = matrix_of(thing.rotation).astype(np.float32)
    for middle, half in parts_of(thing):
        yield number, _row(middle), _row(half), turn
