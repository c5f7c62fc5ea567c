"""Bounds on the Value that any agent can reach in an episode: the exact search with times that nobody can beat.

    walks      straight lines at full speed, without turns, between places from which things can just be reached
    pick-ups   as short as the arm's joints allow
    damage     as in the timeline: what an agent carries away no longer heats or crowds what is left, so that a thing
               may burn a little earlier or later than without an agent. `strict` ignores damage instead

Things that move are met wherever they come nearest (if they go into the bag), or wherever that brings them to a cart
earliest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes import solids
from hazard_ms.sketch.planning.bound import never_damaged
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import Spot, StaticTravel, Travel
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec import Build, SceneSpec
from hazard_ms.spec.robot import GRASP_REACH

# A pick-up takes an arm at least 10 frames out, at 0.1 rad a frame, 4 to shut the hand and 10 back to the bag [ours]
PICK = 24.0  # [frames]
STOW = 14.0  # 10 frames out over a cart and 4 to open the hand [frames] [ours]
BAG = 1.0  # the hand is over the bag already [frames] [ours]

Metres = NDArray[np.float64]
Frames = NDArray[np.int64]


def bound(
    timeline: Timeline, spec: SceneSpec, build: Build, values: Sequence[float], limit: int, strict: bool = False
) -> float:
    """The share of the value of all targets that no agent exceeds, 0 to 1.

    `values` are those of `spec.targets`; `build` is the robot's; `limit`: the last frame of the episode;
    `strict`: nothing is ever damaged. Raises ValueError unless there are as many values as targets.
    """
    if len(values) != len(spec.targets):
        raise ValueError(f"values must be {len(spec.targets)}, one for each target, got {len(values)}")
    worth = np.asarray(values, np.float64)
    targets = np.array([timeline.index(target.name) for target in spec.targets], np.int64)
    alone = timeline.safe_at[targets] >= 0  # it becomes safe by itself
    start = spec.agent_start.position
    problem = easiest(timeline, spec, build, targets[~alone], worth[~alone], limit, start)
    plan = solve(never_damaged(problem) if strict else problem)
    return float(min(1.0, (worth[alone].sum() + plan.value + plan.gap) / max(worth.sum(), 1e-9)))


def easiest(
    timeline: Timeline,
    spec: SceneSpec,
    build: Build,
    targets: NDArray[np.int64],
    values: NDArray[np.float64],
    limit: int,
    start: tuple[float, float],
) -> Problem:
    """The problem of rescuing `targets`, indices [T] along B, from `start` [m] on, in times that nobody can beat.

    Other arguments as for `bound`, with `values` [T].
    """
    carts = np.array([timeline.index(cart.name) for cart in spec.containers], np.int64)
    reach = _reach(spec, build)
    frames = np.minimum(timeline.frames, limit)
    ways = timeline.positions(targets)[..., :2].astype(np.float64)
    rest, begin = timeline.start[carts, :2].astype(np.float64), np.asarray(start)
    per_metre = 1.0 / build.forward_step
    travel: Travel
    if len(carts):
        travel = _Chase(frames, ways, rest, begin, reach[targets], reach[carts], per_metre)
    else:
        travel = StaticTravel(_nearest(ways, begin, reach[targets]) * per_metre)
    return Problem(
        travel,
        values=values.tolist(),
        damaged_at=timeline.whole_until()[targets].tolist(),
        pick=[PICK] * len(targets),
        drop=[STOW] * len(carts) if len(carts) else [BAG] * len(targets),
        limit=float(limit),
    )


def _reach(spec: SceneSpec, build: Build) -> Metres:
    """Largest horizontal distance from the base [m] at which a hand can touch each thing, [B]."""
    far = max(ahead for ahead, _ in (build.shoulder, *build.stoops)) + build.reach + GRASP_REACH
    return np.array([far + np.linalg.norm(solids.extent_of(thing)) / 2 for thing in spec.things])


def _nearest(ways: Metres, start: Metres, reach: Metres) -> Metres:
    """Least ways of the base [m] between targets wherever they come, [S, T, 2] [m], with `start` last, [T+1, T+1]."""
    count = ways.shape[1]
    table = np.zeros((count + 1, count + 1))
    for a in range(count):
        for b in range(a + 1, count):  # each comes no nearer to the other than their ways do
            low = np.maximum(ways[:, a].min(0) - ways[:, b].max(0), ways[:, b].min(0) - ways[:, a].max(0))
            apart = float(np.hypot(*np.maximum(low, 0.0)))
            table[a, b] = table[b, a] = max(0.0, apart - reach[a] - reach[b])
    away = np.linalg.norm(ways - start, axis=-1).min(0, initial=np.inf)
    table[-1, :-1] = table[:-1, -1] = np.maximum(0.0, away - reach)
    return table


class _Chase(Travel):
    """Travel between carts that rest and targets that move, each of which is carried from its best place to a cart.

    Between two samples a target may come nearer than at both, by half of the way that it goes: reaches are lengthened
    by that much. Frames are those at the nearer one of the samples' ends.
    """

    def __init__(
        self,
        frames: Frames,
        ways: Metres,
        carts: Metres,
        start: Metres,
        reach: Metres,
        cart_reach: Metres,
        per_metre: float,
    ) -> None:
        """`ways` [m], [S, T, 2], at `frames` [S]; `reach` of targets, [T], and of carts, [C], from the base [m]."""
        super().__init__(ways.shape[1], len(carts), early_is_best=True)
        fixed, own = np.concatenate([carts, start[None]]), np.append(cart_reach, 0.0)
        steps = np.linalg.norm(np.diff(ways, axis=0), axis=-1).max(0, initial=0.0)
        away = np.linalg.norm(ways[:, :, None] - fixed, axis=-1) - (reach + steps / 2)[:, None] - own  # [S, T, C+1]
        walk = per_metre * np.maximum(away, 0.0)
        before, after = np.minimum(walk, np.roll(walk, 1, axis=0)), np.minimum(walk, np.roll(walk, -1, axis=0))
        before[0], after[-1] = walk[0], walk[-1]
        self._frames, self._least = frames.astype(np.float64), walk.min(axis=0)  # [S], [T, C+1]
        at = self._frames[:, None, None]
        # the latest frame at which to leave a cart, or the start, for meeting a target by each sample
        self._leave = np.maximum.accumulate(at - before, axis=0)
        # frames to a cart from when a target can be met first, if it is picked up wherever that is best
        arrive = np.minimum.accumulate((at + after[..., :-1])[::-1], axis=0)[::-1]
        self._carried = np.maximum(arrive - at - np.diff(frames).max(initial=0), self._least[:, :-1])

    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """The earliest frame at which each of `targets` can be met after `frame`, and where; inf for never."""
        met = []
        for target in targets:
            index = int(np.searchsorted(self._leave[:, target, spot[0] - self.targets], frame))
            if index == len(self._frames):
                met.append((np.inf, (target, index - 1)))
            else:
                earlier = max(index - 1, 0)
                soonest = max(float(self._frames[earlier]), frame + self._least[target, spot[0] - self.targets])
                met.append((soonest, (target, earlier)))
        return met

    def to_carts(self, spot: Spot) -> list[float]:
        """Frames from a spot to each cart, [C]."""
        target, index = spot
        return self._carried[index, target].tolist()

    def least_entries(self) -> NDArray[np.float64]:
        """Least frames of the walk to each target from wherever the rescue before it can end, [T]."""
        return self._least.min(axis=1)

    def least_exits(self) -> NDArray[np.float64]:
        """Least frames of the walk from each target to each cart, [T, C]."""
        return self._least[:, :-1]
