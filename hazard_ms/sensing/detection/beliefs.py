"""The beliefs in all tracks of an episode, where of each category only so many things are there as was told before."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence

from hazard_ms.sensing.detection.confusion import within_count
from hazard_ms.sensing.detection.fusion import category_of
from hazard_ms.sensing.detection.tracks import Track


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
    return list(zip(open_ones, kinds, shared(kinds, chances, left), strict=True))


def shared(kinds: Sequence[str], chances: Sequence[float], counts: Mapping[str, int]) -> list[float]:
    """The `chances` of places that seem to be of `kinds`, where `counts` of a kind are left; any number of others."""
    made = list(chances)
    for kind, count in counts.items():
        mine = [number for number, each in enumerate(kinds) if each == kind]
        for number, chance in zip(mine, within_count([made[n] for n in mine], count), strict=True):
            made[number] = chance
    return made
