"""Checks of a policy while it learns: its curve, and when that says that learning is over."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass

from hazard_ms.agents.learned.weights import unpacked_state
from hazard_ms.learning.settings import Settings


@dataclass(frozen=True)
class Check:
    """The worth of a policy at some time of its training."""

    decisions: int  # so far
    seconds: float  # so far, wall time, without what came before the training
    training: float  # mean Value of the episodes that ended since the last check; if none did, that of the last check
    validation: float  # mean Value in the validation scenes
    greedy: float  # that of the policy `greedy` in the same episodes
    best: float  # greatest validation so far


def curve_of(packed: bytes) -> list[Check]:
    """The curve of a training up to where its state was saved.

    Raises ValueError for numbers that are not finite, and errors of many kinds for anything else.
    """
    found = [Check(**check) for check in unpacked_state(packed)["curve"]]
    if not all(isinstance(value, int | float) and math.isfinite(value) for check in found for value in astuple(check)):
        raise ValueError("the training curve must hold only finite numbers, got other values")
    return found


def ended(curve: Sequence[Check], settings: Settings, decisions: int, minutes: float) -> bool:
    """Whether a training is over: after so many `decisions`, so many `minutes`, or checks without a better policy."""
    best = max(range(len(curve)), key=lambda k: curve[k].validation, default=0)
    stuck = 0 < settings.patience < len(curve) - best
    return stuck or bool(curve) and (curve[-1].decisions >= decisions or curve[-1].seconds >= 60.0 * minutes)
