"""The errors of a detector, as counted in pictures that it was not trained on, and what its looks tell by them.

A look at a thing tells a category, or misses it. With b the bucket of its pixels, k its category, one of L, c clutter:

    P(miss | k)      = 1 - found[b]
    P(told k | k)    = found[b] right[b]
    P(told j | k)    = found[b] (1 - right[b]) taken[k][j]; where it also tells its own chances q of all categories, the
                       sum of these over k is shared out by q^sharpness instead
    P(miss | c)      = 1 - again          c: something else that was once told as j0, or nothing at all
    P(told j0 | c)   = again steady
    P(told j | c)    = again (1 - steady) / (L - 1)

Where the detector tells its own chances, a look that tells something is as sure as it is with the chance real[s] at a
thing and false[s] at c, s being the bucket of the largest of them. `odds_of` holds weights that make odds of all that
such a look shows, which take the place of real[s] : false[s] (hazard_ms.sensing.detection.odds).

Before the second look, c has the weight clutter[j0], the number of such places in a scene, and k that of the number of
k that there are to be found, times `seen`, times the chance that k is told as j0.
"""

from __future__ import annotations

import functools
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.odds import Weights, length_of, odds
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.plain import Within

LARGEST = 1_000_000  # of a file [bytes] [ours]
ONE = 1.0  # look by which each row of `taken` is smoothed [ours]
TINY = 1e-9  # no chance that a detector tells counts as smaller [ours]
LEAST = 1e-3  # no chance is believed to be smaller than this, nor larger than 1 less this [ours]
Share = Annotated[float, Within(0, 1)]
Count = Annotated[float, Within(0, 1e6)]
Name = Annotated[str, Within(1, 100)]


class Look(NamedTuple):
    """One look at a place: what was told there, None for nothing, and the thing's pixels, seen or expected."""

    told: str | None
    pixels: float
    chances: tuple[float, ...] | None = None  # of each category by the detector itself, [L]
    shown: tuple[float, ...] | None = None  # by which a thing is told from what only looks like one


