"""The scores of the HAZARD challenge over episodes (docs/benchmark.md 4), each with a bootstrap interval over scenes.

    Value  = mean over episodes of  value rescued / value of all targets at the start;  a target rescued damaged counts
           half
    Step   = sum over episodes of the frame of the last rescue / sum of targets rescued;  None when nothing is rescued
    Damage = targets rescued damaged / targets rescued, over all episodes together;  None when nothing is rescued

Value and Damage are shares, 0 to 1; the paper prints them times 100. Read Step only beside Value: rescuing 1 of 15
quickly looks good in Step.

Episodes in one scene are alike: where neither task nor agent draws by chance they are even equal, whatever their seeds.
The bootstrap therefore draws scenes, each with all of its episodes, and only in a single scene its episodes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.foreign.plain import Within

RESAMPLES = 10_000  # of the bootstrap: the ends of a 95 % interval are then known to about 1 % of its width
LEVEL = 0.95  # of the interval


@dataclass(frozen=True)
class Fate:
    """The fate of one target. Raises ValueError where `rescued` and `frame` disagree."""

    name: str
    category: str
    value: Annotated[float, Within(1e-6, 1e6)]  # 1 or 5 in our tasks
    rescued: bool
    damaged: bool  # when it was rescued, or at the end
    frame: Annotated[int | None, Within(0, 10_000_000)] = None  # of the rescue
    damaged_frame: Annotated[int | None, Within(0, 10_000_000)] = None  # of the first damage

    def __post_init__(self) -> None:
        if self.rescued != (self.frame is not None):
            raise ValueError(
                f"frame of {self.name} must be given exactly when it was rescued, got {self.frame} with "
                f"rescued={self.rescued}"
            )

    @property
    def worth(self) -> float:
        """The value that was rescued with it: half where it was damaged, 0 where it was not rescued."""
        return self.value * (DAMAGED_SHARE if self.damaged else 1.0) if self.rescued else 0.0


@dataclass(frozen=True)
class Tally:
    """The part of one episode in the scores."""

    value_rescued: float  # damaged ones at half
    value_total: float
    rescued: int
    rescued_damaged: int
    last_rescue: int  # frame; 0 when nothing was rescued

    @classmethod
    def of(cls, fates: Sequence[Fate]) -> Tally:
        """The tally of an episode whose targets met these fates. Raises ValueError where there are no targets."""
        if not fates:
            raise ValueError("fates must hold at least one target, got none")
        saved = [f for f in fates if f.rescued]
        return cls(
            value_rescued=sum(f.worth for f in saved),
            value_total=sum(f.value for f in fates),
            rescued=len(saved),
            rescued_damaged=sum(f.damaged for f in saved),
            last_rescue=max((f.frame for f in saved if f.frame is not None), default=0),
        )

    @property
    def value(self) -> float:
        """Share of the value that was rescued, 0 to 1."""
        return self.value_rescued / self.value_total


@dataclass(frozen=True)
class Score:
    """A score and its 95 % interval over scenes; None where it is undefined."""

    mean: float | None
    low: float | None
    high: float | None


def value(tallies: Sequence[Tally]) -> float | None:
    """Value of a set of episodes, 0 to 1."""
    return float(np.mean([t.value for t in tallies])) if tallies else None


def step(tallies: Sequence[Tally]) -> float | None:
    """Step of a set of episodes [frames]."""
    rescued = sum(t.rescued for t in tallies)
    return sum(t.last_rescue for t in tallies) / rescued if rescued else None


def damage(tallies: Sequence[Tally]) -> float | None:
    """Damage of a set of episodes, 0 to 1."""
    rescued = sum(t.rescued for t in tallies)
    return sum(t.rescued_damaged for t in tallies) / rescued if rescued else None


SCORES: dict[str, Callable[[Sequence[Tally]], float | None]] = {"value": value, "step": step, "damage": damage}


def scores(
    tallies: Sequence[Tally], scenes: Sequence[str] | None = None, seed: int = 0, resamples: int = RESAMPLES
) -> dict[str, Score]:
    """Value, Step and Damage of episodes; `seed` is that of the bootstrap.

    `scenes`: that of each episode, None for one of its own each. Raises ValueError for no episodes, and unless there
    are as many scenes.
    """
    if not tallies:
        raise ValueError("tallies must hold at least one episode, got none")
    parts = np.array([(t.value, t.last_rescue, t.rescued_damaged, t.rescued, 1.0) for t in tallies], np.float64)
    worth, last, damaged, rescued, count = resampled(parts, scenes, seed, resamples).T
    with np.errstate(invalid="ignore", divide="ignore"):
        drawn = {
            "value": worth / count,
            "step": np.where(rescued > 0, last / rescued, np.nan),
            "damage": np.where(rescued > 0, damaged / rescued, np.nan),
        }
    return {name: interval(compute(tallies), drawn[name]) for name, compute in SCORES.items()}


def resampled(
    parts: NDArray[np.float64], scenes: Sequence[str] | None, seed: int, resamples: int = RESAMPLES
) -> NDArray[np.float64]:
    """The sums over each resample, [R, C], of what N episodes add to C of them, `parts` [N, C], in units of their own.

    Scenes are drawn, each with all of its episodes; `scenes` is that of each episode, [N], None for one of its own
    each. Of a single scene episodes are drawn. Raises ValueError unless there are N scenes.
    """
    own = np.arange(len(parts))
    if scenes is not None and len(scenes) != len(parts):
        raise ValueError(f"scenes must be {len(parts)}, one for each episode, got {len(scenes)}")
    of = own if scenes is None or len(set(scenes)) == 1 else np.unique(np.asarray(scenes), return_inverse=True)[1]
    count = int(of.max()) + 1
    chosen = np.random.default_rng(seed).integers(count, size=(resamples, count))
    columns = (np.bincount(of, weights=column, minlength=count) for column in parts.T)
    return np.stack([column[chosen].sum(1) for column in columns], axis=-1)


def interval(mean: float | None, drawn: NDArray[np.float64]) -> Score:
    """The score `mean` and its 95 % interval, given that of each resample, `drawn` [R]; NaN where it is undefined."""
    defined = drawn[np.isfinite(drawn)]
    if mean is None or not len(defined):
        return Score(mean, None, None)
    low, high = np.quantile(defined, [(1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0])
    return Score(mean, float(low), float(high))
