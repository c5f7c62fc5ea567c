"""The sketch: N rescues at once in numpy, with the options of `hazard_ms.skills.options`, without a simulator.

    option        what happens
    target i      walk to where it was last seen, or to where it can be met; pick up; with a bag: put it in
    cart c        walk to it and let go of what is in the hand over it
    landmark l    walk there and look around
    look          look around
    stop          the episode ends
    fire f        fetch an extinguisher, walk to the fire, put it out
    tool          fetch an extinguisher

Ways, sight and fates come from scenes (`hazard_ms.sketch.rescues.scene`), times of skills from tables. Nothing that the
robot does changes the hazard, unless it puts out a fire, and nothing is pushed aside. A rescue is a function of its
scene, its seed and its options: it goes the same alone as among thousands. The rewards of an episode add up to its
score: Value, or what is averted where there are fires to put out (`hazard_ms.sketch.fires.fates`).
"""

from __future__ import annotations

import copy
from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import ArrayLike

from hazard_ms.simulation.chance import Chance
from hazard_ms.sketch.fires.fates import averted
from hazard_ms.sketch.rescues import menu
from hazard_ms.sketch.rescues.looking import stands
from hazard_ms.sketch.rescues.playing import DRAWS, Options
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, SketchScene, Stack
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain, Rescues
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.skills.options.environment import IDLE
from hazard_ms.skills.options.options import END, FIRST, TARGET_SLOTS


class Sketch(Options):
    """Many rescues at once: `state` tells all about them, `mask` [N, A] what can be chosen, `step` plays an option."""

    def __init__(
        self,
        scenes: Sequence[SketchScene],
        times: SkillTimes,
        count: int,
        domain: Domain = AS_MEASURED,
        stop: bool = True,
    ) -> None:
        """Make `count` rescues in worlds out of `domain`, to be begun with `reset`; `stop`: whether they can be ended.

        Raises ValueError for no scenes, for scenes with different hazards, and for a count below 1.
        """
        if count < 1:
            raise ValueError(f"count must be at least 1, got {count}")
        self.stack, self.times, self.domain, self._stop = Stack(scenes), times, domain, stop
        self.state, self._chance = Rescues.allocate(count, self.stack), Chance(count)
        self._menu()

    def reset(self, scene: ArrayLike, seeds: ArrayLike, rows: ArrayLike | None = None) -> None:
        """Begin the episodes of `seeds` [R] in the scenes with the numbers `scene` [R], at `rows` [R]: all if None.

        Raises ValueError for numbers of another shape, and for scene numbers out of range.
        """
        which = np.arange(len(self.state.frame)) if rows is None else np.asarray(rows, np.int64)
        scenes, drawn = np.asarray(scene, np.int64), np.asarray(seeds, np.int64)
        menu.refuse_start(scenes, drawn, which, len(self.stack.names))
        self._chance.restart(torch.from_numpy(which), torch.from_numpy(drawn))
        chance, state = self._draw("sketch.domain", 2 + 2 * TARGET_SLOTS)[which], self.state
        state.restart(which, scenes, self.stack, chance, self.domain)
        state.stand[which] = stands(self.stack, scenes, state.place[which])
        self._look(which, state.place[which][:, None], state.heading[which][:, None], state.frame[which][:, None])
        self._menu()

    def fork(self, rows: Ints, seeds: ArrayLike) -> Sketch:
        """Copies of the rescues `rows` [R] as they are now, with the chance of `seeds` [R] from here on."""
        made = copy.copy(self)
        made.state, made._chance = self.state.copies(rows), Chance(len(rows))
        made._chance.restart(torch.arange(len(rows)), torch.from_numpy(np.asarray(seeds, np.int64)))
        made._menu()
        return made

    def step(self, option: ArrayLike) -> tuple[Floats, Bools]:
        """Play `option` [N], one of those of `mask` [N, A]: the rewards, [N], and whether each episode is over, [N].

        An option that cannot be chosen costs a few frames; what is over stays as it is. Raises ValueError for anything
        but numbers of options.
        """
        chosen = menu.checked(option, *self.mask.shape)
        state, before, started = self.state, self.state.score.copy(), self.state.frame.copy()
        allowed = self.mask[np.arange(len(chosen)), chosen]
        self._chance.tick()
        self._luck = self._draw("sketch.skill", DRAWS)
        rows = np.flatnonzero(allowed)
        self._play(rows, chosen[rows])
        self._settle(started, allowed & (chosen == FIRST[END]))
        return state.score - before, state.over.copy()

    def _settle(self, started: Ints, stopped: Bools) -> None:
        """End a step that began at the frames `started` [N]: what took no time takes IDLE, unless it `stopped` [N]."""
        state, limit = self.state, self.stack.max_frames[self.state.scene]
        state.frame[~state.over & (state.frame == started) & ~stopped] += IDLE
        state.frame = np.minimum(state.frame, limit)
        self._drift_in()
        if self.stack.measures:
            state.score = averted(self.stack, state)
        done = ((state.rescued_at >= 0) | (state.value == 0.0)).all(axis=1)
        state.over |= (state.frame >= limit) | done | stopped
        self._menu()

    def _drift_in(self) -> None:
        """Count the targets that the hazard itself brought to a safe place, if nobody took them before."""
        state, safe_at = self.state, self.stack.safe_at[self.state.scene]
        if (safe_at >= 0).any():
            safe = (safe_at >= 0) & (safe_at <= state.frame[:, None]) & (state.rescued_at < 0) & (state.laid < 0)
            safe &= ~state.over[:, None] & (np.arange(self._targets) != state.held[:, None])
            rows, target = np.nonzero(safe)
            damaged = self.stack.damaged_at[state.scene[rows], target]
            state.spoiled[rows, target] = (damaged >= 0) & (damaged <= safe_at[rows, target])
            state.rescue(rows, target, safe_at[rows, target])
