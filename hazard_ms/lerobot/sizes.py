"""Sizes of states and actions, and frames of a second, for tools that ask before there is an environment."""

from __future__ import annotations

from hazard_ms.spec.checks import one_of

FRAMES = {"paper": 30, "shipped": 100, "realistic": 30}  # of a second, by preset
STATES = {"fetch": 37, "g1": 79}  # numbers of `agent_pos`, S
ACTIONS = {"fetch": 13, "g1": 17}  # numbers of an action in the control mode of demonstrations, A


def frames_of(fps: int, physics: str) -> int:
    """The frames of a step, where there are `fps` steps in a second of a preset.

    Raises ValueError for an unknown preset, and unless its frames can be shared out so.
    """
    frames = FRAMES[one_of(physics, FRAMES, "physics")]
    if not isinstance(fps, int) or fps < 1 or frames % fps:
        raise ValueError(f"fps must be a divisor of {frames}, got {fps!r}")
    return frames // fps
