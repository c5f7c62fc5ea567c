"""The choices of a person at a decision: the options and actions that agents have, in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hazard_ms.demonstrations.watching.prompts import option_words
from hazard_ms.demonstrations.watching.sentences import sentence
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, VERBS, WALK_TO, Action, Decision, Tool
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.options.macros import Macro, play
from hazard_ms.skills.options.options import Menu, Option, Options

LEGS = 8  # times that an action which ran out of frames is taken again [ours, as macros do]
ORDER = ("target", "cart", "act", "landmark", "look", "stop")  # of choices on the page, by their kind


@dataclass(frozen=True)
class Choice:
    """One thing that can be done: an option, which is several actions, or a single action."""

    key: str
    words: str
    thing: str | None
    what: Option | Action | tuple[Action, ...]  # several: one after the other, as long as each is done

    def row(self) -> dict[str, str | None]:
        """Plain data for the page."""
        return {"key": self.key, "words": self.words, "thing": self.thing}


class Choices:
    """The choices of every decision of an episode; it remembers what failed, as learners' options do."""

    def __init__(self) -> None:
        self._options = Options()
        self._option: Option | None = None

    def begin(self, decision: Decision) -> None:
        """Make the choices at `decision`."""
        menu = self._options.menu(decision)
        self.decision = decision
        every = (*_options(decision, menu), *_mitigations(decision))
        self.options = sorted(every, key=lambda c: _distance(decision, c))
        self.single = tuple(_single(decision))

    def of(self, thing: str) -> list[Choice]:
        """The choices about a thing; empty where the robot can do nothing with it now."""
        return [choice for choice in (*self.options, *self.single) if choice.thing == thing]

    def find(self, key: object) -> Choice:
        """The choice with this key. Raises ValueError if there is none now."""
        for choice in (*self.options, *self.single):
            if choice.key == key:
                return choice
        raise ValueError(f"choice must be one of the current choices, got {key!r:.100}")

    def things(self) -> list[str]:
        """Names of the things that something can be done with, in order."""
        return sorted({choice.thing for choice in (*self.options, *self.single) if choice.thing is not None})

    def play(self, choice: Choice) -> Macro:
        """The actions of a choice, as a macro; what comes of it is remembered."""
        if isinstance(choice.what, Option):
            return self._noting(choice.what)
        return _each(choice.what) if isinstance(choice.what, tuple) else _once(choice.what)

    def _noting(self, option: Option) -> Macro:
        ok = yield from play(option, self.decision)
        self._options.note(option, ok)
        return ok


def _options(decision: Decision, menu: Menu) -> Iterator[Choice]:
    for number in np.flatnonzero(menu.mask).tolist():
        option = menu.option(number)
        assert option is not None  # the mask allows it
        yield Choice(f"o{number}", option_words(decision, menu, number), option.name, option)


def _mitigations(decision: Decision) -> Iterator[Choice]:
    """What can be done about the hazard itself, and tools to pick up and to put down."""
    tools = {tool.name: tool for tool in decision.tools}
    for action in decision.available:
        name = action.target
        if action.verb not in VERBS:
            yield Choice(f"m:{action}", sentence(action, decision), name, (action,))
        elif action.verb == PICK_UP and name in tools:
            yield Choice(f"m:{action}", f"pick up {_told(tools[name])}", name, (Action(WALK_TO, name), action))
    if decision.held in tools:
        yield Choice("m:drop", f"put down {_told(tools[decision.held])}", decision.held, (Action(DROP),))


def _told(tool: Tool) -> str:
    """A tool in words: what is left in it."""
    return f"{tool.name} ({tool.kind}, {tool.left:.0%} left)" if tool.kind else tool.name


def _single(decision: Decision) -> Iterator[Choice]:
    for action in decision.available:
        if action.verb not in (EXPLORE, STOP) and action.verb in VERBS:
            thing = action.target if action.target is not None else decision.held
            yield Choice(f"a:{action}", sentence(action, decision), thing, action)


def _once(action: Action) -> Macro:
    decision = yield action
    return decision.last_result is not None and decision.last_result.ok


def _each(actions: tuple[Action, ...]) -> Macro:
    """Take `actions` in turn, each again while it runs out of frames, until one fails."""
    for action in actions:
        for _ in range(LEGS):
            result = (yield action).last_result
            if result is None or result.reason not in UNFINISHED:
                break
        if result is None or not result.ok:
            return False
    return True


def _distance(decision: Decision, choice: Choice) -> tuple[int, float]:
    """The order of options: things by their distance [m], doors and tools, places to search, looking, and stopping."""
    kind = ORDER.index(choice.what.kind if isinstance(choice.what, Option) else "act")
    door = next((o for o in decision.openings if o.name == choice.thing), None)
    if door is not None:
        return kind, float(np.hypot(*np.subtract(door.position[:2], decision.agent_position)))
    if choice.thing is None or choice.thing not in decision.names:
        return kind, 0.0
    seen = decision.map.objects.get(decision.index(choice.thing))
    return kind, 0.0 if seen is None else float(np.hypot(*np.subtract(seen.position[:2], decision.agent_position)))
