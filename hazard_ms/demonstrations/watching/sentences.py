"""Sentences that say what a robot is doing: the labels of subtasks."""

from __future__ import annotations

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision

WAITING = "wait"  # while the agent chooses


def sentence(action: Action, decision: Decision) -> str:
    """The subtask that `action` is at `decision`, such as "pick up mug_1"."""
    if action.verb == DROP:
        held = decision.held or "nothing"
        if any(tool.held for tool in decision.tools):
            return f"put down {held}"
        if action.target is not None:
            return f"put {held} into {action.target}"
        return f"put {held} on the ground" if decision.containers else f"put {held} into the bag"
    words = {
        WALK_TO: f"walk to {action.target}",
        WALK_ONE_STEP: f"walk one step towards {action.target}",
        PICK_UP: f"pick up {action.target}",
        EXPLORE: "look around",
        STOP: "stop",
    }
    return words.get(action.verb) or f"{action.verb.replace('_', ' ')} {action.target}"
