"""The options of `hazard_ms.skills.options` that an agent's actions amount to: labels for learners.

An option is several actions: walking to a thing, picking it up, putting it away. What an agent does is taken as the
option that its next action belongs to, which goes on until it is done, has failed, or another one begins.
"""

from __future__ import annotations

from typing import NamedTuple

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, Action, Decision, Result
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.options.options import END, LANDMARK, LOOK, Menu, Option, Options, option_of


class Label(NamedTuple):
    """A decision as a learner sees it."""

    menu: Menu
    number: int  # of the option that was chosen; -1: none of the menu
    starts: bool  # whether the option begins here; else it goes on


class PlayedOptions:
    """Follows the options of one episode."""

    def __init__(self) -> None:
        self._options = Options()
        self._under_way: Option | None = None

    def decided(self, decision: Decision, action: Action) -> Label:
        """The label of `action` at `decision`."""
        menu = self._options.menu(decision)
        option = option_of(menu, decision, action)
        before = self._under_way
        if before is not None and before.kind == LANDMARK and option == Option(LOOK):
            option = before  # the look around at a landmark belongs to it
        self._under_way, self._action, self._carts = option, action, bool(decision.containers)
        in_menu = option is not None and (option.kind in (LOOK, END) or option.name in menu.names(option.kind))
        number = menu.number(option) if option is not None and in_menu else -1
        return Label(menu, number, option is None or option != before)

    def ended(self, result: Result) -> None:
        """Note how the last action ended, and whether its option ended with it."""
        if self._under_way is None:
            return
        failed = not result.ok and result.reason not in UNFINISHED
        last = self._action.verb in (EXPLORE, STOP, DROP) or (self._action.verb == PICK_UP and self._carts)
        if failed or (result.ok and last):
            self._options.note(self._under_way, result.ok)
            self._under_way = None
