"""Does what was chosen about the hazard by ordinary actions: fetches tools, puts out fire, shuts doors, sets boards."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import torch

from hazard_ms.agents.mitigating.choice import Chooser, Key
from hazard_ms.agents.mitigating.prospects import FETCH, Array, Part, Prospect, as_now, seats_of
from hazard_ms.agents.truth import Truth
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.clutter import reached
from hazard_ms.sketch.futures.interventions import BLOCK, OPEN, OUT, SHUT, fire_of
from hazard_ms.sketch.futures.surroundings import charge_of, free_boards, hidden, inlets_of, inner_doors
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import NO_PATH, UNFINISHED
from hazard_ms.skills.mitigations.extinguish import AROUND

EXTINGUISH, SHUT_DOOR, OPEN_DOOR, SET_BOARD = "extinguish", "shut", "open", "block"
AGAIN = 200  # frames after which measures are weighed again although nothing was done [ours]
PUT_OFF = 300  # frames for which a door is left alone to which there was no way [ours]
TRIES = 3  # failures after which something is given up [ours]


class Mitigator:
    """Does something about the hazard in one episode of the oracle; `note` says why."""

    def __init__(self, truth: Truth, brief: Brief) -> None:
        self._truth, self._brief = truth, brief
        self._base = truth.env.base
        self._chooser = Chooser(self._base)
        self._queue: list[Prospect] = []  # what was chosen and is not yet done
        self._failures: dict[Key, int] = {}
        self._put_off: dict[Key, int] = {}  # the frames before which some things are not tried again
        self._last: Action | None = None  # its own last action
        self._weighed = -AGAIN  # frame at which it last weighed measures
        self._shares: tuple[float, ...] = ()
        self._scene: RescueScene | None = None
        self._changes = truth.changes
        self.note = ""

    @property
    def begun(self) -> frozenset[Part]:
        """All parts of what was chosen and is not yet done."""
        return frozenset(part for prospect in self._queue for part in prospect.parts)

    def leave(self, others: Iterable[Part]) -> None:
        """Leave what `others` are at, the other robots of a team, alone from now on."""
        self._chooser.others = frozenset(others)

    def scene(self, now: RescueScene, here: tuple[float, float]) -> RescueScene:
        """The scene as a planner sees it with its doors as they are: `now`, unless one of them has moved."""
        share = self._base.world.openings.share[0].tolist()
        shares = tuple(share[: len(now.spec.room.openings)])
        moved = self._shares not in ((), shares)
        self._shares = shares
        if not moved:
            return now
        spec = as_now(now.spec, shares, here)
        return RescueScene(spec, self._brief.robot, self._brief.radius, self._brief.max_frames)

    def took(self, decision: Decision) -> bool:
        """Whether the last action was its own; counts its failure."""
        last, result = self._last, decision.last_result
        self._last = None
        if last is None or result is None:
            return False
        if not result.ok and result.reason not in UNFINISHED and self._queue:
            key = self._queue[0].kind, self._queue[0].numbers
            self._failures[key] = self._failures.get(key, 0) + 1
            # what drifts about may free the way again, but all that waits for the door is lost meanwhile
            barred = key[0] == SHUT and result.reason == NO_PATH
            if barred:
                self._put_off[key] = decision.frame + PUT_OFF
            if barred or self._failures[key] >= TRIES:
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

    def go_on(self, decision: Decision, scene: RescueScene) -> Action | None:
        """The next action of what was chosen before; None where that is done, and the future has changed."""
        self._scene = scene
        self._last = self._next(decision)
        if self._last is not None:
            self._truth.reveal()
        return self._last

    def act(self, decision: Decision, problem: Problem, targets: Sequence[int], scene: RescueScene) -> Action | None:
        """The first action of what is worth doing now, after `go_on`; None where a rescue is next.

        `problem` and `targets` as for `Chooser.course`.
        """
        if any(t.held for t in decision.targets) or not self._is_due(decision):
            return None
        self._choose(decision, problem, targets, scene)
        return self.go_on(decision, scene)

    def _is_due(self, decision: Decision) -> bool:
        """Whether to weigh measures again: after a measure, a rescue or a failure, and every AGAIN frames."""
        last, result = decision.last_action, decision.last_result
        changed = last is None or result is None or not result.ok or last.verb == DROP
        if changed or decision.frame - self._weighed >= AGAIN:
            self._weighed = decision.frame
            return True
        return False

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
        if self._truth.changes != self._changes:
            self._chooser.forget()
            self._changes = self._truth.changes
        failed = {key for key, times in self._failures.items() if times >= TRIES}
        failed |= {key for key, frame in self._put_off.items() if decision.frame < frame}
        failed |= self._out_of_reach(decision)
        held = -1 if decision.held is None else decision.index(decision.held)
        course, made = self._chooser.course(problem, targets, scene, decision.agent_position, held, failed)
        if course is None or course.before is not None:
            return
        self._queue = [made[step.measure] for step in course.steps]
        names = ", ".join(f"{p.kind} {'+'.join(map(str, p.numbers))}" for p in self._queue)
        self.note = f"{names}: averts {course.value:g} instead of {course.plain:g}"

    def _out_of_reach(self, decision: Decision) -> set[Key]:
        """The doors to which no way leads now."""
        inner = inner_doors(self._base.world)
        if not inner:
            return set()
        places, seen = np.stack(list(inner.values())), self._truth.env.seen
        found = reached(seen, self._base.world, decision.agent_position, places, self._brief.radius)
        return {(SHUT, (number,)) for number, there in zip(inner, found, strict=True) if not there}

    def _end(self) -> None:
        """Give up what was chosen, or be done with it."""
        self._queue, self._weighed = [], -AGAIN
        self._truth.forget()
        self._truth.also = set()

    def _next(self, decision: Decision) -> Action | None:
        """The next action of what was chosen; None where that is done."""
        while self._queue:
            action = self._step(decision, self._queue[0])
            if action is not None:
                return action
            if self._queue and self._queue.pop(0).kind == SHUT:
                self._queue.clear()  # what is next depends on the side on which it stands, and on what drifts there now
            if not self._queue:
                self._end()
        return None

    def _step(self, decision: Decision, doing: Prospect) -> Action | None:
        if doing.kind == FETCH:
            return self._fetched(decision, doing.numbers[0])
        if doing.kind == OUT:
            return self._fought(decision, doing.numbers)
        if doing.kind == BLOCK:
            return self._blocked(decision, doing.numbers)
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

    def _blocked(self, decision: Decision, numbers: Sequence[int]) -> Action | None:
        """The next step towards boards in the openings `numbers`; None where one stands in each, or none is left."""
        world = self._base.world
        open_ = inlets_of(world)
        left = [number for number in numbers if number in open_]
        boards = [board for board in free_boards(world) if (FETCH, board) not in self._chooser.others]
        if not left or not boards:
            return None
        held = -1 if decision.held is None else decision.index(decision.held)
        if held in boards:
            return Action(SET_BOARD, self._truth.env.stage.doors.names[left[0]])
        places = world.position[0, boards, :2].cpu().numpy()
        return self._fetched(decision, boards[int(np.hypot(*(places - open_[left[0]]).T).argmin())])

    def _fought(self, decision: Decision, numbers: Sequence[int]) -> Action | None:
        """The next jet at the nearest of the seats `numbers` that still burns; None where none does, or none helps."""
        held = -1 if decision.held is None else decision.index(decision.held)
        burning = {seat.number for seat in seats_of(self._base)}
        left = [number for number in numbers if number in burning]
        if not left or held < 0 or charge_of(self._base, held) <= 0.0:
            return None
        found = self._aim(left[0], np.array(decision.agent_position), held)
        if found < 0:
            self._failures[OUT, tuple(numbers)] = TRIES
            return None
        self._truth.also = {found}
        return Action(EXTINGUISH, decision.names[found])

    def _aim(self, seat: int, here: Array, held: int) -> int:
        """The thing to name, along B, for putting out the flames of a seat that are next from `here` [m]; -1: none."""
        fire, world = fire_of(self._base.episode), self._base.world
        assert fire is not None and self._scene is not None
        burns = np.concatenate([seats.flames(fire, world.frame)[0].cpu(), seats.alight(fire, world)[0].cpu()]) == seat
        every = torch.cat([fire.flame_place, world.position], 1)[0].cpu().numpy().astype(np.float64)
        flames, places = every[burns], every[-world.num_bodies :]
        if not len(flames):
            return -1
        ways = self._scene.ways.frames(flames[:, :2], here)
        nearest = flames[int(np.argmin(ways))]
        there = (world.exists & ~world.away & ~world.held)[0].cpu().numpy()
        there &= ~hidden(world, places, nearest)
        gaps = np.where(there, np.hypot(*(places - nearest)[:, :2].T), np.inf)
        best = int(np.argmin(gaps))
        return best if gaps[best] < AROUND else -1
