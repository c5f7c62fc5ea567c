"""The verb `tell`: a robot of a team tells the others something, over the radio.

The message reaches all of them when the action ends, with the places of those things in it, by name, that the robot has
seen: they enter the others' maps, unless these have seen them later. Messages have LONGEST characters at most, and take
FRAMES, in which the robot stands.
"""

from __future__ import annotations

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result

LONGEST = 200  # characters of a message at most [ours: what somebody says in half a minute]
FRAMES = 15  # that a message takes [ours: half a second of radio]


def tell(stage: Stage, text: str) -> Skill:
    """Stand for as long as the message `text` takes; whoever runs skills of teams hands it over."""
    for _ in range(FRAMES):
        yield stage.act()
    return Result(True, frames=FRAMES)


def nothing(stage: Stage) -> tuple[str, ...]:
    """Nothing is on offer to tell, since messages cannot be listed."""
    return ()


def check_message(text: str | None) -> None:
    """Check that `text` is a message, printable and not too long. Raises ValueError if it is not."""
    if not text or len(text) > LONGEST or not text.isprintable():
        raise ValueError(f"a message must be 1 to {LONGEST} printable characters, got {text!r:.250}")


def named_in(text: str, names: tuple[str, ...]) -> tuple[str, ...]:
    """The ones among `names` that stand in a message as words, each once."""
    words = set("".join(c if c.isalnum() or c == "_" else " " for c in text).split())
    return tuple(name for name in names if name in words)
