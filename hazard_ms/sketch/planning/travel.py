"""Walks between the start, the targets and the carts, in frames, when targets rest and when they move."""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_left
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Spot = tuple[int, int]  # a node and the index of the recorded frame at which it was there; 0 for what rests
Walk = Callable[[NDArray, NDArray], NDArray]  # positions [..., D] twice -> frames [...]
SEGMENTS = 24  # pieces of a recording between which the least walks are estimated [ours]
SAMPLES = 3  # positions of each target in the check of a walk's frames [ours]
TOLERANCE = 1e-6  # rounding in checks of a walk [frames]


class Travel(ABC):
    """Frames that walks take between nodes: the targets from 0 on, then the carts, then the start."""

    def __init__(self, targets: int, carts: int, early_is_best: bool) -> None:
        """`early_is_best`: whether nothing is ever lost by meeting a target as early as possible."""
        self.targets, self.carts, self.early_is_best = targets, carts, early_is_best
        self.start: Spot = (targets + carts, 0)

    @abstractmethod
    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """The earliest frame at which each of `targets` can be met after `frame`, and where; inf for never.

        Waiting is allowed, so leaving later never means meeting earlier.
        """

    @abstractmethod
    def to_carts(self, spot: Spot) -> list[float]:
        """Frames from a spot to each cart, [C]."""

    @abstractmethod
    def least_entries(self) -> NDArray[np.float64]:
        """Least frames of the walk to each target from wherever the rescue before it can end, [M]."""

    @abstractmethod
    def least_exits(self) -> NDArray[np.float64]:
        """Least frames of the walk from each target to each cart, [M, C]."""


class StaticTravel(Travel):
    """Frames between nodes that rest: a table, which need be neither symmetric nor obey the triangle inequality."""

    def __init__(self, frames: ArrayLike, carts: int = 0) -> None:
        """`frames`: from the node of the row to that of the column, [N, N], with the start last; inf: no way.

        Raises ValueError for another shape, for more `carts` than nodes, and for frames that are negative or NaN.
        """
        table = np.array(frames, np.float64)
        if table.ndim != 2 or table.shape[0] != table.shape[1] or not 0 <= carts < len(table):
            raise ValueError(
                f"frames must have shape (N, N) for targets, {carts} carts and the start, got {table.shape}"
            )
        refuse_unless_frames(table, "frames")
        super().__init__(len(table) - carts - 1, carts, early_is_best=True)
        self._table, self._rows = table, table.tolist()

    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """The earliest frame at which each of `targets` can be met after `frame`, and where; inf for never."""
        row = self._rows[spot[0]]
        return [(frame + row[target], (target, 0)) for target in targets]

    def to_carts(self, spot: Spot) -> list[float]:
        """Frames from a spot to each cart, [C]."""
        return self._rows[spot[0]][self.targets : self.targets + self.carts]

    def starting(self, frames: ArrayLike, between: ArrayLike | None = None) -> StaticTravel:
        """The same travel from another start, from which ways to the targets and carts take `frames`, [M + C].

        `between`: frames of ways among these, [M + C, M + C], if they are others now. Raises ValueError for another
        number of frames.
        """
        row = np.array(frames, np.float64)
        if row.shape != (len(self._table) - 1,):
            raise ValueError(f"frames must have shape ({len(self._table) - 1},), got {row.shape}")
        table = self._table.copy()
        if between is not None:
            table[:-1, :-1] = between
        table[-1], table[:, -1] = [*row, 0.0], np.inf  # nobody goes back to a start
        return StaticTravel(table, self.carts)

    def least_entries(self) -> NDArray[np.float64]:
        """Least frames of the walk to each target from wherever the rescue before it can end, [M]."""
        table = self._table.copy()
        np.fill_diagonal(table, np.inf)
        ends = table[self.targets :] if self.carts else table
        return ends[:, : self.targets].min(axis=0)

    def least_exits(self) -> NDArray[np.float64]:
        """Least frames of the walk from each target to each cart, [M, C]."""
        return self._table[: self.targets, self.targets : -1]


