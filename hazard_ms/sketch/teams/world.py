"""The sketch of teams: N rescues at once, in each of which R robots play options, each by its own clock.

A robot is a row of `state`: those of rescue n are the rows n R to n R + R - 1. Each has its place, its hand, its clock,
and what it has seen; things, carts and what is rescued they share. The robot that is asked next in a rescue is the one
whose option ends first, of several the first; an option is played in one go, but for a target that is fetched: it is
picked up only once all that begins before the robot gets there is played. So a target goes to who is there first, and
who comes later fails. Robots see what another one holds no longer, and know what is rescued from that frame on. They
go through one another, tell one another nothing but what policies share, and put nothing out.

With one robot a rescue is that of `hazard_ms.sketch.world`, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import ArrayLike

from hazard_ms.simulation.chance import Chance
from hazard_ms.sketch.rescues import menu
from hazard_ms.sketch.rescues.looking import stands
from hazard_ms.sketch.rescues.playing import DRAWS, TRIES, Options
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, SketchScene, Stack
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain, Rescues
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.teams.starts import starts
from hazard_ms.skills.options.environment import IDLE
from hazard_ms.skills.options.options import END, FIRST, LOOK, TARGET_SLOTS
from hazard_ms.spec.checks import whole
from hazard_ms.spec.registry.robots import robot_class

MOST_ROBOTS = 4  # of a team, as in the simulator
MOST = 100_000  # rescues at once: any larger number must be a mistake [ours]
NEVER = np.iinfo(np.int64).max  # frame


class TeamSketch(Options):
    """Many rescues by teams: `rows` [N] are asked, `mask` [N R, A] says what they can choose, `step` plays it."""

    def __init__(
        self,
        scenes: Sequence[SketchScene],
        times: SkillTimes,
        count: int,
        robots: int,
        domain: Domain = AS_MEASURED,
        stop: bool = True,
    ) -> None:
        """Make N = `count` rescues by teams of R = `robots`, 1 to 4, to be begun with `reset`; the rest as for Sketch.

        Raises ValueError for numbers out of range, for no scenes or such with different hazards, and for scenes with
        fires to put out, or without room for the robots.
        """
        whole(count, 1, MOST, "count")
        self.robots = whole(robots, 1, MOST_ROBOTS, "robots")
        self.stack, self.times, self.domain, self._stop = Stack(scenes), times, domain, stop
        if self.stack.measures:
            raise ValueError(f"scenes of teams must have nothing to put out, got {', '.join(self.stack.names):.100}")
        self._starts = starts(self.stack, robots, robot_class(times.robot).build.radius)
        self.state, self._chance, rows = Rescues.allocate(count * robots, self.stack), Chance(count), count * robots
        self._luck = np.zeros((rows, DRAWS))
        self.over = np.ones(count, bool)  # [N]
        self.turn = np.zeros(count, np.int64)  # the robot of each rescue that is asked next, [N]
        self.saved_at = np.full((count, self._targets), -1)  # frame from which each target is safe, [N, T]; -1: never
        self._taken_at = np.full((count, self._targets), NEVER)  # frame in which it was last grasped for, [N, T]
        self._left_at = np.full((count, self._targets), NEVER)  # frame in which it was lost again after that, [N, T]
        self._taker = np.full((count, self._targets), -1)  # row of the robot that did, [N, T]
        self.aim = np.full(rows, -1)  # target that each robot fetches or holds, or -1, [N R]
        self._began = np.zeros(rows, np.int64)  # frame in which its option did, [N R]
        self._walks = np.zeros(rows, bool)  # whether its walk to its aim is not followed by anything yet, [N R]
        self._goal = np.zeros(rows, np.int64)  # site to which it walks, [N R]
        self._came = np.zeros(rows, bool)  # whether it gets there, [N R]
        self._tries = np.zeros(rows, np.int64)  # walks of its option so far, [N R]
        self._stopped = np.zeros(rows, bool)  # [N R]
        # what each robot knew when it was last asked: where it was [m], and the sites of targets, -1 for others
        self.asked_place, self.asked_site = np.zeros((rows, 2)), np.full((rows, self._targets), -1)
        self._menu()

    @property
    def rows(self) -> Ints:
        """The rows of the robots that are asked, one of each rescue, [N]."""
        return np.arange(len(self.over)) * self.robots + self.turn

    @property
    def score(self) -> Floats:
        """The Value of each rescue so far, [N], 0 to 1."""
        return np.asarray(self.state.score.reshape(-1, self.robots).sum(axis=1), np.float64)

    def reset(self, scene: ArrayLike, seeds: ArrayLike, which: ArrayLike | None = None) -> None:
        """Begin the episodes of `seeds` [B] in the scenes with the numbers `scene` [B] in the rescues `which` [B].

        None: in all. Raises ValueError for numbers of another shape, and for scene numbers out of range.
        """
        teams = np.arange(len(self.over)) if which is None else np.asarray(which, np.int64)
        scenes, drawn = np.asarray(scene, np.int64), np.asarray(seeds, np.int64)
        menu.refuse_start(scenes, drawn, teams, len(self.stack.names))
        self._chance.restart(torch.from_numpy(teams), torch.from_numpy(drawn))
        rows, state = (teams[:, None] * self.robots + np.arange(self.robots)).ravel(), self.state
        chance = self._draw("sketch.domain", 2 + 2 * TARGET_SLOTS)[rows]
        state.restart(rows, np.repeat(scenes, self.robots), self.stack, chance, self.domain)
        state.place[rows] = self._starts[scenes].reshape(-1, 2)
        state.site[rows[rows % self.robots > 0]] = -1
        state.stand[rows] = stands(self.stack, state.scene[rows], state.place[rows])
        self.over[teams], self.saved_at[teams] = False, -1
        self._taken_at[teams], self._left_at[teams], self._taker[teams] = NEVER, NEVER, -1
        self.aim[rows], self._walks[rows], self._stopped[rows] = -1, False, False
        self._look(rows, state.place[rows][:, None], state.heading[rows][:, None], state.frame[rows][:, None])
        self._note(rows)
        self._go_on()

    def step(self, option: ArrayLike) -> tuple[Floats, Bools]:
        """Play `option` [N], of `mask[rows]` [N, A]: the share of all that it saved, and whether each episode is over.

        [N] each. An option that cannot be chosen costs a few frames; what is over stays as it is. What a robot fetches
        counts in the step in which all that begins before it gets there is played. Raises ValueError for anything but
        numbers of options.
        """
        chosen = menu.checked(option, len(self.over), self.mask.shape[1])
        before, rows = self.score, self.rows
        allowed = ~self.over & self.mask[rows, chosen]
        self._chance.tick()
        self._luck[rows] = self._draw("sketch.skill", DRAWS)[rows]
        self._began[rows] = self.state.frame[rows]
        self._play(rows[allowed], chosen[allowed])
        self._stopped[rows[allowed & (chosen == FIRST[END])]] = True
        self._end(rows[~self.over & ~self._walks[rows]])
        self._go_on()
        return self.score - before, self.over.copy()

    def _go_on(self) -> None:
        """Go on to where a robot of each rescue is to be asked: whoever has walked up to something handles it."""
        state = self.state
        while True:
            self._drift_in()
            done = ((self.saved_at >= 0) | (state.value[:: self.robots] == 0.0)).all(axis=1)
            self.over |= done | state.over.reshape(-1, self.robots).all(axis=1)
            state.over |= np.repeat(self.over, self.robots)
            order = np.where(state.over, NEVER, 2 * state.frame + ~self._walks)  # in a frame, who walks goes first
            self.turn = order.reshape(-1, self.robots).argmin(axis=1)
            rows = self.rows
            self._hear(rows)
            due = rows[~self.over & self._walks[rows]]
            if not len(due):
                break
            self._handle(due)
        now = np.repeat(state.frame[rows], self.robots)
        self._note(np.flatnonzero((state.frame == now) & ~self._walks))  # others whose options end now look up, too

    def _note(self, rows: Ints) -> None:
        """Note what the robots of `rows` [K] know, whose options are over."""
        state = self.state
        self.aim[rows], self.asked_place[rows] = state.held[rows], state.place[rows]
        lies = state.known[rows, : self._targets] & (state.held[rows][:, None] != np.arange(self._targets))
        self.asked_site[rows] = np.where(lies, state.seen_site[rows], -1)
        self._menu()

    def _fetch(self, rows: Ints, target: Ints) -> None:
        """Set off to a target; what follows is for `_handle`."""
        self.aim[rows], self._goal[rows], self._tries[rows] = target, self.state.seen_site[rows, target], 0
        self._set_off(rows)

    def _set_off(self, rows: Ints) -> None:
        self._goal[rows], self._came[rows] = self._approach(rows, self.aim[rows], self._goal[rows])
        self._tries[rows] += 1
        self._walks[rows] = True

    def _handle(self, rows: Ints) -> None:
        """Pick up what robots have walked up to, or walk on to where it has gone; one row of a rescue at most."""
        target = self.aim[rows]
        here, again = self._arrive(rows, target, self._goal[rows], self._came[rows])
        again &= self._tries[rows] < TRIES
        self._walks[rows] = False
        self._set_off(rows[again])
        self._grasp(rows[~again], target[~again], here[~again])
        self._end(rows[~again])

    def _pick_up(self, rows: Ints, target: Ints) -> Bools:
        """As for one robot; what is picked up is there for no other one from the frame on in which that began."""
        began = self.state.frame[rows]
        worked = super()._pick_up(rows, target)
        got = rows[worked] // self.robots, target[worked]
        self._taken_at[got], self._left_at[got], self._taker[got] = began[worked], NEVER, rows[worked]
        return worked

    def _let_go(self, rows: Ints, skill: str) -> Bools:
        """As for one robot; what does not get into the bag or the cart is there for all again."""
        target = self.state.held[rows]
        safe = super()._let_go(rows, skill)
        self._left_at[rows[~safe] // self.robots, target[~safe]] = self.state.frame[rows[~safe]]
        return safe

    def _lies(self, rows: Ints, target: Ints) -> Bools:
        return ~self._elsewhere(rows, self.state.frame[rows])[np.arange(len(rows)), target]

    def _overlooked(self, rows: Ints, frame: Ints) -> Bools | None:
        missed = super()._overlooked(rows, frame)
        if missed is None:
            missed = np.zeros((len(rows), self.state.known.shape[1]), bool)
        missed[:, : self._targets] |= self._elsewhere(rows, frame[:, -1])
        return missed

    def _elsewhere(self, rows: Ints, frame: Ints) -> Bools:
        """The targets that another robot holds at `frame` [K], and those that are safe by then, [K, T]."""
        team, now = rows // self.robots, frame[:, None]
        away = (self._taken_at[team] <= now) & (now < self._left_at[team]) & (self._taker[team] != rows[:, None])
        return np.asarray(away | ((self.saved_at[team] >= 0) & (self.saved_at[team] <= now)))

    def _end(self, rows: Ints) -> None:
        """End options of `rows` [K], one of a rescue at most; what took no time takes IDLE, unless it was a stop."""
        state, limit, team = self.state, self.stack.max_frames[self.state.scene[rows]], rows // self.robots
        state.frame[rows] += np.where((state.frame[rows] == self._began[rows]) & ~self._stopped[rows], IDLE, 0)
        state.frame[rows] = np.minimum(state.frame[rows], limit)
        state.over[rows] |= self._stopped[rows] | (state.frame[rows] >= limit)
        self.saved_at[team] = np.maximum(self.saved_at[team], state.rescued_at[rows])
        for number in range(self.robots):
            other = team * self.robots + number
            state.laid[other], state.spoiled[other] = state.laid[rows], state.spoiled[rows]

    def _hear(self, rows: Ints) -> None:
        """Let the robots of `rows` [K] know what is rescued by now."""
        saved = self.saved_at[rows // self.robots]
        self.state.rescued_at[rows] = np.where(saved <= self.state.frame[rows][:, None], saved, -1)

    def _drift_in(self) -> None:
        """Count the targets that the hazard itself brought to a safe place, if nobody took them before."""
        state, safe_at = self.state, self.stack.safe_at[self.state.scene[:: self.robots]]
        if not (safe_at >= 0).any():
            return
        stopped, frame = self._stopped.reshape(-1, self.robots), state.frame.reshape(-1, self.robots)
        clock = np.where(self._walks, self._began, state.frame).reshape(-1, self.robots)
        played = np.where(stopped.all(axis=1), frame.max(axis=1), np.where(stopped, NEVER, clock).min(axis=1))
        held = (state.held[:, None] == np.arange(self._targets)).reshape(-1, self.robots, self._targets).any(axis=1)
        safe = (safe_at >= 0) & (safe_at <= played[:, None]) & (self.saved_at < 0) & ~held & ~self.over[:, None]
        team, target = np.nonzero(safe & (state.laid[:: self.robots] < 0))
        frame, rows = safe_at[team, target], team * self.robots
        damaged = self.stack.damaged_at[state.scene[rows], target]
        for number in range(self.robots):
            state.spoiled[rows + number, target] = (damaged >= 0) & (damaged <= frame)
        state.rescue(rows, target, frame)
        self.saved_at[team, target] = frame

    def _menu(self) -> None:
        super()._menu()
        if self.robots > 1:  # who waits for the others may look around as often as it likes
            self.mask[:, FIRST[LOOK]] = ~self.state.over

    def _draw(self, stream: str, count: int) -> Floats:
        return np.repeat(super()._draw(stream, count), self.robots, axis=0)
