"""Rescues in the sketch with what learners need besides: observations, rewards, and how episodes end."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from hazard_ms.sketch.environments.choices import Choices, Played
from hazard_ms.sketch.rescues.looking import target_site
from hazard_ms.sketch.rescues.menu import distances
from hazard_ms.sketch.rescues.scene import Bools, Floats
from hazard_ms.skills.options.rewards import PAPER, REWARDS, VALUE, paper, potential
from hazard_ms.spec.checks import one_of


class Rewarded:
    """N rescues, observed and rewarded as those of the simulator are."""

    def __init__(self, choices: Choices, reward: str = VALUE) -> None:
        """Take the `choices` of N rescues. Raises ValueError for an unknown `reward`."""
        self.choices, self.sketch = choices, choices.sketch
        self._reward = one_of(reward, REWARDS, "reward")
        self._potential = np.zeros(len(self.sketch.state.frame))

    def reset(self, scene: ArrayLike, seeds: ArrayLike, rows: ArrayLike | None = None) -> None:
        """Begin the episodes of `seeds` [R] in the scenes with the numbers `scene` [R], at `rows` [R]: all if None."""
        self.sketch.reset(scene, seeds, rows)
        if self._reward == PAPER:
            which = slice(None) if rows is None else np.asarray(rows, np.int64)
            self._potential[which] = self.potential()[which]

    def step(self, chosen: ArrayLike) -> tuple[Floats, Bools, Bools, Played]:
        """Take the choices `chosen` [N], columns of masks [N, A].

        Returns the rewards, whether each episode is terminated, or truncated by its end of time, [N] each, and more
        about each choice. Raises ValueError for anything but numbers of choices.
        """
        played = self.choices.step(chosen)
        gained, ended = played.gained, played.over & (self.everything_safe() | played.stopped)
        if self._reward == PAPER:
            before, self._potential = self._potential, self.potential()
            gained = paper(before, self._potential, played.allowed)
        return gained, ended, played.over & ~ended, played

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
        missing = there & ~safe & (np.arange(there.shape[1]) != state.held[:, None])
        to_target = _nearest(distances(stack, state, site), missing)
        to_cart = _nearest(distances(stack, state, stack.cart_site[state.scene]), carts)
        return potential((safe & there).sum(axis=1), holding, carts.any(axis=1), to_target, to_cart)


def _nearest(away: Floats, which: Bools) -> Floats:
    """The least of the distances `away` [N, K] [m] at `which` [N, K], 0 where there is none: [N]."""
    least = np.where(which, away, np.inf).min(axis=1, initial=np.inf)
    return np.where(np.isfinite(least), least, 0.0)
