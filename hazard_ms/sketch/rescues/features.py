"""Features of N rescues, made of what their robots know: the columns of `hazard_ms.skills.options.features`.

The sketch has no map. It leaves four columns at 0, MISSING, which policies that learn here must not read; walks are
those of the robot's real ways, not of ways over what was explored.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.fires.features import fires, tools
from hazard_ms.sketch.rescues.menu import edges
from hazard_ms.sketch.rescues.places import place_of
from hazard_ms.sketch.rescues.scene import Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.skills.options.feature_columns import SOON
from hazard_ms.skills.options.features import Encoder

MISSING = ("explored", "failed", "front")  # columns, or the beginnings of their names, that need a map or a memory


class SketchEncoder:
    """Encodes rescues as `Encoder` encodes decisions: the same tables, scales and bounds."""

    def __init__(self, ranges: Sequence[tuple[float, float]], measures: bool = False) -> None:
        """Make the encoder of a task; `ranges`: ends of each hazard's usual level, in its unit.

        `measures`: whether its options have measures about a fire.
        """
        self.layout = Encoder(ranges, 0.0, measures)
        ends = np.array(ranges, np.float64).reshape(-1, 2)
        self._low, self._span = ends[:, 0], ends[:, 1] - ends[:, 0]

    def encode(self, stack: Stack, state: Rescues, slots: Ints, tool: Ints | None = None) -> NDArray[np.float32]:
        """The features of all rescues: F dimensionless numbers each, float32 [N, F].

        `slots`: see `landmark_slots`; `tool`: see `Robots.nearest_tool`, [N]; None: there are none.
        """
        made = np.zeros((len(state.frame), self.layout.size), np.float32)
        parts = self.layout.split(made)
        tables = [
            ("targets", self._targets(stack, state)),
            ("carts", self._carts(stack, state)),
            ("landmarks", self._landmarks(stack, state, slots)),
            ("global", self._whole(stack, state)),
        ]
        if self.layout.measures and tool is not None:
            tables += [("fires", fires(stack, state)), ("tools", tools(stack, state, tool))]
        for table, quantities in tables:
            columns = self.layout.tables[table][1]
            scale, low, high = (np.array([getattr(c, n) for c in columns]) for n in ("scale", "low", "high"))
            parts[table][:, : quantities.shape[1]] = np.clip(quantities / scale, low, high)
        return made

    def _targets(self, stack: Stack, state: Rescues) -> Floats:
        """Rows of targets, [N, T, D]; what was never seen has only what agents are told."""
        targets = state.value.shape[1]
        held = np.arange(targets) == state.held[:, None]
        saved = state.rescued_at >= 0
        there = stack.there[state.scene]
        known = state.known[:, :targets] & ~held & ~saved & there  # what is taken away is forgotten
        told = [*np.moveaxis(stack.traits[state.scene], -1, 0)]
        columns = [
            known,
            held,
            saved & there,
            *place_of(stack, state, state.seen_site, known),
            state.value,
            *told,
            (state.seen_damaged & state.known[:, :targets]) | (state.spoiled & (saved | held)),
            *self._levels(state, known),
            np.where(known, state.frame[:, None] - state.seen_frame[..., 0], 0),
            state.failures[:, :targets],
        ]
        return np.stack([np.where(there, column, 0.0) for column in columns], axis=-1)

    def _levels(self, state: Rescues, known: NDArray[np.bool_]) -> list[Floats]:
        """Level of each hazard, and its rise in SOON frames, in turn, [N, T] each."""
        now, before = state.seen_level[:, :, 0], state.seen_level[:, :, 1]
        late, early = state.seen_frame[..., 0], state.seen_frame[..., 1]
        made = []
        for k, (low, span) in enumerate(zip(self._low, self._span, strict=True)):
            rise = (now[..., k] - before[..., k]) / span * SOON / np.maximum(late - early, 1)
            made += [
                np.where(known, (now[..., k] - low) / span, 0.0),
                np.where(known & (early >= 0), rise, 0.0),
            ]
        return made

    def _carts(self, stack: Stack, state: Rescues) -> Floats:
        """Rows of carts, [N, C, D]."""
        targets, carts = state.value.shape[1], stack.cart_site.shape[1]
        known = state.known[:, targets : targets + carts] & stack.cart_there[state.scene]
        place = place_of(stack, state, stack.cart_site[state.scene], known)
        return np.stack([known, *place, state.failures[:, targets:]], axis=-1).astype(np.float64)

    def _landmarks(self, stack: Stack, state: Rescues, slots: Ints) -> Floats:
        """Rows of the landmarks in `slots`, [N, L, D]."""
        offered, mark, row = slots >= 0, np.maximum(slots, 0), np.arange(len(slots))[:, None]
        if not stack.landmark_site.shape[1]:
            return np.zeros((*slots.shape, 5))
        site = stack.landmark_site[state.scene][row, mark]
        columns = [*place_of(stack, state, site, offered), edges(stack, state)[row, mark], state.visits[row, mark]]
        return np.stack([np.where(offered, column, 0.0) for column in columns], axis=-1)

    def _whole(self, stack: Stack, state: Rescues) -> Floats:
        """The row about the whole, [N, 1, D]; MISSING columns are 0."""
        limit, there = stack.max_frames[state.scene], stack.there[state.scene]
        targets = np.arange(state.value.shape[1])
        missing = there & (state.rescued_at < 0) & (targets != state.held[:, None])
        known = (missing & state.known[:, : len(targets)]).sum(axis=1)
        nothing = np.zeros(len(limit))
        columns = [
            state.frame / limit,
            limit - state.frame,
            state.held >= 0,
            stack.cart_there[state.scene].any(axis=1),
            known,
            missing.sum(axis=1) - known,
            (there & (state.rescued_at >= 0)).sum(axis=1),
            nothing,
            nothing,
            *(nothing for _ in self._low),
        ]
        return np.stack(columns, axis=-1)[:, None].astype(np.float64)
