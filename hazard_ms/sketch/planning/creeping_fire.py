"""Futures of a fire that creeps over the floor, drawn from its law, and the flames behind temperatures that were seen.

The law is that of docs/physics.md 1.1, the rules of the challenge, which every agent may know. Chance is drawn anew
for each future. Times step by STEP frames, in which things heat up twice.

    temperature seen at a point   T = (20 + 600 F + sum of w T of things) / (1 + F + sum of w of things)
    so the weight of the flames   F = ((T - 20) + sum of w (T - T of things)) / (600 - T),  w = (0.5 / max(d, 0.5))^2
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Clear = Callable[[Array, Array], Mask]  # whether heat gets from sources [m], [M, 3], to points, [P, 3]: [P, M]
# The rules: tests compare these numbers with those of `hazard_ms.hazards.fire` (docs/physics.md 1.1)
ROOM, FLAME = 20.0, 600.0  # temperatures of the room, and of flames and burning things [C]
REACH = 0.5  # distance at which a source weighs as much as the room, and nearer ones no more [m]
KEPT = (1 - 0.03) ** 2  # share of the difference to the surroundings that is left after STEP frames
CELL = 0.22  # distance between neighbouring cells [m]
STEP = 10  # frames between attempts of a flame to spread
GROWN = 140  # age from which a flame makes attempts [frames]
FIRST_CHANCE = 0.02  # probability of an attempt up to the younger of AGES
AGES = (150, 250)  # frames since the last success between which the probability rises to 1
WAYS = ((0, 1), (0, -1), (1, 0), (-1, 0))  # the neighbours of a cell, along y and x

FARTHEST = 10  # most cells that a fire creeps in an episode, and room around the flames that were seen
FAINT = 0.15  # weight of flames at a point below which it tells nothing of where they are [ours]
NEVER = 1e9  # a frame that does not come


@dataclass(frozen=True)
class Things:
    """Things that heat up: bodies at rest, and sources of heat once they burn."""

    base: Array  # middles of their bases [m], [M, 3]
    temperature: Array  # [C], [M]; FLAME for those that burn
    threshold: Array  # temperature at which each catches fire [C], [M]; inf for never
    whole_at: Array | None = None  # frame in which each was seen whole, [M]: it has not caught fire before


@dataclass(frozen=True)
class Flames:
    """The cells of a floor, and how likely each is to burn."""

    corner: Array  # middle of the cell 0, 0 [m], [2]
    chance: Array  # probability that a cell burns, [Y, X]
    free: Mask  # whether it can burn, [Y, X]
    since: Array | None = None  # frame in which it was seen to burn, [Y, X]; None: all when futures start

    @property
    def places(self) -> Array:
        """Middles of the cells [m], [Y X, 3]."""
        y, x = np.divmod(np.arange(self.chance.size), self.chance.shape[1])
        return np.column_stack([self.corner + CELL * np.stack([x, y], axis=-1), np.zeros(len(x))])


def weights(points: Array, sources: Array, clear: Clear | None = None) -> Array:
    """Weights of `sources` [m], [M, 3], at `points` [m], [P, 3]: [P, M]; the room's is 1.

    `clear` tells where no wall is in between: nothing counts behind one. None: there are no walls.
    """
    apart = ((points[:, None] - sources[None]) ** 2).sum(axis=-1)
    made = REACH**2 / np.maximum(apart, REACH**2)
    return made if clear is None else np.where(clear(points, sources), made, 0.0)


def flame_weight(points: Array, temperatures: Array, things: Things, clear: Clear | None = None) -> Array:
    """The weight of all flames, [P], at `points` [m], [P, 3], that shows in the `temperatures` [C] seen there, [P]."""
    of_things = weights(points, things.base, clear)
    seen = np.clip(temperatures, ROOM, FLAME - 1.0)
    excess = (seen - ROOM) + (of_things * (seen[:, None] - things.temperature)).sum(axis=-1)
    return np.maximum(excess, 0.0) / (FLAME - seen)


def found(
    points: Array,
    temperatures: Array,
    things: Things,
    blocked: Array,
    farthest: int = FARTHEST,
    clear: Clear | None = None,
) -> Flames | None:
    """The flames behind `temperatures` [C], [P], seen at `points` on the floor [m], [P, 3]; None where there are none.

    `blocked` [m], [Q, 2]: places of furniture and walls, on which nothing creeps; `farthest`: cells that a fire creeps
    at most; `clear`: see `weights`.
    """
    weight = flame_weight(points, temperatures, things, clear)
    near = weight >= 0.8  # of a single flame at REACH it is 1
    if not near.any():
        return None
    low = points[near, :2].min(axis=0) - CELL * farthest
    size = np.ceil((points[near, :2].max(axis=0) + CELL * farthest - low) / CELL).astype(int) + 1
    flames = Flames(low, np.zeros(size[::-1]), np.ones(size[::-1], bool))
    cells = np.rint((blocked - low) / CELL).astype(int)
    inside = ((cells >= 0) & (cells < size)).all(axis=-1)
    flames.free[cells[inside, 1], cells[inside, 0]] = False
    places = flames.places
    candidates = np.flatnonzero(weights(points[near], places).max(axis=0) >= 1.0)
    told = np.flatnonzero(weight >= FAINT)
    share, _ = nnls(weights(points[told], places[candidates], clear), weight[told], maxiter=30 * len(candidates))
    flames.chance.ravel()[candidates] = np.minimum(share, 1.0)
    return flames


def burning_from(
    flames: Flames,
    things: Things,
    start: float,
    end: float,
    futures: int,
    chance: np.random.Generator,
    clear: Clear | None = None,
) -> Array:
    """The frame at which each of M `things` catches fire in each of N `futures`, [N, M]; inf where it does not.

    The flames are those of the frame `start`, and later ones those of their own; what burns by then has that frame.
    Nothing is foreseen beyond `end`. `clear`: see `weights`.
    """
    shape = (futures, *flames.chance.shape)
    lit = chance.random(shape) < flames.chance
    since = start if flames.since is None else flames.since
    birth = np.where(lit, since - GROWN, NEVER)
    last = np.where(lit, since - chance.random(shape) * AGES[0], NEVER)
    used = np.stack([_from(lit, way) for way in WAYS]) & lit
    floor = weights(flames.places, things.base, clear)
    between = weights(things.base, things.base, clear)
    np.fill_diagonal(between, 0.0)
    around = 1.0 + between.sum(axis=0)
    temperature = np.tile(things.temperature, (futures, 1))
    caught = np.where(temperature >= FLAME, start, np.inf)
    for frame in np.arange(start + STEP, end + STEP, STEP):
        _spread(birth, last, used, flames.free, frame, chance)
        weight = (birth <= frame).reshape(futures, -1).astype(np.float64) @ floor
        mean = (ROOM + FLAME * weight + temperature @ between) / (around + weight)
        burns = np.isfinite(caught)
        temperature = np.where(burns, FLAME, mean + KEPT * (temperature - mean))
        ignites = ~burns & (temperature >= things.threshold)
        if things.whole_at is not None:
            ignites &= frame > things.whole_at
        caught[ignites] = frame
        temperature[ignites] = FLAME
    return caught


def _spread(
    birth: Array,
    last: Array,
    used: NDArray[np.bool_],
    free: Mask,
    frame: float,
    chance: np.random.Generator,
) -> None:
    """Let each flame try a neighbour: `birth` and `last` success [frames], [N, Y, X], ways `used` [4, N, Y, X]."""
    age = np.maximum(frame - last, 0.0)
    likely = FIRST_CHANCE + (1 - FIRST_CHANCE) * np.clip((age - AGES[0]) / (AGES[1] - AGES[0]), 0.0, 1.0)
    ready = (frame - birth >= GROWN) & ~used.all(axis=0)
    success = ready & (chance.random(birth.shape) < likely)
    if not success.any():
        return
    way = np.where(used, 2.0, chance.random(used.shape)).argmin(axis=0)
    last[success] = frame
    for number, towards in enumerate(WAYS):
        goes = success & (way == number)
        used[number] |= goes
        new = _shifted(goes, towards) & free & (birth > frame)
        birth[new] = last[new] = frame + 1


def _shifted(cells: Mask, way: tuple[int, int]) -> Mask:
    """The neighbours in one way of `cells`, [N, Y, X]; none beyond the window."""
    y, x = way
    moved = np.zeros_like(cells)
    height, width = cells.shape[1:]
    moved[:, max(y, 0) : height + min(y, 0), max(x, 0) : width + min(x, 0)] = cells[
        :, max(-y, 0) : height + min(-y, 0), max(-x, 0) : width + min(-x, 0)
    ]
    return moved


def _from(cells: Mask, way: tuple[int, int]) -> Mask:
    """Whether the neighbour in one way is among `cells`, [N, Y, X]."""
    return _shifted(cells, (-way[0], -way[1]))
