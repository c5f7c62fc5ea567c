"""Macros play an option as actions of the benchmark, each chosen by the outcome of the one before.

    target    walk_to until arrived; pick_up; drop into the bag at once, where the safe place is the bag
    cart      walk_to until arrived; drop over the cart
    landmark  walk_to until arrived; explore
    look      explore
    stop      stop
    fire      walk_to and pick_up of an extinguisher, unless one is in the hand; extinguish until that is done
    tool      the same without the last

A macro is a generator: it yields actions, receives the decision that follows each, and returns whether it worked. A
walk of the benchmark ends after 100 frames, so a macro walks on as long as walks bring the agent nearer. From less than
NEAR away it continues even if the last walk did not arrive. A tool in the hand is put down before.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.options.fires import EXTINGUISH, tool_in_hand
from hazard_ms.skills.options.options import CART, END, FIRE, LANDMARK, LOOK, TARGET, TOOL, Option

LEGS = 8  # greatest number of walks of one approach: 13 m, longer than any path in a room
SPRAYS = 3  # greatest number of `extinguish` at one fire [ours]
PROGRESS = 0.2  # least length of a walk that is worth continuing, if it did not arrive [m]
NEAR = 0.7  # a pick-up or a drop is tried from here: arrival is at 0.5 m, and a position has some error [m]

Macro = Generator[Action, Decision, bool]
Approach = Generator[Action, Decision, tuple[Decision, bool]]


def play(option: Option, decision: Decision) -> Macro:
    """The macro of `option`, begun at `decision`. Raises ValueError for an option that names nothing."""
    if option.kind in (LOOK, END):
        return single(Action(EXPLORE if option.kind == LOOK else STOP))
    if option.name is None or option.kind not in (TARGET, CART, LANDMARK, FIRE, TOOL):
        raise ValueError(f"option must be target, cart, landmark, fire or tool with a name, look or stop, got {option}")
    if option.kind == FIRE:
        return _put_out(decision, option.name, option.tool)
    if option.kind == TOOL:
        return _arm(decision, option.name)
    return {TARGET: _fetch, CART: _bring, LANDMARK: _search}[option.kind](decision, option.name)


def single(action: Action) -> Macro:
    """One action, as a macro."""
    return worked((yield action))


def worked(decision: Decision) -> bool:
    """Whether the action before `decision` worked."""
    return decision.last_result is not None and decision.last_result.ok


def _fetch(decision: Decision, name: str) -> Macro:
    """Pick the target up and, in tasks with a bag, put it away; a target that is in the hand is only put away."""
    if tool_in_hand(decision):
        decision = yield Action(DROP)
    if decision.held is None:
        decision, near = yield from _approach(decision, name)
        if not near:
            return False
        decision = yield Action(PICK_UP, name)
    if decision.held is None:
        return False
    if decision.containers:
        return decision.held == name
    decision = yield Action(DROP)
    return worked(decision)


def _arm(decision: Decision, tool: str) -> Macro:
    """Walk to an extinguisher and take it into the hand; another tool is put down."""
    if tool_in_hand(decision):
        decision = yield Action(DROP)
    decision, near = yield from _approach(decision, tool)
    if not near:
        return False
    decision = yield Action(PICK_UP, tool)
    return decision.held == tool


def _put_out(decision: Decision, name: str, tool: str | None) -> Macro:
    """Put out the fire at the thing called `name`; `tool`: the extinguisher to fetch first, None for none."""
    if tool is not None:
        armed = yield from _arm(decision, tool)
        if not armed:
            return False
    for _ in range(SPRAYS):
        decision = yield Action(EXTINGUISH, name)
        result = decision.last_result
        if result is None or result.reason not in UNFINISHED:
            break
    return worked(decision)


def _bring(decision: Decision, cart: str) -> Macro:
    """Carry what the hand holds to the cart and let it go over the basket."""
    decision, near = yield from _approach(decision, cart)
    return near and worked((yield Action(DROP, cart)))


def _search(decision: Decision, name: str) -> Macro:
    """Walk to the landmark and look around; if the path is blocked, look around from there."""
    start = decision.agent_position
    decision, near = yield from _approach(decision, name)
    if not near and _way(start, decision) < PROGRESS:
        return False
    return worked((yield Action(EXPLORE)))


def _approach(decision: Decision, name: str) -> Approach:
    """Walk to the thing called `name`. Returns the last decision, and whether it is near enough to go on."""
    for _ in range(LEGS):
        start = decision.agent_position
        decision = yield Action(WALK_TO, name)
        if worked(decision):
            return decision, True
        if _way(start, decision) < PROGRESS:
            break
    sighting = decision.map.objects.get(decision.index(name))
    near = sighting is not None and float(np.hypot(*(sighting.position[:2] - decision.agent_position))) < NEAR
    return decision, near


def _way(start: tuple[float, float], decision: Decision) -> float:
    """Distance from `start` to where the agent stands now [m]."""
    return float(np.hypot(*np.subtract(decision.agent_position, start)))
