"""The presets of physics: one code path, different numbers (physics.md 0 and 1.5).

paper    the equations of the paper; constants from the original's code where the text gives none
shipped  what the original's code does, for comparison with published scores
"""

from __future__ import annotations

from collections.abc import Callable

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.fire import Fire

FREQUENCIES = {  # frames and physics steps per second: a frame is one env step
    "paper": (30, 120),
    "shipped": (100, 100),  # 0.01 s a frame, one physics step each [physics.md 0.1]
}
PRESETS = tuple(FREQUENCIES)

_FIRE = {
    "paper": Fire(),
    "shipped": Fire(nearest=0.1, strict=True, embers=True, image_room_weight=0.36787944, fixtures_block=False),  # e^-1
}


def fire(preset: str) -> Fire:
    """The fire of `preset`."""
    return _FIRE[known(preset)]


def known(preset: str) -> str:
    """`preset` itself; ValueError unless it is one of PRESETS."""
    if preset not in PRESETS:
        raise ValueError(f"no preset of physics is called {preset!r}; there are {', '.join(PRESETS)}")
    return preset


HAZARDS: dict[str, Callable[[str], Hazard]] = {"fire": fire}  # every hazard by name: preset -> hazard
