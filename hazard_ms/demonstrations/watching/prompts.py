"""Decisions in words, with the options as letters: for agents that read and write text."""

from __future__ import annotations

import string
from typing import Any

import numpy as np

from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.options.options import CART, END, LANDMARK, LOOK, TARGET, Menu

LETTERS = string.ascii_uppercase + string.ascii_lowercase  # more than a menu has options


def prompt(brief: Brief, decision: Decision, menu: Menu) -> dict[str, Any]:
    """A decision as "text", and as "options" the number of each letter's option, those that can be chosen only."""
    numbers = np.flatnonzero(menu.mask).tolist()
    letters = dict(zip(LETTERS, numbers, strict=False))
    lines = [
        brief.text,
        f"Frame {decision.frame} of {decision.max_frames}. In your hand: {decision.held or 'nothing'}.",
        *_last(decision),
        "Things to rescue:",
        *(f"- {_target(brief, decision, index)}" for index in range(len(decision.targets))),
        "Options:",
        *(f"{letter}) {option_words(decision, menu, number)}" for letter, number in letters.items()),
        "Answer with the letter of the best option.",
    ]
    return {"text": "\n".join(lines), "options": letters}


def _last(decision: Decision) -> list[str]:
    if decision.last_action is None or decision.last_result is None:
        return []
    how = "done" if decision.last_result.ok else f"not done ({decision.last_result.reason})"
    return [f"Your last action, {decision.last_action}: {how}."]


def _target(brief: Brief, decision: Decision, index: int) -> str:
    """A thing to rescue in words: what it is worth, where and how it was last seen."""
    target = decision.targets[index]
    sighting = decision.map.objects.get(target.index)
    parts = [f"worth {target.value:g}"]
    if target.rescued:
        parts.append("rescued")
    elif target.held:
        parts.append("in your hand")
    elif sighting is None:
        parts.append("not seen yet")
    else:
        parts += [_place(decision, target.index), f"seen {decision.frame - sighting.frame} frames ago"]
        for hazard, level in zip(brief.hazards, sighting.levels, strict=False):
            parts.append(f"{hazard.title} {level:.3g} {hazard.unit}".strip())
        parts += ["damaged"] if target.damaged else []
    return f"{target.name}: {', '.join(parts)}"


def _place(decision: Decision, index: int) -> str:
    x, y = np.subtract(decision.map.objects[index].position[:2], decision.agent_position)
    turn = np.arctan2(y, x) - decision.agent_heading
    degrees = round(float(np.degrees(np.arctan2(np.sin(turn), np.cos(turn)))))
    side = "ahead" if not degrees else f"{abs(degrees)}° to the {'left' if degrees > 0 else 'right'}"
    return f"{float(np.hypot(x, y)):.1f} m away, {side}"


def option_words(decision: Decision, menu: Menu, number: int) -> str:
    """The option with this number in words. Raises ValueError for a number that no option has."""
    option = menu.option(number)
    assert option is not None  # the mask allows it
    words = {
        TARGET: f"put {option.name} into the bag" if option.name == decision.held else f"fetch {option.name}",
        CART: f"put {decision.held} into {option.name}",
        LANDMARK: f"walk to {option.name} and look around",
        LOOK: "look around here",
        END: "stop",
    }
    return words[option.kind]
