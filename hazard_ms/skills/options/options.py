"""Options of a learner: fetch a target, bring to a cart, search at a landmark, look around, stop; each is a number.

    number                  option
    0 .. T-1                target i: walk to it and pick it up; where the safe place is the bag, drop it there at once
    T .. T+C-1              cart j: walk to it and drop what the hand holds over it
    T+C .. T+C+L-1          landmark l: walk there and look around
    T+C+L                   look around on the spot
    T+C+L+1                 stop: end the episode
    T+C+L+2 .. T+C+L+F+1    fire k: fetch an extinguisher and put it out; only in tasks with measures
    T+C+L+F+2               tool: fetch the nearest extinguisher, to look for fires with it in hand; there, too

Targets and carts keep their slots throughout an episode (the order of `Decision.targets` and `.containers`), but for
carts that an agent finds by itself; landmarks are chosen anew at every decision, the most promising first, and so are
fires (`hazard_ms.skills.options.fires`). A tool in the hand does not count as held: it is put down for a target.
`hazard_ms.skills.options.macros` plays an option.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.observations import SLOTS
from hazard_ms.skills.decision import DROP, EXPLORE, STOP, Action, Decision, Tool
from hazard_ms.skills.failures import NOT_BURNING
from hazard_ms.skills.options.fires import FIRE_SLOTS, FireMemory, KnownFire, tool_in_hand, usable_tool
from hazard_ms.skills.options.landmarks import Landmark, landmarks

TARGET_SLOTS = SLOTS  # T, number of slots for targets, as in the target table of observations
CART_SLOTS = 3  # C, number of slots for carts: as many as the generated streets have at most
LANDMARK_SLOTS = 8  # L, number of slots for landmarks
COUNT = TARGET_SLOTS + CART_SLOTS + LANDMARK_SLOTS + 2  # A, number of options
MEASURED_COUNT = COUNT + FIRE_SLOTS + 1  # A of tasks with measures
GIVE_UP = 4  # failures after which a target or a cart is no longer offered, as in the greedy agent
FIRE_GIVE_UP = 2  # failures after which a fire is no longer offered [ours]

TARGET, CART, LANDMARK, LOOK, END = "target", "cart", "landmark", "look", "stop"
FIRE, TOOL = "fire", "tool"
KINDS = (TARGET, CART, LANDMARK, LOOK, END, FIRE, TOOL)
_STARTS = (0, TARGET_SLOTS, TARGET_SLOTS + CART_SLOTS, COUNT - 2, COUNT - 1, COUNT, MEASURED_COUNT - 1)
FIRST = dict(zip(KINDS, _STARTS, strict=True))  # number of the first option of each kind


def option_count(measures: bool) -> int:
    """A, the number of options of tasks with `measures` about a fire, or of those without."""
    return MEASURED_COUNT if measures else COUNT


@dataclass(frozen=True)
class Option:
    """One option of a decision, with the `name` of its target, cart, landmark, tool, or hot thing at a fire."""

    kind: str
    name: str | None = None
    tool: str | None = None  # of a fire: the extinguisher to fetch first; None: it is in the hand

    def __str__(self) -> str:
        return self.kind if self.name is None else f"{self.kind} {self.name}"


@dataclass(frozen=True)
class Menu:
    """The options of one decision."""

    targets: tuple[str, ...]  # by slot, T at most
    carts: tuple[str, ...]  # by slot, C at most
    landmarks: tuple[Landmark, ...]  # by slot, L at most
    failures: dict[str, int]  # number of failures of targets and carts by name; 0 if absent
    mask: NDArray[np.bool_]  # [A], whether each option can be chosen
    fires: tuple[KnownFire, ...] = ()  # by slot, F at most; none where tasks have no measures
    tool: Tool | None = None  # the extinguisher in the hand, else the nearest that can be used
    out: int = 0  # number of fires that were put out

    def option(self, number: int) -> Option | None:
        """The option with this number; None if its slot is empty. Raises ValueError outside of 0 to A - 1."""
        if not 0 <= number < len(self.mask):
            raise ValueError(f"action must be a whole number from 0 to {len(self.mask) - 1}, got {number}")
        kind = max((k for k in KINDS if FIRST[k] <= number), key=FIRST.__getitem__)
        if kind in (LOOK, END):
            return Option(kind)
        names = self.names(kind)
        slot = number - FIRST[kind]
        if slot >= len(names):
            return None
        fetched = kind == FIRE and self.tool is not None and not self.tool.held
        return Option(kind, names[slot], self.tool.name if fetched and self.tool else None)

    def number(self, option: Option) -> int:
        """The number of an option. Raises ValueError if the menu does not have it."""
        if option.kind in (LOOK, END):
            return FIRST[option.kind]
        names = self.names(option.kind)
        if option.name not in names:
            raise ValueError(f"{option.kind} must be one of {', '.join(names) or 'none'}, got {option.name!r}")
        return FIRST[option.kind] + names.index(option.name)

    def names(self, kind: str) -> tuple[str, ...]:
        """Names in the slots of targets, carts, landmarks, fires or tools."""
        if kind == LANDMARK:
            return tuple(mark.name for mark in self.landmarks)
        if kind == FIRE:
            return tuple(fire.name for fire in self.fires)
        if kind == TOOL:
            return () if self.tool is None else (self.tool.name,)
        return self.targets if kind == TARGET else self.carts


def option_of(menu: Menu, decision: Decision, action: Action) -> Option | None:
    """The option that `action` belongs to, or None; for learning from agents that choose actions."""
    if action.verb in (EXPLORE, STOP):
        return Option(LOOK if action.verb == EXPLORE else END)
    name = decision.held if action.verb == DROP and action.target is None else action.target
    for kind in (TARGET, CART, LANDMARK):
        if name in menu.names(kind):
            return Option(kind, name)
    return None


class Options:
    """Makes the menu of every decision of an episode. It remembers failures and visits, and whether it just looked."""

    def __init__(self, stop: bool = True, fire: int | None = None) -> None:
        """Begin an episode; `stop`: whether it may be ended early, which tempts new policies to do nothing.

        `fire`: the number of the hazard that measures are about; None in tasks without measures.
        """
        self._stop = stop
        self._fires = None if fire is None else FireMemory(fire)
        self._failures: Counter[str] = Counter()
        self._visits: Counter[str] = Counter()
        self._looked = False

    def menu(self, decision: Decision) -> Menu:
        """The options at `decision`. Raises ValueError for a scene with more targets or carts than there are slots."""
        targets, carts = tuple(t.name for t in decision.targets), decision.containers
        for names, most, what in ((targets, TARGET_SLOTS, "targets"), (carts, CART_SLOTS, "carts")):
            if len(names) > most:
                raise ValueError(f"a scene must have at most {most} {what}, got {len(names)}")
        marks = landmarks(decision, self._visits, LANDMARK_SLOTS)
        held = None if tool_in_hand(decision) else decision.held
        mask = np.zeros(option_count(self._fires is not None), bool)
        for slot, target in enumerate(decision.targets):
            mask[slot] = self._target_open(decision, target.name, target.rescued)
        for slot, name in enumerate(carts):
            mask[FIRST[CART] + slot] = held is not None and self._known(decision, name)
        mask[FIRST[LANDMARK] : FIRST[LANDMARK] + len(marks)] = True
        mask[FIRST[END]] = self._stop
        mask[FIRST[LOOK]] = not self._looked or not mask[: FIRST[LOOK]].any()
        if self._fires is None:
            return Menu(targets, carts, marks, dict(self._failures), mask)
        fires, tool = self._fires.fires(decision), usable_tool(decision, self._failures)
        for slot, fire in enumerate(fires):
            mask[FIRST[FIRE] + slot] = tool is not None and held is None and self._failures[fire.name] < FIRE_GIVE_UP
        mask[FIRST[TOOL]] = tool is not None and held is None and not tool.held
        return Menu(targets, carts, marks, dict(self._failures), mask, fires, tool, self._fires.count_out)

    def _known(self, decision: Decision, name: str) -> bool:
        return decision.index(name) in decision.map.objects and self._failures[name] < GIVE_UP

    def _target_open(self, decision: Decision, name: str, rescued: bool) -> bool:
        if decision.held is not None and not tool_in_hand(decision):  # it can only go into the bag, if there is one
            return name == decision.held and not decision.containers
        return not rescued and self._known(decision, name)

    def note(self, option: Option, ok: bool, decision: Decision | None = None) -> None:
        """Remember that `option` was played, and whether it worked; `decision`, that follows: for fires alone."""
        if option.kind == FIRE and self._fires is not None and decision is not None:
            result = decision.last_result
            if ok or (result is not None and result.reason == NOT_BURNING):
                self._fires.note(str(option.name), decision.frame, ok)
        self._looked = option.kind in (LOOK, LANDMARK) and ok
        if option.kind == LANDMARK:
            self._visits[str(option.name)] += 1
        elif option.name is not None and not ok:
            self._failures[option.name] += 1
