"""The choices of learners in the sketch, for N rescues: the meaning of their numbers, and what is seen.

They are options with features, or the six actions with a map: spaces are those of `hazard_ms.skills.options.choices`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hazard_ms.sketch.paper.maps import MapMaker
from hazard_ms.sketch.paper.moves import SixSketch
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, SketchScene
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain, Rescues
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options import paper_actions
from hazard_ms.skills.options.choices import OPTIONS, PAPER
from hazard_ms.skills.options.environment import refuse_mask
from hazard_ms.skills.options.options import CART, END, FIRE, FIRST, KINDS, LANDMARK, TARGET, TOOL, option_count
from hazard_ms.spec.checks import flag, one_of


class Played(NamedTuple):
    """The outcome of one choice of each rescue, [N] each."""

    gained: Floats  # value rescued, as a share of all
    over: Bools  # whether the episode is over
    allowed: Bools  # whether the choice could be taken
    stopped: Bools  # whether it ended the episode
    ok: Bools  # whether it worked


class Choices(Protocol):
    """The choices of N rescues."""

    count: int  # A, number of choices

    @property
    def sketch(self) -> Sketch:
        """The sketch in which the rescues are played."""

    def space(self) -> gym.spaces.Box:
        """The bounds of what one learner sees."""

    def observe(self) -> NDArray[np.float32]:
        """The observations of all learners, dimensionless or as the map gives them [m], [N, ...]."""

    @property
    def mask(self) -> Bools:
        """The choices that `action_masks` allows, [N, A]."""

    def step(self, chosen: ArrayLike) -> Played:
        """Take the choices `chosen` [N], columns of `mask` [N, A]. Raises ValueError for anything else."""

    def name(self, row: int, number: int) -> str:
        """The choice with this number in a rescue as text."""


class OptionChoices:
    """Numbered options, of which a mask forbids what cannot be done, and features of what is known."""

    def __init__(self, sketch: Sketch, ranges: Sequence[tuple[float, float]]) -> None:
        """Take a `sketch`; `ranges`: ends of each hazard's usual level, in its unit."""
        self.sketch, self.encoder = sketch, SketchEncoder(ranges, sketch.stack.measures)
        self.count = option_count(sketch.stack.measures)

    def space(self) -> gym.spaces.Box:
        """The bounds of the features."""
        return self.encoder.layout.space()

    def observe(self) -> NDArray[np.float32]:
        """The features of all rescues, [N, F]."""
        return self.encoder.encode(self.sketch.stack, self.sketch.state, self.sketch.slots, self.sketch.tool)

    @property
    def mask(self) -> Bools:
        """The options that can be chosen, [N, A]."""
        return self.sketch.mask

    def step(self, chosen: ArrayLike) -> Played:
        """Play the options `chosen` [N], columns of `mask` [N, A]. Raises ValueError for anything else."""
        option, mask, state = np.asarray(chosen), self.sketch.mask, self.sketch.state
        failures = _failures(state)
        gained, over = self.sketch.step(option)
        allowed = mask[np.arange(len(option)), option]
        looking = (option >= FIRST[LANDMARK]) & (option < FIRST[END])
        ok = allowed & np.where(looking, state.looked, _failures(state) == failures)
        return Played(gained, over, allowed, allowed & (option == FIRST[END]), ok)

    def name(self, row: int, number: int) -> str:
        """An option as text: the sketch numbers things where the simulator names them."""
        kind = max((k for k in KINDS if FIRST[k] <= number), key=FIRST.__getitem__)
        slot = number - FIRST[kind]
        if kind not in (TARGET, CART, LANDMARK, FIRE):
            return f"{kind} {int(self.sketch.tool[row])}" if kind == TOOL else kind
        return f"{kind} {int(self.sketch.slots[row, slot]) if kind == LANDMARK else slot}"


def _failures(state: Rescues) -> Ints:
    """The number of failures of each rescue so far, [N]."""
    parts = (state.failures, state.fire_failures, state.tool_failures)
    return np.asarray(sum(part.sum(axis=1) for part in parts), np.int64)


class PaperChoices:
    """The six actions of the original's learner, and its map. What cannot be done can be chosen unless `masked`."""

    count = paper_actions.COUNT

    def __init__(self, sketch: SixSketch, ranges: Sequence[tuple[float, float]], masked: bool) -> None:
        """Take a `sketch`; `ranges`: ends of each hazard's usual level, in its unit."""
        self.sketch, self._maker, self._masked = sketch, MapMaker(ranges), masked

    def space(self) -> gym.spaces.Box:
        """The bounds of the map."""
        return self._maker.layout.space()

    def observe(self) -> NDArray[np.float32]:
        """The maps of all rescues, [N, P, 64, 64], with heights in [m]."""
        return self._maker.draw(self.sketch)

    @property
    def mask(self) -> Bools:
        """The actions that can be done, [N, 6]; all of them unless masked."""
        return self.sketch.possible() if self._masked else np.ones((len(self.sketch.state.frame), self.count), bool)

    def step(self, chosen: ArrayLike) -> Played:
        """Do the actions `chosen` [N], columns of `mask` [N, 6]. Raises ValueError for anything else."""
        gained, allowed, over = self.sketch.act(chosen)
        return Played(gained, over, allowed, np.zeros_like(over), self.sketch.worked)

    def name(self, row: int, number: int) -> str:
        """An action as text."""
        del row
        return paper_actions.NAMES[number]


def choices(
    actions: str,
    scenes: Sequence[SketchScene],
    ranges: Sequence[tuple[float, float]],
    times: SkillTimes,
    count: int,
    stop: bool = True,
    masked: bool = False,
    domain: Domain = AS_MEASURED,
) -> Choices:
    """The choices "options" or "paper" of `count` rescues in `scenes`; other arguments as for `SketchBatch`.

    Raises ValueError for unknown names, impossible numbers, and `masked` options.
    """
    one_of(actions, (OPTIONS, PAPER), "actions")
    flag(stop, "stop")
    refuse_mask(flag(masked, "masked"), actions)
    if actions == PAPER:
        return PaperChoices(SixSketch(scenes, times, count, domain), ranges, masked)
    return OptionChoices(Sketch(scenes, times, count, domain, stop), ranges)
