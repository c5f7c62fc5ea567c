"""The problem of a rescue, and its plan: targets lose value when they are damaged, there is one hand, and no time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hazard_ms.sketch.planning.travel import Spot, Travel, refuse_unless_frames


class Stow(NamedTuple):
    """One way of putting a target away: the frame at which it is safe, where one stands then, the cart or -1."""

    safe: float
    spot: Spot
    cart: int


@dataclass(frozen=True, eq=False)
class Problem:
    """The problem of rescuing as much value as possible by `limit`, with one hand.

    A target is met, picked up and put into the bag there, or carried to a cart where `travel` has carts. It counts
    its value if it is safe by `damaged_at`, else `damaged_share` of it. Frames may be fractions. With `fading` it
    counts less the later it is safe, since much can go wrong until then: of plans that save the same, the best is the
    one that saves valuable targets first. With `spread` it counts by the chances that it is safe in time, and before
    it is damaged, where rescues take longer or shorter than planned: of two plans, the one with time to spare may be
    better.
    """

    travel: Travel
    values: Sequence[float]  # [M]
    damaged_at: Sequence[float]  # last frame at which each target is whole; inf: it never is damaged, [M]
    pick: Sequence[float]  # frames that picking up takes, [M]
    drop: Sequence[float]  # frames that putting away takes: into the bag [M], else into each cart [C]
    limit: float  # last frame at which a rescue counts
    frame: float = 0.0  # now
    holding: int | None = None  # the target in the hand: it must be put away first
    damaged_share: float = 0.5  # of its value that a damaged target counts
    fading: float = 0.0  # share of its value by which a target counts less with every frame until it is safe
    spread: float = 0.0  # standard deviation of the frames that a plan takes, over their root [sqrt(frames)]
    shares: Sequence[float] | None = None  # as `damaged_share`, of each target where they differ, [M]
    gone_at: Sequence[float] | None = None  # last frame before each is carried off (averting.py); inf: never, [M]

    def __post_init__(self) -> None:
        """Raises ValueError for wrong lengths, for NaN, and for negative or infinite numbers that must not be."""
        targets, carts = self.travel.targets, self.travel.carts
        lengths = {"values": targets, "damaged_at": targets, "pick": targets, "drop": carts or targets}
        lengths |= {name: targets for name in ("shares", "gone_at") if getattr(self, name) is not None}
        for name, length in lengths.items():
            numbers = np.array(getattr(self, name), np.float64)
            if numbers.shape != (length,):
                raise ValueError(f"{name} must have shape ({length},), got {numbers.shape}")
            refuse_unless_frames(numbers, name)
            if name not in ("damaged_at", "gone_at") and not np.isfinite(numbers).all():
                raise ValueError(f"{name} must hold finite numbers, got {numbers.max()}")
            object.__setattr__(self, name, tuple(numbers.tolist()))
        for name in ("limit", "frame"):
            if not 0 <= getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be a frame of at least 0, got {getattr(self, name)}")
        if not 0 <= self.damaged_share <= 1:
            raise ValueError(f"damaged_share must be from 0 to 1, got {self.damaged_share}")
        if max(self.shares or (), default=0.0) > 1.0:
            raise ValueError(f"shares must be from 0 to 1, got {max(self.shares or ())}")
        if not 0 <= self.fading * max(self.limit - self.frame, 1.0) <= 1:
            raise ValueError(f"fading must be from 0 to 1 over the frames up to the limit, got {self.fading}")
        if not 0 <= self.spread < np.inf:
            raise ValueError(f"spread must be finite and at least 0, got {self.spread}")
        if self.holding is not None and not 0 <= self.holding < targets:
            raise ValueError(f"holding must be None or a target from 0 to {targets - 1}, got {self.holding}")

    def worth(self, target: int, safe: float) -> float:
        """The value that the target counts if it is safe at a frame, the limit not considered."""
        by = self.damaged_at[target]
        whole = self._in_time(safe, by) if safe <= by else 0.0
        damaged = self.share(target)
        share = damaged + (1.0 - damaged) * whole
        return self.values[target] * share * (1.0 - self.fading * (safe - self.frame)) * self._in_time(safe, self.limit)

    def share(self, target: int) -> float:
        """The share of its value that a target counts when it is damaged."""
        return self.damaged_share if self.shares is None else self.shares[target]

    def _in_time(self, safe: float, by: float) -> float:
        """The chance that what is planned to be safe at the frame `safe` is so at the frame `by`."""
        if not self.spread:
            return 1.0
        deviation = self.spread * math.sqrt(max(safe - self.frame, 1.0))
        return 0.5 * (1.0 + math.erf((by - safe) / deviation / math.sqrt(2.0)))

    def stows(self, target: int, spot: Spot, frame: float) -> Iterator[Stow]:
        """All ways of putting away a target that is in the hand at a spot and frame."""
        if not self.travel.carts:
            yield Stow(frame + self.drop[target], spot, -1)
        else:
            for cart, way in enumerate(self.travel.to_carts(spot)):
                yield Stow(frame + way + self.drop[cart], (self.travel.targets + cart, 0), cart)


class PlannedRescue(NamedTuple):
    """One step of a plan. `met` is the frame at which it is reached, or now for what is in the hand already."""

    target: int
    met: float
    safe: float  # frame
    value: float  # that it adds
    cart: int  # -1: the bag


@dataclass(frozen=True)
class Plan:
    """The order of rescues that a search found, and what is proven about it."""

    rescues: tuple[PlannedRescue, ...]
    value: float
    frame: float  # at which the last rescue is done; now where there is none
    exact: bool  # proven: no plan is worth more, and none that is worth as much is done earlier
    gap: float  # at most this much more value could be rescued
    labels: int  # partial plans that were kept


def soonest(problem: Problem) -> PlannedRescue | None:
    """The rescue that begins first, although it is unlikely to be safe in time; None where none begins in time."""
    travel, held = problem.travel, problem.holding
    if held is not None:
        carts = travel.to_carts(travel.start)
        return PlannedRescue(held, problem.frame, problem.limit, 0.0, int(np.argmin(carts)) if carts else -1)
    met = [frame for frame, _ in travel.meetings(travel.start, problem.frame, range(travel.targets))]
    first = int(np.argmin(met))
    return PlannedRescue(first, met[first], problem.limit, 0.0, 0) if met[first] < problem.limit else None
