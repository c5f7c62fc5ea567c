"""The choices of learners in an environment of skills: the meaning of their numbers, and what is seen.

They are options with features, or the six actions of the original's learner with a map. Each is begun anew for every
episode, and plays its choices as macros.
"""

from __future__ import annotations

from typing import Protocol

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.decision import Decision
from hazard_ms.skills.options import paper_actions
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.macros import Macro, play, single
from hazard_ms.skills.options.options import Menu, Option, Options, option_count
from hazard_ms.skills.options.paper_actions import SixActions
from hazard_ms.skills.options.paper_map import MapLayout

OPTIONS, PAPER = "options", "paper"
ACTIONS = (OPTIONS, PAPER)


class Choices(Protocol):
    """The choices of a learner in one environment."""

    count: int  # A, number of choices

    def space(self) -> gym.spaces.Box:
        """The bounds of what is seen."""

    def begin(self, seed: int) -> None:
        """Begin an episode; `seed` determines what is random in its choices."""

    def see(self, decision: Decision) -> NDArray[np.float32]:
        """The observation of the decision that comes next, [...] [m]; `mask` and `name` are about it from then on."""

    @property
    def mask(self) -> NDArray[np.bool_]:
        """The mask of the choices that `action_masks` allows, [A]."""

    def name(self, number: int) -> str:
        """The choice with this number as text; empty if there is none."""

    def macro(self, number: int, decision: Decision) -> Macro | None:
        """The macro of a choice; None for one that cannot be taken."""

    def note(self, number: int, ok: bool, decision: Decision) -> None:
        """Remember that a choice was played, and whether it worked; `decision`: the one that follows."""


class OptionChoices:
    """Numbered options, of which a mask forbids what cannot be done, and features of what is known."""

    def __init__(self, encoder: Encoder, stop: bool, fire: int | None = None) -> None:
        """Take the `encoder` of a task; `stop`: whether episodes may be ended early; `fire`: see `Options`."""
        self._encoder, self._stop, self._fire = encoder, stop, fire
        self.count = option_count(fire is not None)
        self.menu = Menu((), (), (), {}, np.zeros(self.count, bool))

    def space(self) -> gym.spaces.Box:
        """The bounds of the features."""
        return self._encoder.space()

    def begin(self, seed: int) -> None:
        """Begin an episode. Nothing is random."""
        del seed
        self._options = Options(self._stop, self._fire)

    def see(self, decision: Decision) -> NDArray[np.float32]:
        """The features of a decision, [F]."""
        self.menu = self._options.menu(decision)
        return self._encoder.encode(decision, self.menu)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """The mask of the options that can be chosen, [A]."""
        return self.menu.mask

    def name(self, number: int) -> str:
        """The option with this number as text."""
        option = self.menu.option(number)
        return "" if option is None else str(option)

    def macro(self, number: int, decision: Decision) -> Macro | None:
        """The macro of an option."""
        option = self._option(number)
        return None if option is None else play(option, decision)

    def note(self, number: int, ok: bool, decision: Decision) -> None:
        """Remember that an option was played, and whether it worked; `decision`: the one that follows."""
        option = self._option(number)
        assert option is not None  # nothing else is played
        self._options.note(option, ok, decision)

    def _option(self, number: int) -> Option | None:
        return self.menu.option(number) if self.menu.mask[number] else None


class PaperChoices:
    """The six actions of the original's learner, and its map. What cannot be done can be chosen unless `masked`."""

    count = paper_actions.COUNT

    def __init__(self, layout: MapLayout, masked: bool) -> None:
        """Take the `layout` of the map of a task; `masked`: whether `mask` forbids what cannot be done."""
        self._layout, self._masked = layout, masked

    def space(self) -> gym.spaces.Box:
        """The bounds of the map."""
        return self._layout.space()

    def begin(self, seed: int) -> None:
        """Begin an episode; `seed` determines which things are wandered to."""
        self._actions = SixActions(seed)

    def see(self, decision: Decision) -> NDArray[np.float32]:
        """The map of a decision, [P, 64, 64], with heights in [m]."""
        self._actions.see(decision)
        return self._layout.encode(decision)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """The actions that can be done, [6]; all of them unless masked."""
        return self._actions.mask if self._masked else np.ones(self.count, bool)

    def name(self, number: int) -> str:
        """The action with this number as text, whether or not it can be done."""
        return paper_actions.NAMES[number]

    def macro(self, number: int, decision: Decision) -> Macro | None:
        """One action of the benchmark, as a macro."""
        del decision
        action = self._actions.action(number)
        return None if action is None else single(action)

    def note(self, number: int, ok: bool, decision: Decision) -> None:
        """Remember nothing: the next decision tells how an action ended."""
