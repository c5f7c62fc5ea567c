"""The oracle's knowledge of a gale: where each thing is blown, which places keep it, and which rescues are needed.

A target is at stake if the wind will have moved it when time is up: by the record of the episode in which nobody acts
if nobody has touched it, else by the course of the wind and what the thing withstands. What is not at stake need not be
rescued: where it lies it counts as rescued.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.gale.carts import BEAM, MOST_LABELS, Push, Pushing
from hazard_ms.agents.gale.course import Array, Course, Front, Lees, kept
from hazard_ms.agents.gale.sites import DETOUR, OnGround, Sites, sites
from hazard_ms.agents.gale.stops import PUT_DOWN, SEEKING, put_away
from hazard_ms.hazards.places import MOVED
from hazard_ms.hazards.wind.endurance import endurance
from hazard_ms.hazards.wind.gale import WINDS, Gale
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, straight_line
from hazard_ms.sketch.rescue_problem import TURNING, Outset, RescueScene
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.motor.walking import ARRIVED

if TYPE_CHECKING:
    from hazard_ms.sketch.timeline import Timeline

AVERTED = 1.1  # what a rescue counts for, of the target's value: all that would be lost, and a tenth beside [ours]
LOW = 0.15  # height of the middle of what lies on the ground [m] [ours]
EVERY = 2  # of the cells of the floor, along each side, in which a site is looked for [ours]
ROLLING = ("bottle", "soda_can")  # what rolls off where it was put down: into carts alone [ours]


class _Told(NamedTuple):
    """The arguments of `GaleTruth.problem`."""

    record: Timeline
    targets: NDArray[np.int64]
    values: Array
    carts: NDArray[np.int64]
    outset: Outset
    delays: Array
    fading: float
    spread: float


def hazard_of(base: Any) -> Gale | None:
    """The gale of the running environment `base`; None where none blows."""
    return next((hazard for hazard in base.task.hazards if isinstance(hazard, Gale)), None)


class GaleTruth:
    """The true course of the gale in a running environment, whose robot plans as `scene` says."""

    def __init__(self, base: Any, hazard: Gale, scene: RescueScene, mitigate: bool) -> None:
        """`mitigate`: whether things may be put into the lee, and carts be pushed."""
        self._base, self._hazard, self._scene, self._mitigate = base, hazard, scene, mitigate
        self._state = base.episode.states[hazard.name]
        self._seconds = float(base.control_timestep)
        self.note = ""  # on what `put_away` chose
        self.idle = False  # whether it leaves measures alone for now
        self._course = course_of(hazard, self._state, base.world, scene.limit * self._seconds)
        self._withstands = withstands(self._state, base.world)
        self._pushing = Pushing() if mitigate else None
        self._start = self._state.place[0].cpu().numpy().copy()
        ways = scene.ways
        cells = np.argwhere(ways.free)
        self._ground_at, self._ground_pressure = -1, np.zeros(0)  # frame of the pressures on the ground [m^2/s^2]
        self._ground = ways.origin + (cells[(cells % EVERY == 0).all(1)][:, ::-1] + 0.5) * ways.cell

    def at_stake(self, record: Timeline) -> NDArray[np.bool_]:
        """Whether the wind will have carried off each thing when time is up if nobody touches it any more, bool [B]."""
        world, things = self._base.world, slice(len(record.names))
        place = self._state.place[0, things].cpu().numpy()
        untouched = np.linalg.norm(place - self._start[things], axis=-1) < 1e-3
        end = record.position_at(record.frames[-1])
        left = np.linalg.norm(end - place, axis=-1) > MOVED
        stays = self._pressure(world.position[0, things].cpu().numpy()) <= self._withstands[things]
        strayed = self._hazard.carried_off(self._state, world)[0, things].cpu().numpy()
        held, safe = (part[0, things].cpu().numpy() for part in (world.held, world.safe))
        return (np.where(untouched, left, ~stays) | strayed | held) & ~safe

    def future(self, record: Timeline) -> Timeline:
        """The `record` of the episode in which nobody acts, from now on, with every thing as far off as it is now.

        What is not at stake rests.
        """
        now, world = int(self._base.world.frame[0]), self._base.world
        near = min(int(np.searchsorted(record.frames, now, "right")) - 1, len(record.offsets) - 1)
        moving = self.at_stake(record) & ~world.held[0, : len(record.names)].cpu().numpy()
        offsets = (record.offsets[near:] - record.offsets[near]) * moving[record.moves][None, :, None]
        start = world.position[0, : len(record.names)].cpu().numpy()
        return dataclasses.replace(
            record, first=int(record.frames[near]), start=start, offsets=offsets.astype(np.float16)
        )

    def problem(
        self,
        record: Timeline,
        targets: NDArray[np.int64],
        values: Array,
        carts: NDArray[np.int64],
        outset: Outset,
        delays: Array,
        fading: float,
        spread: float,
    ) -> Problem:
        """The problem of rescuing `targets`, indices [T] along B, worth `values` [T], from `outset` on.

        Sites in the lee follow the carts. Other arguments are those of `RescueScene.problem`.
        """
        self._told = _Told(record, targets, values, carts, outset, delays, fading, spread)
        return self._problem(self._told, {})

    def _problem(self, told: _Told, moved: Mapping[int, Array]) -> Problem:
        """The problem that was `told`, with some carts, by index along B, at other places [m], [2]."""
        record, targets, values, carts, outset, delays, fading, spread = told
        future, scene = self.future(record), self._scene
        ways = future.positions(targets)[..., :2].astype(np.float64)
        rest = self._base.world.position[0, carts.tolist(), :2].cpu().numpy().astype(np.float64)
        for row, cart in enumerate(carts.tolist()):
            rest[row] = moved.get(cart, rest[row])
        lee = self._sites(targets, ways[0])
        walk = straight_line(WALK * DETOUR)
        moving = MovingTravel(future.frames, ways, np.asarray(outset.place), walk, np.vstack([rest, lee.places]))
        holding = None if outset.holding is None else targets.tolist().index(outset.holding)
        saved = WALK * ARRIVED - TURNING
        return Problem(
            OnGround(moving, lee.keep, holding),
            values=(AVERTED * values * self.at_stake(record)[targets]).tolist(),
            damaged_at=[np.inf] * len(targets),
            pick=np.maximum(scene.pick + delays - saved, 0.0).tolist(),
            drop=[max(0.0, scene.cart - saved)] * len(carts) + [PUT_DOWN + SEEKING] * len(lee.places),
            limit=float(max(scene.limit, outset.frame)),
            frame=float(outset.frame),
            fading=fading,
            spread=spread,
            holding=holding,
        )

    def measure(
        self, decision: Decision, problem: Problem, carts: NDArray[np.int64], failures: Mapping[str, int]
    ) -> Action | None:
        """The next action that pushes a cart or, with something in the hand, puts it into the lee; None: neither.

        `problem` is the one that `problem` gave last; `carts`, [M], and the rest are as for `put_away`.
        """
        if self.idle:
            return None
        if decision.held is not None:
            return self.put_away(decision, carts, failures)
        return None if self._pushing is None else self._push(decision, problem, self._pushing)

    def _push(self, decision: Decision, problem: Problem, pushing: Pushing) -> Action | None:
        now = self._told

        def after(push: Push) -> float:
            then = Outset((float(push.robot[0]), float(push.robot[1])), None, now.outset.frame + round(push.frames))
            late = self._problem(now._replace(outset=then, fading=0.0), {push.cart: push.place})
            return solve(late, MOST_LABELS, BEAM).value

        def plain() -> float:  # that skills fail delays rescues with a push and without it alike
            return solve(dataclasses.replace(problem, fading=0.0), MOST_LABELS, BEAM).value

        names = [decision.names[target] for target in now.targets.tolist()]
        action = pushing.choose(decision, names, plain, after)
        self.note = pushing.note
        return action

    def put_away(self, decision: Decision, carts: NDArray[np.int64], failures: Mapping[str, int]) -> Action | None:
        """The next action that puts the held thing into the lee.

        None where no place keeps it, or where a cart is better, of those whose indices along B are `carts`, [M], and
        that have no `failures`.
        """
        assert decision.held is not None
        index = decision.index(decision.held)
        if not self._may_lie(index):
            return None
        nearest, work = np.inf, [int(cart) for cart in carts if not failures.get(decision.names[cart])]
        if work:
            places = self._base.world.position[0, work, :2].cpu().numpy().astype(np.float64)
            frames = self._scene.ways.frames(np.array([decision.agent_position]), places) + self._scene.cart
            nearest = float(frames.min())

        def keeps(points: Array) -> NDArray[np.bool_]:
            raised = np.hstack([points, np.full((len(points), 1), LOW)])
            return kept(self._pressure(raised), self._withstands[index])

        found = put_away(decision, self._scene.ways.radius, keeps, nearest)
        if found is None:
            return None
        self.note = f"into the lee by {found.action}, {found.frames:.0f} frames"
        return found.action

    def _may_lie(self, index: int) -> bool:
        return self._mitigate and self._base.specs[0].things[index].category not in ROLLING

    def _sites(self, targets: NDArray[np.int64], goals: Array) -> Sites:
        """Sites on the ground near the places of `targets` now, `goals` [m], [T, 2]."""
        now = int(self._base.world.frame[0])
        if self._ground_at != now:
            raised = np.hstack([self._ground, np.full((len(self._ground), 1), LOW)])
            self._ground_at, self._ground_pressure = now, self._pressure(raised)
        pressure = self._ground_pressure
        good = np.stack([kept(pressure, self._withstands[t]) & self._may_lie(t) for t in targets.tolist()])
        return sites(self._ground, good, goals)

    def _pressure(self, points: Array) -> Array:
        return self._course.pressure(points.astype(np.float64), float(self._base.world.frame[0]) * self._seconds)


def course_of(hazard: Gale, state: Any, world: Any, end: float) -> Course:
    """The course of the gale in environment 0, whose episode ends after `end` [s]."""
    parts = {part: [getattr(state, f"{name}_{part}")[0].cpu().numpy() for name in WINDS] for part in ("loss", "cause")}
    flows = [getattr(state, f"{n}_speed")[0] * getattr(state, f"{n}_heading")[0] for n in WINDS]
    front = Front(
        float(state.onset[0]),
        tuple(state.way[0].tolist()),
        float(state.pace[0]),
        tuple((0.5 * world.room[0]).tolist()),
        hazard.rise,
        hazard.turning,
    )
    lees = Lees(state.corner[0].cpu().numpy(), *(np.stack(parts[part]).astype(np.float64) for part in parts))
    return Course(np.stack([flow.cpu().numpy() for flow in flows]).astype(np.float64), lees, front, end)


def withstands(state: Any, world: Any) -> Array:
    """The pressure from which each thing of environment 0 slides [m^2/s^2], [B]."""
    rows = (world.mass, world.extent, state.strength, state.felt)
    return np.array([endurance(*row) for row in zip(*(part[0].tolist() for part in rows), strict=True)])
