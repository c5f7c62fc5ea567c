"""The value lost at the end, the loads on a robot, and the score `averted` (docs/benchmark.md 4.3).

    averted = (L0 - L1) / L0

L0 is the value lost at the end of the task's full time if nobody acts, L1 that with the agent. It is undefined where
L0 is 0: such episodes are left out of means, and counted. It is below 0 where the agent does harm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hazard_ms.evaluation.metrics import Score, interval, resampled
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.foreign.plain import Within

Worth = Annotated[float, Within(0, 1e9)]  # value, in units of the catalogue
Amount = Annotated[float, Within(0, 1e9)]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Loss:
    """The value lost at the end, of the targets and of all loose things, in units of the catalogue's value."""

    targets: Worth
    targets_total: Worth
    things: Worth
    things_total: Worth

    @classmethod
    def of(cls, value: NDArray[np.float64], target: Bools, gone: Bools, damaged: Bools) -> Loss:
        """The loss of loose things with these values [-], [B], of which some are a `target`, `gone` or `damaged`, [B].

        What is gone is lost whole, what is damaged by the share that Value takes off for it.
        """
        lost = value * np.where(gone, 1.0, np.where(damaged, 1.0 - DAMAGED_SHARE, 0.0))
        sums = (lost[target], value[target], lost, value)
        return cls(*(float(part.sum()) for part in sums))


@dataclass(frozen=True)
class Loads:
    """The loads on a robot in an episode; None where nothing measures them, or hazards do not act on the robot."""

    heat: Amount | None = None  # dose of heat, 1: unbearable for people [-]
    wading: Amount | None = None  # time in which it stood in water [s]
    water: Amount | None = None  # depth of this water, integrated over time [m s]
    collisions: Annotated[int | None, Within(0, 10_000_000)] = None  # with furniture and walls


def mean_loads(loads: Sequence[Loads | None]) -> dict[str, float]:
    """The mean of each load over the episodes that measured it, in its unit, by name; without those that none did."""
    made: dict[str, float] = {}
    for name in (f.name for f in fields(Loads)):
        measured = [value for one in loads if one is not None and (value := getattr(one, name)) is not None]
        if measured:
            made[name] = float(np.mean(measured))
    return made


def averted(lost: Loss | None, alone: Loss | None) -> float | None:
    """The share of what is lost if nobody acts, `alone`, that is not `lost` at the end; None where it is undefined."""
    return None if lost is None or alone is None else _share(lost.targets, alone.targets)


def averted_of_all(lost: Loss | None, alone: Loss | None) -> float | None:
    """The same share as `averted` of the value of all loose things, targets or not; None where it is undefined."""
    return None if lost is None or alone is None else _share(lost.things, alone.things)


def _share(now: float, before: float) -> float | None:
    return (before - now) / before if before > 0.0 else None


def mean_score(values: Sequence[float | None], scenes: Sequence[str] | None = None, seed: int = 0) -> Score:
    """The mean of those of N `values` that are defined, in their unit [-], with its interval over their `scenes`, [N].

    `scenes`: None for one of its own each; `seed` is that of the bootstrap. All None where no value is defined.
    """
    kept = [k for k, value in enumerate(values) if value is not None]
    if not kept:
        return Score(None, None, None)
    numbers = np.array([values[k] for k in kept], np.float64)
    places = None if scenes is None else [scenes[k] for k in kept]
    total, count = resampled(np.stack([numbers, np.ones_like(numbers)], axis=-1), places, seed).T
    return interval(float(numbers.mean()), total / count)
