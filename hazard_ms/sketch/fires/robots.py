"""N robots of the sketch: how they walk, look, let time pass, and handle extinguishers and fires.

What they know and do is in the state of the rescues; what options are made of that is for `hazard_ms.sketch.world`.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.simulation.chance import Chance
from hazard_ms.sketch.fires.seeing import flames_at, look_for_fires
from hazard_ms.sketch.rescues.looking import look, stands
from hazard_ms.sketch.rescues.pursuit import ahead, journey
from hazard_ms.sketch.rescues.scene import LOOKS, Bools, Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Domain, Rescues
from hazard_ms.sketch.skill_times import NO_PATH, SkillTimes
from hazard_ms.skills.motor.walking import WALK_FRAMES
from hazard_ms.skills.options.fires import TOOL_GIVE_UP
from hazard_ms.skills.options.macros import LEGS
from hazard_ms.skills.options.options import CART_SLOTS, TARGET_SLOTS

WALK_BUDGET = LEGS * WALK_FRAMES  # frames after which an approach is given up
THINGS = TARGET_SLOTS + CART_SLOTS  # targets and carts that a scene can have: landmarks are numbered from there
# Frames of handling an extinguisher [measured with Fetch: hazard_ms.agents.mitigating.costs]
PUT_DOWN, PIN, FACED = 85.0, 60.0, 50.0
PER_FLAME = 1.0 / 18.0  # flames that the jet puts out in a frame of discharge [measured: 18 with 1 to 9 flames]
BETWEEN = 1.6  # frames that a fight takes for each frame of discharge, with ways between flames [measured]
GROWTH = np.log(2.0) / 280.0  # share by which flames become more in a frame [measured: twice as many in 280]
LOSING = 0.95  # share of the jet's rate from which flames grow back as fast as they are put out [ours]
QUENCHED = 0.9  # share of attempts to put out a fire that work where there is charge for it [ours]
TAKING, TAKEN = 38.0, 0.95  # frames of picking up an extinguisher [measured: 34 to 40], and how often it works [ours]


class Robots:
    """The robots of N rescues; `Sketch` gives them options."""

    stack: Stack
    times: SkillTimes
    domain: Domain
    state: Rescues
    _chance: Chance
    _luck: Floats  # uniform numbers of a step, [N, DRAWS]

    @property
    def _targets(self) -> int:
        """Number of targets of the scene that has most."""
        return int(self.stack.value.shape[1])

    def _pass(self, rows: Ints, frames: Floats) -> Bools:
        """Let `frames` [R] at usual pace pass; whether the episode lasts so long, [R]."""
        after = self.state.frame[rows] + np.rint(frames * self.state.pace[rows]).astype(np.int64)
        limit = self.stack.max_frames[self.state.scene[rows]]
        self.state.frame[rows] = np.minimum(after, limit)
        return after <= limit

    def _walk(self, rows: Ints, goal: Ints, most: Floats | int = WALK_BUDGET) -> Bools:
        """Walk to the sites `goal` [R] for `most` frames, with looks on the way; whether the robot arrived, [R]."""
        state, scene = self.state, self.state.scene[rows]
        frames = ahead(self.stack, state, rows, goal) * state.pace[rows]
        none = ~np.isfinite(frames)
        room = self.stack.max_frames[scene] - state.frame[rows]
        spent = np.minimum(np.where(none, 0.0, np.minimum(frames, most)), room)
        share = np.where(none, 0.0, np.where(frames > 0.0, spent / np.maximum(frames, 1e-9), 1.0))
        if none.any():
            nothing, sure = np.zeros(len(rows)), np.ones(len(rows))
            lost = self.times.draw(NO_PATH, self._luck[rows, 4:], nothing, nothing, sure)[1]
            spent = np.where(none, np.minimum(lost * state.pace[rows], room), spent)
        there, some = share == 1.0, np.flatnonzero(~none & (frames > 0.0))
        self._travel(rows[some], goal[some], share[some], spent[some])
        state.frame[rows] += np.rint(spent).astype(np.int64)
        state.site[rows[some]] = np.where(there, goal, -1)[some]
        return there

    def _travel(self, rows: Ints, goal: Ints, share: Floats, spent: Floats) -> None:
        """Move along the first `share` [R] of the ways to the sites `goal` [R], and look on the way."""
        points, facing = journey(self.stack, self.state, rows, goal, share)
        passed = np.rint(spent[:, None] * np.arange(1, LOOKS + 1) / LOOKS).astype(np.int64)
        self._look(rows, points, facing, self.state.frame[rows][:, None] + passed)
        self.state.place[rows], self.state.heading[rows], self.state.missed[rows] = points[:, -1], facing[:, -1], -1
        self.state.stand[rows] = stands(self.stack, self.state.scene[rows], points[:, -1])

    def _look(self, rows: Ints, points: Floats, facing: Floats | None, frame: Ints) -> None:
        look(self.stack, self.state, rows, points, facing, frame, self._overlooked(rows, frame))
        if self.stack.measures:
            look_for_fires(self.stack, self.state, rows, points, facing, frame)

    def _overlooked(self, rows: Ints, frame: Ints) -> Bools | None:
        """The things that looks at `frame` [R, Q] do not show although they are in sight, [R, J]; None: there are none.

        They do so by chance, as `domain` says.
        """
        if self.domain.missed == 0.0:
            return None
        targets, carts, marks = self._targets, self.stack.cart_site.shape[1], self.stack.landmark_site.shape[1]
        columns = np.r_[:targets, TARGET_SLOTS : TARGET_SLOTS + carts, THINGS : THINGS + marks]
        return np.asarray(self._draw("sketch.sight", THINGS + marks)[rows][:, columns] < self.domain.missed)

    def _draw(self, stream: str, count: int) -> Floats:
        return self._chance.uniform(stream, count).numpy().astype(np.float64)

    # ------------------------------------------------------------------ extinguishers and fires

    def nearest_tool(self) -> Ints:
        """The extinguisher in the hand, else the nearest known one that is not empty; -1 for none, [N]."""
        state, stack = self.state, self.stack
        everyone = np.arange(len(state.frame))
        if not state.tool_site.shape[1]:
            return np.full(len(everyone), -1)
        open_ones = state.tool_known & (state.tool_left > 0.0) & (state.tool_failures < TOOL_GIVE_UP)
        off = stack.position[state.scene[:, None], state.tool_site] - state.place[:, None]
        away = np.where(open_ones & stack.tool_there[state.scene], np.hypot(off[..., 0], off[..., 1]), np.inf)
        best = np.argmin(away, axis=1)
        best = np.where(np.isfinite(away[everyone, best]), best, -1)
        held = state.armed >= 0
        ready = held & (state.tool_left[everyone, state.armed] > 0.0)
        return np.where(ready, state.armed, best)

    def _lay_down(self, rows: Ints) -> None:
        """Put down the tools in the hands of `rows` [R], where there are any; they lie at the site of the robot."""
        state = self.state
        some = rows[state.armed[rows] >= 0]
        self._pass(some, np.full(len(some), PUT_DOWN))
        there = some[state.site[some] >= 0]
        state.tool_site[there, state.armed[there]] = state.site[there]
        state.armed[some] = -1

    def _arm(self, rows: Ints, _: Ints | None = None) -> Bools:
        """Walk to the nearest extinguisher and take it, unless one is in the hand; whether that worked, [R]."""
        state, tool = self.state, self.nearest_tool()[rows]
        worked = (tool >= 0) & (state.armed[rows] == tool)
        going = np.flatnonzero((tool >= 0) & ~worked)
        some, wanted = rows[going], tool[going]
        self._lay_down(some)
        arrived = self._walk(some, state.tool_site[some, wanted])
        luck = self._draw("sketch.tool", 1)[some, 0]
        taken = arrived & (luck < TAKEN * state.ease[some])
        taken &= self._pass(some, np.where(arrived, TAKING, 0.0))
        state.tool_failures[some, wanted] += ~taken
        state.armed[some[taken]] = wanted[taken]
        worked[going] = taken
        state.looked[rows] = False
        return worked

    def _put_out(self, rows: Ints, fire: Ints) -> None:
        """Fetch an extinguisher unless one is in the hand, walk to the `fire` [R], and put it out."""
        state, stack = self.state, self.stack
        ready = self._arm(rows)
        some, own = rows[ready], fire[ready]
        arrived = self._walk(some, stack.fire_site[state.scene[some], own])
        some, own = some[arrived], own[arrived]
        flames = flames_at(stack, state, some, state.frame[some])[np.arange(len(some)), own]
        left = state.tool_left[some, state.armed[some]]
        ratio = GROWTH * flames / PER_FLAME
        jet = np.where(ratio < LOSING, -np.log(1.0 - np.minimum(ratio, LOSING)) / GROWTH, np.inf)
        pin = np.where(left >= stack.tool_charge[state.scene[some], state.armed[some]], PIN, 0.0)
        luck = self._draw("sketch.fire", 1)[some, 0] < QUENCHED * state.ease[some]
        done = (jet <= left) & luck
        used = np.minimum(jet, left)
        in_time = self._pass(some, FACED + pin + BETWEEN * used)
        state.tool_left[some, state.armed[some]] -= used
        out = done & in_time
        state.out_at[some[out], own[out]] = state.frame[some[out]]
        state.fire_frame[some, own], state.fire_flames[some, own] = state.frame[some], flames
        failed = ~(state.out_at[rows, fire] >= 0)
        state.fire_failures[rows[failed], fire[failed]] += 1
        state.looked[rows] = False
