"""Time for thinking: the frames for which hazards go on while an agent chooses, by one of three clocks."""

from __future__ import annotations

import math
from typing import NamedTuple

OFF, TOKENS, WALL = "off", "tokens", "wall"
CLOCKS = (OFF, TOKENS, WALL)
# The profile "reference-1" of the clock `tokens`. It never changes, so that no machine plays a part in scores.
FIRST_ANSWER = 0.3  # time to reach the model [s] [ours]
PROMPT_RATE = 5000.0  # tokens read per second [1/s] [ours]
ANSWER_RATE = 50.0  # tokens written per second [1/s] [ours]


class Thought(NamedTuple):
    """The cost of one decision: time as it was measured or recorded [s], tokens read, tokens written, calls."""

    seconds: float = 0.0
    prompt: int = 0
    answer: int = 0
    calls: int = 0


def seconds_of(clock: str, thought: Thought | None, measured: float) -> float:
    """Time that a decision took by a clock [s].

    `off`: none. `wall`: as the agent tells it, else as `measured` [s]. `tokens`: by the fixed profile, for each call of
    a model; none for agents that ask no model.
    """
    if clock == WALL:
        return measured if thought is None else thought.seconds
    if clock != TOKENS or thought is None or not thought.calls:
        return 0.0
    return thought.calls * FIRST_ANSWER + thought.prompt / PROMPT_RATE + thought.answer / ANSWER_RATE


def frames_of(seconds: float, frame_seconds: float) -> int:
    """Frames that pass in a time [s]: those of `frame_seconds` [s] that have begun by its end."""
    return max(0, math.ceil(round(seconds / frame_seconds, 6)))  # 1.2000000000000002 s are 36 frames, not 37