class MovingTravel(Travel):
    """Frames between a start and carts that rest and targets whose positions were recorded or predicted.

    A target is met at a recorded frame. After the last one it rests.
    """

    def __init__(
        self, frames: ArrayLike, positions: ArrayLike, start: ArrayLike, walk: Walk, carts: ArrayLike = ()
    ) -> None:
        """`positions` of targets [m], [K, M, D], at `frames` [K]; `start` [D] and `carts` [C, D] in the same axes.

        `walk` gives the frames between two arrays of positions, [...]. To meet targets as early as possible is known to
        be best if a sample of it is symmetric and obeys the triangle inequality, and no target outruns it: else it may
        be better to await one nearer to what follows. Raises ValueError for other shapes, for frames that do not
        increase, and for what is not finite; `walk` may give inf for no way.
        """
        self._frames, self._positions = np.array(frames, np.float64), np.array(positions, np.float64)
        if self._frames.ndim != 1 or not len(self._frames) or not (np.diff(self._frames) > 0).all():
            raise ValueError(f"frames must be a list of increasing numbers, got {str(frames):.80}")
        count, size = len(self._frames), self._positions.shape[-1] if self._positions.ndim == 3 else 0
        if self._positions.ndim != 3 or len(self._positions) != count:
            raise ValueError(f"positions must have shape ({count}, M, D), got {self._positions.shape}")
        rest, here = np.array(carts, np.float64), np.array(start, np.float64)
        if here.shape != (size,):
            raise ValueError(f"start must have shape ({size},), got {here.shape}")
        if rest.size and rest.shape != (len(rest), size):
            raise ValueError(f"carts must have shape (C, {size}), got {rest.shape}")
        self._fixed = np.stack([*rest, here])
        for name, value in (("frames", self._frames), ("positions", self._positions), ("start or carts", self._fixed)):
            if not np.isfinite(value).all():
                raise ValueError(f"{name} must hold finite numbers, got {value[~np.isfinite(value)][0]}")
        self._walk = walk
        self._metric = self._is_metric()
        super().__init__(self._positions.shape[1], len(rest), self._metric and self._can_be_followed())
        self._listed = self._frames.tolist()
        self._departures: dict[int, list[list[float]]] = {}  # of fixed nodes: the latest for each target and frame
        self._exits = self._walk(self._positions[:, :, None], self._fixed[:-1])  # [K, M, C]
        self._exit_rows = self._exits.tolist()

    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """The earliest frame at which each of `targets` can be met after `frame`, and where; inf for never."""
        if spot[0] >= self.targets:
            rows = self._latest_departures(spot[0])
            indices = [bisect_left(rows[target], frame) for target in targets]
        else:
            indices = self._first_meetings(spot, frame, targets)
        last = len(self._listed) - 1
        return [
            (self._listed[index], (target, index)) if index <= last else self._at_rest(spot, frame, target, last)
            for target, index in zip(targets, indices, strict=True)
        ]

    def _first_meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[int]:
        """The index of the recorded frame at which each target can be met; their number where there is none."""
        first, count = bisect_left(self._listed, frame), len(self._listed)
        if first == count:
            return [count] * len(targets)
        leave = self._frames[first:, None] - self._walk(self._position(spot), self._positions[first:, targets])
        in_time = leave >= frame
        return np.where(in_time.any(axis=0), first + in_time.argmax(axis=0), count).tolist()

    def _at_rest(self, spot: Spot, frame: float, target: int, last: int) -> tuple[float, Spot]:
        way = float(self._walk(self._position(spot), self._positions[last, target]))
        return frame + way, (target, last)

    def _latest_departures(self, node: int) -> list[list[float]]:
        """The latest frame at which to leave a fixed node for meeting a target at a recorded frame or before."""
        if node not in self._departures:
            leave = self._frames[:, None] - self._walk(self._fixed[node - self.targets], self._positions)
            self._departures[node] = np.maximum.accumulate(leave, axis=0).T.tolist()
        return self._departures[node]

    def _position(self, spot: Spot) -> NDArray[np.float64]:
        node, index = spot
        return self._positions[index, node] if node < self.targets else self._fixed[node - self.targets]

    def to_carts(self, spot: Spot) -> list[float]:
        """Frames from a spot to each cart, [C]."""
        if spot[0] >= self.targets:
            return self._walk(self._position(spot), self._fixed[:-1]).tolist()
        return self._exit_rows[spot[1]][spot[0]]

    def least_entries(self) -> NDArray[np.float64]:
        """Least frames of the walk to each target from wherever the rescue before it can end, [M]."""
        least = self._walk(self._fixed, self._positions[:, :, None]).min(axis=(0, 2))
        if self.carts:
            return least
        return np.minimum(least, self._least_between().min(axis=0, initial=np.inf))

    def _least_between(self) -> NDArray[np.float64]:
        """At most the least walk from each target at a time to each other one at that time or later, [M, M].

        It is that between the middles of pieces of the recording, less how far targets are from there within a piece.
        """
        if not self._metric:
            return np.zeros((self.targets, self.targets))
        pieces = np.array_split(np.arange(len(self._frames)), min(SEGMENTS, len(self._frames)))
        middles = self._positions[[piece[len(piece) // 2] for piece in pieces]]  # [S, M, D]
        off = [self._walk(self._positions[p], middle).max(axis=0) for p, middle in zip(pieces, middles, strict=True)]
        early, late = np.triu_indices(len(pieces))
        spare = np.stack(off)[early, :, None] + np.stack(off)[late, None]  # [pairs of pieces, M, M]
        way = self._walk(middles[early, :, None], middles[late, None])
        least = np.where(spare < way, way - np.where(spare < way, spare, 0.0), 0.0).min(axis=0)
        np.fill_diagonal(least, np.inf)
        return least

    def least_exits(self) -> NDArray[np.float64]:
        """Least frames of the walk from each target to each cart, [M, C]."""
        return self._exits.min(axis=0)

    def _can_be_followed(self) -> bool:
        """Whether a walk keeps up with every target."""
        steps = self._walk(self._positions[:-1], self._positions[1:])
        return bool((steps <= np.diff(self._frames)[:, None] + TOLERANCE).all())

    def _is_metric(self) -> bool:
        """Whether the frames between samples of all spots are symmetric and no detour is shorter."""
        times = np.linspace(0, len(self._frames) - 1, min(SAMPLES, len(self._frames))).astype(int)
        spots = np.concatenate([self._fixed, self._positions[times].reshape(-1, self._fixed.shape[1])])
        way = np.asarray(self._walk(spots[:, None], spots[None]))
        if way.shape != (len(spots), len(spots)):
            raise ValueError(f"walk must return frames of shape {(len(spots), len(spots))} here, got {way.shape}")
        refuse_unless_frames(way, "walk")
        detour = (way[:, :, None] + way[None]).min(axis=1)
        return bool(np.allclose(way, way.T, atol=TOLERANCE) and (way <= detour + TOLERANCE).all())


def straight_line(frames_per_metre: float) -> Walk:
    """A walk without obstacles and turns: frames [...] between positions [m], [..., D]."""

    def walk(start: NDArray, end: NDArray) -> NDArray:
        return frames_per_metre * np.sqrt(((end - start) ** 2).sum(axis=-1))

    return walk


def refuse_unless_frames(value: NDArray[np.float64], name: str) -> None:
    """Check numbers of frames, [...]. Raises ValueError for negative ones and NaN."""
    if not (value >= 0).all():
        raise ValueError(f"{name} must hold numbers of frames of at least 0, got {value[~(value >= 0)][0]}")
