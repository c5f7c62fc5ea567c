"""The value that a rescue can still reach, and what a choice leaves of it, with the true state and the true future.

It judges decisions afterwards; no agent but a privileged one may ask it. All values count what is rescued already, too.

    best     by the best plan from a state on, with walks and skills that take as long as they usually do
    choice   by the best course that begins with an action: either the action is seen through, and the best plan
             counts that begins with its target or cart; or all is planned anew where the action usually ends

How long skills take is uncertain. What a state is worth is therefore the mean over PACES, at each of which all that is
left to do takes that much less or more time: otherwise a single frame could decide whether a target counts, and the
hundred frames wasted before it would not be blamed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.aims import VALUE, Aim
from hazard_ms.agents.mitigating.costs import PUT_DOWN
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.planning.committed import committed
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.sketch.travel.ways import SETTLE, TURN, WALK
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action
from hazard_ms.skills.motor.motion import wrap
from hazard_ms.skills.motor.walking import ARRIVED, MIDPOINT, WALK_FRAMES
from hazard_ms.spec.catalogue import DAMAGED_SHARE

MOST_REACH = 2.5  # distance from the base up to which a pick-up may work [m]
CART_REACH = 1.5  # distance from the base up to which a thing can be let go over a cart [m] [ours]
PACES = (0.85, 0.95, 1.05, 1.15)  # the time that is left, over that which it feels like [ours]
EASE = 5  # frames by which a course that is planned anew may be late: walks of two pieces count starts twice [ours]
ROUNDING = 1e-6  # of values
MOST_LABELS = 4_000  # of an exact search [ours]
BEAM = 500  # labels of a layer beyond that [ours]

Place = tuple[float, float]  # x, y [m]
Reach = tuple[float, ...]  # the value that is reached at each of PACES


@dataclass(frozen=True)
class State:
    """The state of a rescue: where the robot is, what it holds, and what is left to rescue."""

    place: Place  # of the robot [m]
    heading: float | None  # of the robot [rad]; None: it faces its next way
    frame: int
    holding: int | None  # index along B of the target in the hand
    left: tuple[int, ...]  # targets that are not safe, indices along B, the one in the hand among them
    saved: float  # value rescued so far, and what its aim counts without any rescue
    tool: int | None = None  # index along B of the tool in the hand, which is put down before anything is rescued


@dataclass(frozen=True)
class Notion:
    """The targets as somebody takes them to be: what is not in `values` is not known to exist."""

    values: Mapping[int, float]  # by index along B
    places: Mapping[int, Place] = field(default_factory=dict)  # of those that are not where they really are [m]


class ActionValues:
    """The values of states and of choices in one scene, whose future is known."""

    def __init__(self, scene: RescueScene, carts: tuple[int, ...], times: SkillTimes, aim: Aim = VALUE) -> None:
        """`carts`: indices along B of those of `scene`, none where the safe place is the bag; `times` of skills."""
        self._scene, self._carts, self._times, self._aim = scene, carts, times, aim
        self._explore, self._lost = (times.typical(s)[1] for s in (skill_times.EXPLORE, skill_times.NO_PATH))

    def limits(self, frame: int) -> Reach:
        """The last frame of the episode at each of PACES, as it looks at `frame`."""
        return tuple(frame + pace * (self._scene.limit - frame) for pace in PACES)

    def best(self, state: State, notion: Notion, future: Timeline, limits: Reach) -> Reach:
        """The value that the best plan reaches from `state` by each of `limits`, with targets as `notion` says."""
        problem = self._problem(state, notion, future)[0]
        return tuple(state.saved + _solved(problem, limit) for limit in limits)

    def choice(
        self,
        state: State,
        action: Action,
        notion: Notion,
        future: Timeline,
        limits: Reach,
        best: Reach,
        place: Place | None = None,
    ) -> Reach:
        """The value that the best course that begins with `action` reaches by each of `limits`; `best`: any course.

        `place` [m]: where somebody walks whose target is nothing that there is.
        """
        if action.verb == STOP:
            return (state.saved,) * len(limits)
        through = self._through(state, action, notion, future, limits)
        if all(a >= b - ROUNDING for a, b in zip(through, best, strict=True)):
            return best
        after = self.after(state, action, notion, future, place)
        after = replace(after, frame=max(state.frame, after.frame - EASE))
        anew = [
            value if after.frame <= limit else state.saved
            for value, limit in zip(self.best(after, notion, future, limits), limits, strict=True)
        ]
        return tuple(min(b, max(a, c)) for a, b, c in zip(through, best, anew, strict=True))

    def begins_with(self, state: State, notion: Notion, future: Timeline, limit: float) -> str:
        """The first rescue of the best plan by `limit` in words; empty where it has none."""
        problem, targets = self._problem(state, notion, future)
        plan = solve(replace(problem, limit=limit), MOST_LABELS, BEAM) if problem else None
        if problem is None or plan is None or not plan.rescues:
            return ""
        first = plan.rescues[0]
        if first.target == problem.holding:
            return "to put away what it held"
        return f"to rescue {future.names[targets[first.target]]}"

    def _through(self, state: State, action: Action, notion: Notion, future: Timeline, limits: Reach) -> Reach:
        """The value of the best plan whose first rescue `action` begins, by each of `limits`; 0 if it begins none."""
        problem, targets = self._problem(state, notion, future)
        index = future.names.index(action.target) if action.target in future.names else -1
        none = (0.0,) * len(limits)
        if problem is None or action.verb == EXPLORE:
            return none
        if state.holding is None:
            if index not in targets or action.verb == DROP:
                return none
            goal, cart = targets.index(index), None
        else:
            if action.verb == PICK_UP or (action.verb != DROP and index not in self._carts):
                return none
            goal, cart = targets.index(state.holding), self._carts.index(index) if index in self._carts else None
            if self._carts and cart is None:  # on the ground
                return none
        rests = (replace(problem, limit=limit) for limit in limits)
        return tuple(state.saved + committed(rest, goal, cart, MOST_LABELS, BEAM) for rest in rests)

    def after(
        self, state: State, action: Action, notion: Notion, future: Timeline, place: Place | None = None
    ) -> State:
        """The state in which `action` usually leaves a rescue; what cannot work takes no time; `place` as above."""
        if action.verb == EXPLORE:
            return self._later(state, self._explore)
        index = future.names.index(action.target) if action.target in future.names else -1
        if action.verb in (WALK_TO, WALK_ONE_STEP):
            goal = place if index < 0 else future.position_at(state.frame)[index, :2]
            edge = 0.0 if index < 0 else self._scene.edges[index]
            return state if goal is None else self._walked(state, goal, edge, action.verb == WALK_ONE_STEP)
        if action.verb == PICK_UP and index >= 0:
            away, pick = self._away(state, index, future), self._pick(index, state.frame, future)
            if state.holding is not None or index not in state.left or away > MOST_REACH:
                return state
            return replace(self._later(self._turned(state, index, future), pick), holding=index)
        if action.verb != DROP or state.holding is None:
            return state
        if not self._carts:
            return self._stowed(self._later(state, self._scene.bag), notion, future)
        if index not in self._carts:
            return replace(state, holding=None)
        if self._away(state, index, future) > CART_REACH:
            return state
        return self._stowed(self._later(state, self._scene.cart), notion, future)

    def _problem(self, state: State, notion: Notion, future: Timeline) -> tuple[Problem | None, list[int]]:
        """The rest of the rescue as its aim counts it: see `problem`."""
        problem, targets = self.problem(state, notion, future)
        return problem and self._aim.of(problem), targets

    def problem(self, state: State, notion: Notion, future: Timeline) -> tuple[Problem | None, list[int]]:
        """The rest of the rescue, None where nothing can be rescued any more, and its targets, indices along B."""
        targets = [t for t in state.left if t in notion.values or t == state.holding]
        if not targets:
            return None, targets
        frame = state.frame if state.tool is None else state.frame + round(PUT_DOWN)
        outset = Outset(state.place, state.heading, frame, state.holding)
        values = np.array([notion.values.get(t, 0.0) for t in targets])
        told, carts = future.displaced(notion.places, outset.frame), np.array(self._carts, np.int64)
        delays = np.array([self._pick(t, state.frame, future) - self._scene.pick for t in targets])
        off = self._aim.carried_off
        made = self._scene.problem(told, np.array(targets), values, carts, outset, delays, carried_off=off)
        if made.holding is not None and made.gone_at is not None:
            made = replace(made, gone_at=[np.inf if t == made.holding else at for t, at in enumerate(made.gone_at)])
        return made, targets

    def _pick(self, index: int, frame: int, future: Timeline) -> float:
        """Frames that it usually takes to pick up the thing `index`, at its height at a frame."""
        return self._times.usual(skill_times.PICK_UP, float(future.position_at(frame)[index, 2]))

    def _walked(self, state: State, to: Place | NDArray[np.float32], edge: float, one_step: bool) -> State:
        """The state after a walk `to` the middle of a thing with an `edge` around it [m], or its first part if long."""
        goal = np.asarray(to, np.float64)
        place, ways = np.array(state.place), self._scene.ways
        route = ways.route(place, goal, edge)
        if not np.isfinite(route.metres):
            return self._later(state, self._lost)
        whole, metres = float(route.frames(state.heading)), float(route.metres)
        most = min(whole, WALK_FRAMES, max(whole - (metres - MIDPOINT) * WALK, 0.0) if one_step else whole)
        gone = max(0.0, metres - (whole - most) / WALK)
        x, y = ways.along(place, goal, metres + 1.0 if most == whole else gone, edge)
        heading = route.last if most == whole else ways.route(np.array([x, y]), goal, edge).first  # it faces the rest
        return replace(self._later(state, most), place=(float(x), float(y)), heading=float(heading))

    def _turned(self, state: State, index: int, future: Timeline) -> State:
        """The state once the base has turned to the thing `index` and come as near to it as `walk_to` does."""
        goal, edge = future.position_at(state.frame)[index, :2].astype(np.float64), self._scene.edges[index]
        place = np.array(state.place)
        route = self._scene.ways.route(place, goal, edge)
        if not np.isfinite(route.metres) or self._away(state, index, future) <= ARRIVED + edge:  # it only turns
            facing = float(np.arctan2(*(goal - place)[::-1]))
            turn = 0.0 if state.heading is None else abs(wrap(facing - state.heading))
            return replace(self._later(state, TURN * turn), heading=facing)
        frames = max(0.0, float(route.frames(state.heading)) - SETTLE)
        x, y = self._scene.ways.along(place, goal, route.metres, edge)
        return replace(self._later(state, frames), place=(float(x), float(y)), heading=float(route.last))

    def _stowed(self, state: State, notion: Notion, future: Timeline) -> State:
        """The state in which what was in the hand is safe."""
        held = state.holding
        assert held is not None
        value = np.array([notion.values.get(held, 0.0)])
        kept = float(self._aim.kept(np.array([held]), value, future, self._scene, held)[0])
        share = 1.0 if state.frame <= future.whole_until()[held] else DAMAGED_SHARE
        left = tuple(t for t in state.left if t != held)
        return replace(state, holding=None, left=left, saved=state.saved + share * float(value[0]) - kept)

    def _later(self, state: State, frames: float) -> State:
        return replace(state, frame=state.frame + round(frames))

    def _away(self, state: State, index: int, future: Timeline) -> float:
        """Horizontal distance from the robot to the thing `index` [m]."""
        return float(np.hypot(*(future.position_at(state.frame)[index, :2] - state.place)))


def mean(reach: Reach) -> float:
    """The mean of values over PACES."""
    return sum(reach) / len(reach)


def _solved(problem: Problem | None, limit: float) -> float:
    """The value of the best plan of what is left to do, if `limit` is the last frame."""
    if problem is None or problem.frame >= limit:
        return 0.0
    return solve(replace(problem, limit=limit), MOST_LABELS, BEAM).value
