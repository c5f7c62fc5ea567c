"""The beliefs in all tracks of an episode, where of each category only so many things are there as was told before.

Limits: carts are taken to stand apart, and each thing to lie where it does for reasons of its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from hazard_ms.sensing.detection.confusion import LEAST, within_count
from hazard_ms.sensing.detection.fusion import category_of
from hazard_ms.sensing.detection.track import CART, Track

SELF, CROWD = 0.7, 1.5  # distances between which other carts hardly stand, but other parts of a fence do [m] [ours]
CROWDED = 0.3  # by which each other one there changes the odds that one is a cart [-] [ours]
FEW = 3  # others that count at most [ours]


def believed(
    tracks: Sequence[Track], sure: Collection[Track], expected: Mapping[str, int]
) -> list[tuple[Track, str, float]]:
    """The category and the belief of each track that has evidence, is not refuted and not `sure` to be what it is.

    `expected`: how many things of each category were told, of which the `sure` tracks are some.
    """
    left = Counter(expected)
    left.subtract(Counter(track.category for track in sure))
    open_ones, kinds, chances = [], [], []
    for track in tracks:
        if track.evidence is not None and not track.refuted and track not in sure:
            each = track.evidence.chances(expected)
            open_ones.append(track)
            kinds.append(category_of(each, track.category))
            chances.append(each.get(kinds[-1], 0.0))
    return list(zip(open_ones, kinds, shared(kinds, crowded(open_ones, kinds, chances), left), strict=True))


def crowded(tracks: Sequence[Track], kinds: Sequence[str], chances: Sequence[float]) -> list[float]:
    """The `chances` of `tracks` of these `kinds`, where a cart beside many others is rather a fence."""
    carts = [number for number, kind in enumerate(kinds) if kind == CART]
    made = list(chances)
    if len(carts) < 2:
        return made
    places = np.array([tracks[number].sighting.position[:2] for number in carts])
    away = np.linalg.norm(places[:, None] - places[None], axis=-1)
    others = ((away > SELF) & (away < CROWD)).sum(1)
    for number, count in zip(carts, others.tolist(), strict=True):
        odds = made[number] / (1.0 - min(made[number], 1.0 - LEAST)) * CROWDED ** min(count, FEW)
        made[number] = odds / (1.0 + odds)
    return made


def shared(kinds: Sequence[str], chances: Sequence[float], counts: Mapping[str, int]) -> list[float]:
    """The `chances` of places that seem to be of `kinds`, where `counts` of a kind are left; any number of others."""
    made = list(chances)
    for kind, count in counts.items():
        mine = [number for number, each in enumerate(kinds) if each == kind]
        for number, chance in zip(mine, within_count([made[n] for n in mine], count), strict=True):
            made[number] = chance
    return made
