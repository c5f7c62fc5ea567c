"""The actions that a model can choose from at a decision, each with a letter."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from hazard_ms.agents.base import distance, known, open_targets
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, VERBS, WALK_TO, Action, Decision
from hazard_ms.skills.options.landmarks import Landmark, landmarks
from hazard_ms.spec.registry.mitigations import TELL

LETTERS = "ABCDEFGHIJKLMNOPQRST"
MACRO, FULL = "macro", "full"
MOVES = (MACRO, FULL)
PLACES = 4  # to search that are offered at most [ours]
NEAREST = 3  # doors to open and to shut, and things to act on, that are offered of each at most [ours]
ARM = 2.2  # distance from which a pick-up may begin [m], as for `planner` [ours]
FETCH, PICK, BRING, PUT, SEARCH, LOOK, END = "fetch", "pick up", "bring to", "put into", "search at", "look", "stop"
PUT_DOWN = "put down"  # a tool
BAG = "bag"  # the thing that `put into` names where the robot carries its safe place

Move = tuple[str, str | None, Action]  # a word of the above, the thing it is for, and what is done


@dataclass(frozen=True)
class Choice:
    """One line of the menu: what the model reads, and what is done."""

    letter: str
    move: str  # one of the words above
    thing: str | None  # the real name of what it is for
    action: Action


@dataclass(frozen=True)
class Menu:
    """All that can be chosen at a decision, and the places to search that were found."""

    choices: tuple[Choice, ...]
    places: tuple[Landmark, ...]

    def letter(self, move: str, thing: str | None) -> str | None:
        """The letter of a move for a thing; None if that is not on offer."""
        return next((c.letter for c in self.choices if (c.move, c.thing) == (move, thing)), None)


def forced(decision: Decision) -> Action | None:
    """The action that follows by itself from the last one, as in the paper; None where the model has to choose.

    What was walked up to is picked up; what is held goes into the bag, or into the cart that was walked up to.
    """
    arrived, tools = decision.walked_up_to, [tool.name for tool in decision.tools]
    if decision.held in tools:
        return None
    if decision.held is not None:
        if not decision.containers:
            return Action(DROP)
        return Action(DROP, arrived) if arrived in decision.containers else None
    return Action(PICK_UP, arrived) if arrived in (*open_targets(decision), *tools) else None


def menu(
    decision: Decision,
    failures: Mapping[str, int],
    visits: Mapping[str, int],
    give_up: int,
    moves: str,
    most: int,
    tells: bool = False,
) -> Menu:
    """The choices at `decision`, in the order of the things' indices, never of their merit.

    Things that failed `give_up` times are left out. Of more than `most` choices, the farthest targets are left out.
    `tells`: whether the last choice is to tell the other robots something, whose action lacks the message.
    """
    fit = [name for name in decision.names if failures.get(name, 0) < give_up]
    targets = list(known(decision, tuple(n for n in open_targets(decision) if n in fit)))
    carts = list(known(decision, tuple(n for n in decision.containers if n in fit)))
    marks = tuple(m for m in landmarks(decision, visits, PLACES + len(targets)) if m.name in fit)
    places = _by_index(decision, [m.name for m in marks if m.name not in (*targets, *carts)][:PLACES])
    last = decision.last_action
    rest: list[Move] = [(SEARCH, name, Action(WALK_TO, name)) for name in places]
    if last is None or last.verb != EXPLORE or not (targets or places):
        rest.append((LOOK, None, Action(EXPLORE)))
    rest.append((END, None, Action(STOP)))
    if tells:
        rest.append((TELL, None, Action(TELL, "")))
    named = _mitigations(decision)
    if decision.held in [tool.name for tool in decision.tools]:
        named.append((PUT_DOWN, decision.held, Action(DROP)))
    elif decision.held is not None:
        named += [(BRING, name, Action(WALK_TO, name)) for name in _by_index(decision, carts)]
        named += _drops(decision, carts) if moves == FULL else []
    else:
        if moves == FULL:
            near = [n for n in targets if distance(decision, decision.map.objects[decision.index(n)]) < ARM]
            named += [(PICK, name, Action(PICK_UP, name)) for name in _by_index(decision, near)]
        room = most - len(rest) - len(named)
        named += [(FETCH, name, Action(WALK_TO, name)) for name in _by_index(decision, targets[: max(room, 0)])]
    offered = (named[: max(most - len(rest), 0)] + rest)[:most]
    letters = zip(LETTERS, offered, strict=False)
    shown = tuple(m for m in marks if m.name in places)
    return Menu(tuple(Choice(letter, *each) for letter, each in letters), shown)


def _mitigations(decision: Decision) -> list[Move]:
    """What can be done about the hazard itself, and the tools that can be fetched; empty in most tasks.

    Of each verb the NEAREST few, in the order in which they are available.
    """
    tools = {tool.name for tool in decision.tools}
    made: list[Move] = []
    for verb in dict.fromkeys(action.verb for action in decision.available):
        if verb not in VERBS:
            rows = [action for action in decision.available if action.verb == verb]
            near = sorted(rows, key=lambda action: _away(decision, action.target))[:NEAREST]
            made += [(verb.replace("_", " "), action.target, action) for action in rows if action in near]
        elif verb == PICK_UP:
            rows = [action for action in decision.available if action.verb == verb and action.target in tools]
            made += [(FETCH, action.target, Action(WALK_TO, action.target)) for action in rows]
    return made


def _away(decision: Decision, name: str | None) -> float:
    """How far it is to a thing or an opening [m]; inf where that is not known."""
    opening = next((o for o in decision.openings if o.name == name), None)
    if opening is not None:
        return math.dist(opening.position[:2], decision.agent_position)
    seen = decision.map.objects.get(decision.index(name)) if name in decision.names else None
    return math.inf if name is None or seen is None else distance(decision, seen)


def _drops(decision: Decision, carts: Iterable[str]) -> list[Move]:
    """The ways to put away what is held."""
    if not decision.containers:
        return [(PUT, BAG, Action(DROP))]
    near = [name for name in carts if distance(decision, decision.map.objects[decision.index(name)]) < ARM]
    return [(PUT, name, Action(DROP, name)) for name in _by_index(decision, near)]


def _by_index(decision: Decision, names: Iterable[str]) -> list[str]:
    """Names in the order of the things' indices."""
    return sorted(names, key=decision.index)
