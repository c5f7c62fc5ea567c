"""The record that the oracle keeps of what failed in an episode, and of its searches."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Attempts:
    """The failures and searches of an episode so far."""

    failures: dict[str, int] = field(default_factory=dict)  # by name of the thing
    missed: dict[str, tuple[float, float]] = field(default_factory=dict)  # where it stood at the last failure [m]
    # places of the robot and the thing when reaching for it failed at once [m]
    in_vain: dict[str, tuple[float, ...]] = field(default_factory=dict)
    rounds: int = 0  # times that what was given up was tried again
    visits: dict[str, int] = field(default_factory=dict)  # of landmarks in search
    looked: bool = False  # around, in search
