"""The problem of planning that a scene poses to a robot whose timeline is known, at typical durations of its skills."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.hazards.places import MOVED
from hazard_ms.scenes import solids
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, StaticTravel, Travel, straight_line
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.sketch.travel.ways import SETTLE, TURN, WALK, Ways
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec import SceneSpec

DRIFT = 0.5  # targets that get no farther than this before the limit are taken to rest [m] [ours]
TURNING = TURN * np.pi / 2 + SETTLE  # frames of a walk that are not spent on its length: a right angle [ours]
ANY_WAY = 1e6  # longer than any way [m]
DETOUR = 1.1  # length of ways in the open over that of straight lines [ours]


@dataclass(frozen=True)
class Outset:
    """The place and the frame from which a rescue continues."""

    place: tuple[float, float]  # of the robot [m]
    heading: float | None  # of the robot [rad]; None: it faces the way
    frame: int
    holding: int | None = None  # index along B of the thing in the hand


class RescueScene:
    """One scene as a robot's planner sees it: ways, sizes and durations of skills."""

    def __init__(self, spec: SceneSpec, robot: str, radius: float, limit: int) -> None:
        """`robot`: name of the robot, of `radius` [m]; `limit`: the last frame of an episode."""
        self.spec, self.limit = spec, limit
        self.ways = Ways(spec, radius=radius)
        times = skill_times.shipped(robot)
        self.pick, self.bag, self.cart = (
            times.typical(skill)[1] for skill in (skill_times.PICK_UP, skill_times.BAG, skill_times.CART)
        )
        self.edges = np.array([np.hypot(*solids.extent_of(thing)[:2]) / 2 for thing in spec.things])  # [m], [B]

    def problem(
        self,
        future: Timeline,
        targets: NDArray[np.int64],
        values: NDArray[np.float64],
        carts: NDArray[np.int64],
        outset: Outset,
        delays: NDArray[np.float64] | None = None,
        fading: float = 0.0,
        spread: float = 0.0,
        carried_off: bool = False,
    ) -> Problem:
        """The problem of rescuing `targets`, indices [T] along B, worth `values` [T], from an outset on.

        `carts`: indices of the carts, [C], none if the safe place is the bag; `delays`: frames that each pick-up takes
        longer than usual, [T]; `fading` and `spread` as for `Problem`; `carried_off`: it says when targets are carried
        off. A thing in the hand must be among the targets.
        """
        extra = np.zeros(len(targets)) if delays is None else delays
        travel, saved = self._travel(future, targets, carts, outset)
        return Problem(
            travel,
            values=values.tolist(),
            damaged_at=future.whole_until()[targets].tolist(),
            pick=np.maximum(self.pick + extra - saved, 0.0).tolist(),
            drop=[max(0.0, self.cart - saved)] * len(carts) if len(carts) else [self.bag] * len(targets),
            limit=float(max(self.limit, outset.frame)),
            frame=float(outset.frame),
            fading=fading,
            spread=spread,
            holding=None if outset.holding is None else targets.tolist().index(outset.holding),
            gone_at=self.gone_at(future, targets).tolist() if carried_off else None,
        )

    def gone_at(self, future: Timeline, targets: NDArray[np.int64]) -> NDArray[np.float64]:
        """The last frame before each of `targets`, [T], is farther than MOVED from where it stood at the start, [T].

        inf where it never is. What was put down elsewhere counts as carried off [ours: agents do not do that].
        """
        places = np.array([self.spec.things[t].position for t in targets], np.float64).reshape(len(targets), -1)
        off = np.linalg.norm(future.positions(targets)[..., :2] - places[:, :2], axis=-1) > MOVED  # [S, T]
        first = future.frames[off.argmax(axis=0)] - 1.0
        return np.where(off.any(axis=0), np.maximum(first, 0.0), np.inf)

    def _travel(
        self, future: Timeline, targets: NDArray[np.int64], carts: NDArray[np.int64], outset: Outset
    ) -> tuple[Travel, float]:
        """Travel between all nodes, and the frames by which each walk is shorter than it says."""
        ways = future.positions(targets)[..., :2].astype(np.float64)  # [S, T, 2]
        rest = future.positions(carts)[0, :, :2].astype(np.float64)
        near = min(int(np.searchsorted(future.frames, outset.frame)), len(ways) - 1)
        # In rooms furniture lengthens walks more than drift does: with straight lines to where things float the oracle
        # of floods had a mean Value of 0.73 in ten scenes of `train`, with ways round furniture 0.79.
        if self.spec.room.open_air and np.linalg.norm(ways[near:] - ways[near], axis=-1).max(initial=0.0) > DRIFT:
            walk = straight_line(WALK * DETOUR)
            moving = MovingTravel(future.frames[near:], ways[near:], np.asarray(outset.place), walk, rest)
            return moving, WALK * ARRIVED - TURNING
        goals, edges = np.concatenate([ways[near], rest]), self.edges[np.concatenate([targets, carts])]
        here = np.asarray(outset.place, np.float64)[None]
        # where the robot stands, and faces, who has walked to each goal from here: not always on its next way's side
        first, ends = self.ways.route(here, goals, edges), self.ways.along(here, goals, ANY_WAY, edges)
        table = np.zeros((len(goals) + 1, len(goals) + 1))
        table[:-1, :-1] = self.ways.frames(ends[:, None], goals[None], first.last[:, None], edges)
        table[-1, :-1] = first.frames(outset.heading)
        np.fill_diagonal(table, 0.0)
        return StaticTravel(table, len(carts)), 0.0
