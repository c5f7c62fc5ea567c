"""Rescues in the sketch with what learners need besides: observations, rewards, and how episodes end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.rescues.looking import target_site
from hazard_ms.sketch.rescues.menu import distances
from hazard_ms.sketch.rescues.scene import Bools, Floats
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import END, FIRST
from hazard_ms.skills.options.rewards import PAPER, REWARDS, VALUE, paper, potential
from hazard_ms.spec.checks import one_of


class Rewarded:
    """N rescues of a `sketch`, observed and rewarded as those of the simulator are."""

    def __init__(self, sketch: Sketch, ranges: Sequence[tuple[float, float]], reward: str = VALUE) -> None:
        """Take a `sketch`; `ranges`: ends of each hazard's usual level, in its unit.

        Raises ValueError for an unknown `reward`.
        """
        self.sketch, self.encoder = sketch, SketchEncoder(ranges)
        self._reward = one_of(reward, REWARDS, "reward")
        self._potential = np.zeros(len(sketch.state.frame))

    def reset(self, scene: ArrayLike, seeds: ArrayLike, rows: ArrayLike | None = None) -> None:
        """Begin the episodes of `seeds` [R] in the scenes with the numbers `scene` [R], at `rows` [R]: all if None."""
        self.sketch.reset(scene, seeds, rows)
        if self._reward == PAPER:
            which = slice(None) if rows is None else np.asarray(rows, np.int64)
            self._potential[which] = self.potential()[which]

    def observe(self) -> NDArray[np.float32]:
        """The features of all rescues, [N, F]."""
        return self.encoder.encode(self.sketch.stack, self.sketch.state, self.sketch.slots)

    def step(self, option: ArrayLike) -> tuple[Floats, Bools, Bools]:
        """Play `option` [N], one of those of masks [N, A].

        Returns the rewards, and whether each episode is terminated, or truncated by its end of time, [N] each.
                Raises ValueError for anything but numbers of options.
        """
        chosen, everyone = np.asarray(option), np.arange(len(self._potential))
        mask = self.sketch.mask
        gained, over = self.sketch.step(chosen)
        allowed = mask[everyone, chosen]
        ended = over & (self.everything_safe() | (allowed & (chosen == FIRST[END])))
        if self._reward == PAPER:
            before, self._potential = self._potential, self.potential()
            gained = paper(before, self._potential, allowed)
        return gained, ended, over & ~ended

    def everything_safe(self) -> Bools:
        """Whether all targets of each rescue are safe, [N]."""
        state = self.sketch.state
        return np.asarray(((state.rescued_at >= 0) | (state.value == 0.0)).all(axis=1))

    def potential(self) -> Floats:
        """The potential of the reward `paper`, [N]."""
        stack, state = self.sketch.stack, self.sketch.state
        there, safe, holding = stack.there[state.scene], state.rescued_at >= 0, state.held >= 0
        row, target = (part.ravel() for part in np.indices(there.shape))
        site = target_site(stack, state, row, target, state.frame[row]).reshape(there.shape)
        carts = stack.cart_there[state.scene]
        to_target = _nearest(distances(stack, state, site), there & ~safe)  # with a bag, hands are empty here
        to_cart = _nearest(distances(stack, state, stack.cart_site[state.scene]), carts)
        return potential((safe & there).sum(axis=1), holding, carts.any(axis=1), to_target, to_cart)


def _nearest(away: Floats, which: Bools) -> Floats:
    """The least of the distances `away` [N, K] [m] at `which` [N, K], 0 where there is none: [N]."""
    least = np.where(which, away, np.inf).min(axis=1, initial=np.inf)
    return np.where(np.isfinite(least), least, 0.0)
