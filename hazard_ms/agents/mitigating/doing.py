"""Does what was chosen about the hazard by ordinary actions: fetches a tool, puts out seats of fire, shuts a door."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.mitigating.choice import Chooser, Key
from hazard_ms.agents.mitigating.prospects import ANY_WAY, FETCH, Array, Prospect, as_now, seats_of
from hazard_ms.agents.truth import Truth
from hazard_ms.planning.problem import Problem
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import OPEN, OUT, SHUT, fire_of
from hazard_ms.sketch.futures.surroundings import charge_of, hidden, inner_doors
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.mitigations.extinguish import AROUND

EXTINGUISH, SHUT_DOOR, OPEN_DOOR = "extinguish", "shut", "open"
EYES = 1.0  # height from which a jet is aimed [m] [ours]
VIEW, AROUND_IT = (
    3.0,
    16,
)  # distance from flames [m], and number of the things that it walks to for a view of them [ours]
LOW = 0.1  # height of flames on the floor [m] [ours]
TRIES = 3  # failures after which something is given up [ours]


class Mitigator:
    """Does something about the hazard in one episode of the oracle; `note` says why."""

    def __init__(self, truth: Truth, brief: Brief) -> None:
        self._truth, self._brief = truth, brief
        self._base = truth.env.base
        self._chooser = Chooser(self._base)
        self._queue: list[Prospect] = []  # what was chosen and is not yet done
        self._failures: dict[Key, int] = {}
        self._last: Action | None = None  # its own last action
        self._shares: tuple[float, ...] = ()
        self._scene: RescueScene | None = None
        self.note = ""

    def scene(self, now: RescueScene, here: tuple[float, float]) -> RescueScene:
        """The scene as a planner sees it with its doors as they are: `now`, unless one of them has moved."""
        share = self._base.world.openings.share[0].tolist()
        shares = tuple(share[: len(now.spec.room.openings)])
        moved = self._shares not in ((), shares)
        self._shares = shares
        if not moved:
            return now
        spec = as_now(now.spec, shares, here)
        return RescueScene(spec, self._brief.robot, self._base.agent.build.radius, self._brief.max_frames)

    def took(self, decision: Decision) -> bool:
        """Whether the last action was its own; counts its failure."""
        last, result = self._last, decision.last_result
        self._last = None
        if last is None or result is None:
            return False
        if not result.ok and result.reason not in UNFINISHED and self._queue:
            key = self._queue[0].kind, self._queue[0].numbers
            self._failures[key] = self._failures.get(key, 0) + 1
            if self._failures[key] >= TRIES:
                self._end()
        return True

    def begin(self, what: Sequence[Prospect], scene: RescueScene) -> None:
        """Do `what`, in its order, in `scene` from now on."""
        self._queue, self._scene = list(what), scene

    def next(self, decision: Decision) -> Action | None:
        """The next action of what was begun, after the last one; None where all is done, or was given up."""
        self.took(decision)
        self._last = self._next(decision)
        self._truth.reveal()
        return self._last

    def act(self, decision: Decision, problem: Problem, targets: Sequence[int], scene: RescueScene) -> Action | None:
        """The next action about the hazard; None where a rescue is next."""
        self._scene = scene
        self._last = self._next(decision)
        if self._last is None and not any(t.held for t in decision.targets):
            self._choose(decision, problem, targets, scene)
            self._last = self._next(decision)
        if self._last is not None:
            self._truth.reveal()
        return self._last

    def way_out(self, decision: Decision) -> Action | None:
        """The opening of the nearest shut door, where the robot cannot get away; None where there is none."""
        world, here = self._base.world, np.array(decision.agent_position)
        shut = [
            (float(np.hypot(*(middle - here))), number)
            for number, middle in inner_doors(world).items()
            if float(world.openings.share[0, number]) < 1.0 and self._failures.get((OPEN, (number,)), 0) < TRIES
        ]
        if not shut or decision.held is not None:
            return None
        door = min(shut)[1]
        self._failures[OPEN, (door,)] = self._failures.get((OPEN, (door,)), 0) + 1
        self._end()
        self._failures[SHUT, (door,)] = TRIES  # not again
        self._last = Action(OPEN_DOOR, self._truth.env.stage.doors.names[door])
        self.note = "no way leads anywhere: open a door"
        return self._last

    def _choose(self, decision: Decision, problem: Problem, targets: Sequence[int], scene: RescueScene) -> None:
        failed = {key for key, times in self._failures.items() if times >= TRIES}
        held = -1 if decision.held is None else decision.index(decision.held)
        course, made = self._chooser.course(problem, targets, scene, decision.agent_position, held, failed)
        if course is None or course.before is not None:
            return
        self._queue = [made[step.measure] for step in course.steps]
        names = ", ".join(f"{p.kind} {'+'.join(map(str, p.numbers))}" for p in self._queue)
        self.note = f"{names}: averts {course.value:g} instead of {course.plain:g}"

    def _end(self) -> None:
        """Give up what was chosen, or be done with it."""
        self._queue = []
        self._chooser.forget()
        self._truth.forget()
        self._truth.also = set()

    def _next(self, decision: Decision) -> Action | None:
        """The next action of what was chosen; None where that is done."""
        while self._queue:
            action = self._step(decision, self._queue[0])
            if action is not None:
                return action
            if self._queue:
                del self._queue[0]
            if not self._queue:
                self._end()
        return None

    def _step(self, decision: Decision, doing: Prospect) -> Action | None:
        if doing.kind == FETCH:
            return self._fetched(decision, doing.numbers[0])
        if doing.kind == OUT:
            return self._fought(decision, doing.numbers)
        door = doing.numbers[0]
        openings = self._base.world.openings
        if float(openings.share[0, door]) <= 0.0 or bool(openings.state.broken[0, door]):
            return None
        return Action(DROP) if decision.held is not None else Action(SHUT_DOOR, self._truth.env.stage.doors.names[door])

    def _fetched(self, decision: Decision, tool: int) -> Action | None:
        name = decision.names[tool]
        if decision.held == name:
            return None
        self._truth.also = {tool}
        if decision.held is not None:
            return Action(DROP)
        return Action(PICK_UP if decision.walked_up_to == name else WALK_TO, name)

    def _fought(self, decision: Decision, numbers: Sequence[int]) -> Action | None:
        """The next jet at the nearest of the seats `numbers` that still burns; None where none does, or none helps."""
        held = -1 if decision.held is None else decision.index(decision.held)
        burning = {seat.number for seat in seats_of(self._base)}
        left = [number for number in numbers if number in burning]
        if not left or held < 0 or charge_of(self._base, held) <= 0.0:
            return None
        found = self._aim(left[0], np.array(decision.agent_position), held)
        if found < 0:
            return None
        self._truth.also = {found}
        before = self._in_view_from(found, np.array(decision.agent_position))
        if before >= 0 and decision.walked_up_to != decision.names[before]:
            self._truth.also = {found, before}
            return Action(WALK_TO, decision.names[before])
        return Action(EXTINGUISH, decision.names[found])

    def _in_view_from(self, index: int, here: Array) -> int:
        """The thing to walk to from `here` [m] for a view of the thing `index` that a wall hides; -1: none, or no wall.

        Of the things around it, it is the one with the shortest way that ends where no wall is between.
        """
        world = self._base.world
        aim = world.position[0, index].cpu().numpy().astype(np.float64)
        if self._scene is None or not hidden(world, _standing(here[None]), aim)[0]:
            return -1
        places = world.position[0, :, :2].cpu().numpy().astype(np.float64)
        there = (world.exists & ~world.away & ~world.held)[0].cpu().numpy()[: len(self._scene.edges)]
        gaps = np.where(there, np.hypot(*(places[: len(there)] - places[index]).T), np.inf)
        near = [b for b in np.argsort(gaps)[:AROUND_IT].tolist() if gaps[b] < VIEW]
        goals, edges = places[near], self._scene.edges[near]
        ends = self._scene.ways.along(here[None], goals, ANY_WAY, edges)
        frames = self._scene.ways.frames(here[None], goals, edge=edges)
        frames = np.where(hidden(world, _standing(ends), aim), np.inf, frames)
        return near[int(np.argmin(frames))] if len(near) and np.isfinite(frames).any() else -1

    def _aim(self, seat: int, here: Array, held: int) -> int:
        """The thing to name, along B, for putting out the flames of a seat that are nearest to `here` [m]; -1: none."""
        fire, world = fire_of(self._base.episode), self._base.world
        assert fire is not None
        places = world.position[0, :, :2].cpu().numpy().astype(np.float64)
        goods = np.flatnonzero((seats.alight(fire, world) == seat)[0].cpu().numpy())
        if len(goods):
            return int(goods[np.argmin(np.hypot(*(places[goods] - here).T))])
        floor = fire.flame_place[0, :, :2][seats.flames(fire, world.frame)[0] == seat].cpu().numpy().astype(np.float64)
        if not len(floor):
            return -1
        nearest = floor[np.argmin(np.hypot(*(floor - here).T))]
        there = (world.exists & ~world.away & ~world.held)[0].cpu().numpy()
        there &= ~hidden(world, world.position[0].cpu().numpy().astype(np.float64), np.array([*nearest, LOW]))
        gaps = np.where(there, np.hypot(*(places - nearest).T), np.inf)
        best = int(np.argmin(gaps))
        return best if gaps[best] < AROUND else -1


def _standing(places: Array) -> Array:
    """Places of a nozzle above `places` [m], [P, 2]: [P, 3]."""
    return np.concatenate([places, np.full((len(places), 1), EYES)], axis=1)