@dataclass(frozen=True)
class Confusion:
    """The errors of a detector, for looks with the eyes with which they were measured."""

    classes: Annotated[tuple[Name, ...], Within(2, 1000)]  # L categories
    pixels: Annotated[tuple[Count, ...], Within(1, 20)]  # least of each bucket, the first 0
    found: Annotated[tuple[Share, ...], Within(1, 20)]  # share of the looks at a thing that was found before, by bucket
    right: Annotated[tuple[Share, ...], Within(1, 20)]  # share of what is found that gets its category, by bucket
    taken: dict[str, dict[str, Count]]  # looks at a category that told another one: the true one, the told one
    clutter: dict[str, Count]  # places in a scene that are told as a category and are none of the L
    again: Share  # share of the looks at such places that tell something once more
    steady: Share  # share of these that tell the same
    seen: Share  # share of the things that are found by any look
    sharpness: Annotated[float, Within(0, 10)] = 0.0  # exponent of a detector's own chances; 0: these do not count
    even: Share = 0.0  # share of them that is spread evenly over all categories
    surer: Annotated[tuple[Share, ...], Within(0, 20)] = ()  # least of each bucket of the largest of them, the first 0
    real: Annotated[tuple[Share, ...], Within(0, 20)] = ()  # shares of the looks at things that are in these buckets
    false: Annotated[tuple[Share, ...], Within(0, 20)] = ()  # the same of looks at clutter
    again_of: dict[Name, Share] = field(default_factory=dict)  # `again` of clutter that was first told as a category
    steady_of: dict[Name, Share] = field(default_factory=dict)  # the same of `steady`
    false_of: dict[Name, Annotated[tuple[Share, ...], Within(0, 20)]] = field(default_factory=dict)  # of `false`
    odds_of: dict[Name, Weights] = field(default_factory=dict)  # of what is shown of a category, in place of `real`
    repeated: Share = 1.0  # exponent of what each look after the first tells: looks at one thing err alike
    eyes: Name = "256/120"  # of the looks; square, whatever rows above and below are left out later
    command: Annotated[str, Within(0, 1000)] = ""  # that measured it

    def __post_init__(self) -> None:
        """Raises ValueError for buckets that do not fit each other, and for categories that are not known."""
        if not len(self.pixels) == len(self.found) == len(self.right):
            raise ValueError(
                f"found and right must have {len(self.pixels)} buckets, like pixels, got {len(self.found)} and "
                f"{len(self.right)}"
            )
        if self.pixels[0] != 0 or list(self.pixels) != sorted(set(self.pixels)):
            raise ValueError(f"pixels must increase from 0, got {self.pixels}")
        if len(set(self.classes)) < len(self.classes):
            raise ValueError(f"classes must be distinct categories, got {self.classes!r:.100}")
        named = {*self.taken, *(told for row in self.taken.values() for told in row), *self.clutter}
        named |= {*self.again_of, *self.steady_of, *self.false_of, *self.odds_of}
        if odd := [row for row in (self.real, self.false, *self.false_of.values()) if len(row) != len(self.surer)]:
            raise ValueError(f"real, false and false_of must have {len(self.surer)} buckets, like surer, got {odd[0]}")
        if bad := sorted(named - set(self.classes)):
            raise ValueError(f"a category of the table must be one of its classes, got {bad[0]!r:.100}")
        if wrong := [name for name, weights in self.odds_of.items() if len(weights) != length_of(name)]:
            name, count = wrong[0], len(self.odds_of[wrong[0]])
            raise ValueError(f"odds_of {name} must have {length_of(name)} weights, got {count}")

    @classmethod
    def read(cls, path: Path) -> Confusion:
        """The table in a file NAME.json. Raises ValueError for a file that holds none."""
        found: Confusion = plain.made(cls, plain.read(path, LARGEST), "confusion")
        return found

    @functools.cached_property
    def off(self) -> NDArray[np.float64]:
        """The chance of each wrong category, [L, L], by the true one: rows sum to 1, 0 on the diagonal."""
        count = np.array([[self.taken.get(k, {}).get(j, 0.0) for j in self.classes] for k in self.classes])
        count += ONE / (len(self.classes) - 1)
        np.fill_diagonal(count, 0.0)
        shares: NDArray[np.float64] = count / count.sum(1, keepdims=True)
        return shares

    def bucket(self, pixels: float) -> int:
        """The number of the bucket of so many pixels."""
        return bisect_right(self.pixels, pixels) - 1

    def share_found(self, pixels: float) -> float:
        """The share of looks at a thing with so many `pixels` that find it again."""
        return self.found[self.bucket(pixels)]

    def told(self, look: Look) -> NDArray[np.float64]:
        """The chance, [L], that a thing of each category that is found is told as in a `look`, which tells something.

        Where the detector gave its own chances, they share out among the categories what all of them have together.
        """
        assert look.told is not None
        number, right = self.classes.index(look.told), _inside(self.right[self.bucket(look.pixels)])
        chances: NDArray[np.float64] = (1.0 - right) * self.off[:, number]
        chances[number] = right
        if look.chances is None or not self.sharpness:
            return chances
        return softened(np.array(look.chances), self.sharpness, self.even) * chances.sum()

    def likelihood(self, look: Look, first: str, expected: Mapping[str, float]) -> NDArray[np.float64]:
        """The chance of a look for each category, and last for clutter that was `first` told so: [L + 1].

        `expected`: see `sure`.
        """
        found = _inside(self.found[self.bucket(look.pixels)])
        again = _inside(self.again_of.get(first, self.again))
        steady = _inside(self.steady_of.get(first, self.steady))
        if look.told is None:
            return np.append(np.full(len(self.classes), 1.0 - found), 1.0 - again)
        clutter = again * (steady if look.told == first else (1.0 - steady) / (len(self.classes) - 1))
        real, false = self.sure(look, first, expected)
        return np.append(found * real * self.told(look), false * clutter)

    def sure(self, look: Look, first: str, expected: Mapping[str, float]) -> tuple[float, float]:
        """The chances that a look at a thing, and one at clutter that was `first` told so, are as sure as this one.

        Of a category that is `expected` in the scene, the odds of the two, where it is known how its looks differ.
        """
        if look.chances is None or not self.surer:
            return 1.0, 1.0
        if look.told in self.odds_of and look.shown is not None and expected.get(look.told):
            return odds(self.odds_of[look.told], look.shown), 1.0
        number = bisect_right(self.surer, max(look.chances)) - 1
        return _inside(self.real[number]), _inside(self.false_of.get(first, self.false)[number])

    def posterior(self, looks: Sequence[Look], expected: Mapping[str, float], usual: float) -> NDArray[np.float64]:
        """The chance of each category, and last that it is none of them, [L + 1], after `looks` at one place.

        The first look has told something. `expected`: how many of each category there are, `usual` where it is silent.
        """
        first = looks[0].told
        assert first is not None
        there = np.array([expected.get(name, usual) for name in self.classes])
        real, false = self.sure(looks[0], first, expected)
        weight = np.append(
            self.seen * there * real * self.told(looks[0]), false * max(self.clutter.get(first, 0.0), LEAST)
        )
        for look in looks[1:]:
            weight = weight * self.likelihood(look, first, expected) ** self.repeated
        chances: NDArray[np.float64] = weight / weight.sum()
        return chances


def softened(chances: NDArray[np.float64], sharpness: float, even: float) -> NDArray[np.float64]:
    """A detector's own `chances`, [..., L], to the power of `sharpness`, a share of which is spread `even`ly."""
    power = np.maximum(chances, TINY) ** sharpness
    made: NDArray[np.float64] = (1.0 - even) * power / power.sum(-1, keepdims=True) + even / chances.shape[-1]
    return made


def _inside(share: float) -> float:
    return min(max(share, LEAST), 1.0 - LEAST)


def within_count(chances: Sequence[float], count: float) -> list[float]:
    """The `chances` that each of some places shows one of the `count` things there are: their sum is at most `count`.

    Where it is larger, the odds of all are divided by the same number until it is not.
    """
    odds = np.array([chance / (1.0 - min(chance, 1.0 - LEAST)) for chance in chances])
    if sum(chances) <= count:
        return list(chances)
    if count <= 0.0:
        return [0.0] * len(chances)
    low, high = 0.0, 1.0  # factors on the odds
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if (middle * odds / (1 + middle * odds)).sum() < count else (low, middle)
    return (low * odds / (1 + low * odds)).tolist()
