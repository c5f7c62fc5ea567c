"""The map that the original's learner sees, 4 + H planes of 64 x 64 cells of 0.25 m around the start, for H hazards.

    plane    number in a cell
    0        1 where it was explored, else 0
    1        height of the highest point seen there [m]; 0 where nothing was
    2        target i: i / 32, where it was last seen; what is in the hand: where the agent is; a cart: 1; other: -1
    3        the agent: -2; the cell that it faces: -1; other: 0
    4 + k    level of hazard k when last seen above the lower end of its usual range, up to twice the range: in its unit
             (water: m), or log(1 + level) for levels that range over more than WIDE units (temperature: K); else 0

Rows go along y, columns along x, world frame. What lies beyond the map is shown at its edge. The environments of the
simulator and of the sketch draw their maps with the same code; what the sketch cannot know is said in
`hazard_ms.sketch.paper.maps`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import CEILING, MAP_CELL
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.options.options import TARGET_SLOTS

MAP_VERSION = 1  # goes up whenever a plane is added, moved or changes its meaning: a policy fits one version
CELLS, CELL = 64, 0.25  # along each side; edge of a cell [m]
EXPLORED, HEIGHT, THING, AGENT, LEVEL = range(5)  # numbers of planes, the first of the levels last
NOTHING, CART = -1.0, 1.0  # in the plane of things, where targets are 0 to 31 / 32
HERE, FACING = -2.0, -1.0  # in the plane of the agent
WIDE = 100.0  # a level that ranges over more units than this is given as a logarithm [ours]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Planes = NDArray[np.float32]


@dataclass(frozen=True)
class Seen:
    """The knowledge of N agents about K things, targets first, and their own places. World frame."""

    centre: Floats  # middle of each map [m], [N, 2]
    place: Floats  # of the agents [m], [N, 2]
    heading: Floats  # of the agents [rad], [N]
    held: Ints  # number of the target in the hand, or -1, [N]
    known: NDArray[np.bool_]  # whether each thing is shown, [N, K]
    position: Floats  # of the things, as last seen [m], [N, K, 2]
    mark: Floats  # of the things in the plane THING, [K]
    level: Floats  # of the hazards over them when last seen, in their units; NaN: not known, [N, K, H]


class MapLayout:
    """The layout of the map in tasks with hazards whose usual levels have the ends `ranges`."""

    def __init__(self, ranges: Sequence[tuple[float, float]]) -> None:
        """Make the layout for H = len(`ranges`) hazards."""
        self.ranges = tuple(ranges)
        ends = np.array(self.ranges, np.float64).reshape(-1, 2)
        self._low, self._span = ends[:, 0], ends[:, 1] - ends[:, 0]
        self.planes = LEVEL + len(self.ranges)

    def space(self) -> gym.spaces.Box:
        """The bounds of all numbers, [4 + H, 64, 64]."""
        low, high = [0.0, 0.0, NOTHING, HERE], [1.0, CEILING, CART, 0.0]
        most = self.levels((self._low + 2.0 * self._span)[:, None])[:, 0]
        shape = (self.planes, CELLS, CELLS)
        bounds = (np.array(end, np.float32)[:, None, None] for end in ([*low, *(0.0 * most)], [*high, *most]))
        lowest, highest = (np.broadcast_to(bound, shape).copy() for bound in bounds)
        return gym.spaces.Box(lowest, highest, dtype=np.float32)

    def levels(self, raw: Floats) -> Floats:
        """Levels in their units, [H, ...], as the map gives them, [H, ...]; 0 where they are not known (NaN)."""
        extra = (slice(None), *(None,) * (raw.ndim - 1))
        above = np.nan_to_num(raw, nan=-np.inf) - self._low[extra]
        above = np.clip(above, 0.0, 2.0 * self._span[extra])
        return np.where(self._span[extra] > WIDE, np.log1p(above), above)

    def blank(self, count: int) -> Planes:
        """`count` maps on which nothing is, [N, 4 + H, 64, 64]."""
        made = np.zeros((count, self.planes, CELLS, CELLS), np.float32)
        made[:, THING] = NOTHING
        return made

    def draw(self, maps: Planes, seen: Seen) -> None:
        """Draw things, their levels and the agents into `maps` [N, 4 + H, 64, 64]."""
        row, thing = np.nonzero(seen.known[:, ::-1])  # of several in one cell the first target is drawn last
        thing = seen.known.shape[1] - 1 - thing
        y, x = cells(seen.position[row, thing], seen.centre[row])
        maps[row, THING, y, x] = seen.mark[thing]
        for k, level in enumerate(self.levels(np.moveaxis(seen.level, -1, 0))):
            maps[row, LEVEL + k, y, x] = level[row, thing]
        everyone = np.arange(len(maps))
        y, x = cells(seen.place, seen.centre)
        ahead_y, ahead_x = (
            np.clip(at + np.rint(turn(seen.heading)).astype(np.int64), 0, CELLS - 1)
            for at, turn in ((y, np.sin), (x, np.cos))
        )
        maps[everyone, AGENT, ahead_y, ahead_x] = FACING
        maps[everyone, AGENT, y, x] = HERE
        maps[everyone, EXPLORED, y, x] = 1.0
        full = np.flatnonzero(seen.held >= 0)
        maps[full, THING, y[full], x[full]] = seen.mark[seen.held[full]]

    def encode(self, decision: Decision) -> Planes:
        """The map of one `decision`, float32 [4 + H, 64, 64]. Raises ValueError for more targets than slots."""
        if len(decision.targets) > TARGET_SLOTS:
            raise ValueError(f"a scene must have at most {TARGET_SLOTS} targets, got {len(decision.targets)}")
        made, fine = self.blank(1), decision.map
        centre = np.asarray(fine.origin + fine.cell * len(fine.explored) / 2.0)
        y, x = np.nonzero(fine.explored)
        at = fine.centre_of(y, x)
        inside = (np.abs(at - centre) < CELLS * CELL / 2.0).all(axis=1)
        y, x, at = y[inside], x[inside], at[inside]
        down, right = cells(at, centre)
        made[0, EXPLORED, down, right] = 1.0
        np.maximum.at(made[0, HEIGHT], (down, right), np.minimum(fine.height[y, x], CEILING))
        for k, level in enumerate(self.levels(fine.levels[:, y, x].astype(np.float64))):
            np.maximum.at(made[0, LEVEL + k], (down, right), level.astype(np.float32))
        self.draw(made, self._seen(decision, centre))
        return made[0]

    def _seen(self, decision: Decision, centre: Floats) -> Seen:
        """What the agent knows of targets and carts."""
        objects, hazards = decision.map.objects, len(self.ranges)
        names = (*(t.name for t in decision.targets), *decision.containers)
        things = [objects.get(decision.index(name)) for name in names]
        away = [t.rescued or t.name == decision.held for t in decision.targets]
        away += [False] * len(decision.containers)
        known = [thing is not None and not gone for thing, gone in zip(things, away, strict=True)]
        position = [(0.0, 0.0) if thing is None else thing.position[:2] for thing in things]
        unknown = (np.nan,) * hazards
        level = [thing.levels if thing is not None and len(thing.levels) == hazards else unknown for thing in things]
        held = names.index(decision.held) if decision.held in names else -1
        return Seen(
            centre[None],
            np.array([decision.agent_position], np.float64),
            np.array([decision.agent_heading], np.float64),
            np.array([held]),
            np.array([known], bool).reshape(1, len(names)),
            np.array([position], np.float64).reshape(1, len(names), 2),
            marks(len(decision.targets), len(decision.containers)),
            np.array([level], np.float64).reshape(1, len(names), hazards),
        )


def marks(targets: int, carts: int) -> Floats:
    """The marks of targets and carts in the plane of things, [targets + carts]."""
    return np.concatenate([np.arange(targets) / TARGET_SLOTS, np.full(carts, CART)])


def centre_at(start: Floats) -> Floats:
    """The middles of the maps of agents that began at `start` [m], [..., 2]: those of their finer maps."""
    return np.round(start / MAP_CELL) * MAP_CELL


def cells(points: Floats, centre: Floats) -> tuple[Ints, Ints]:
    """Rows and columns of the cells at `points` [m], [..., 2], or of those at the edge that are nearest to them.

    `centre`: middles of the maps [m], [..., 2].
    """
    at = np.floor((points - centre) / CELL).astype(np.int64) + CELLS // 2
    x, y = np.moveaxis(np.clip(at, 0, CELLS - 1), -1, 0)
    return y, x
