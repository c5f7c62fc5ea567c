"""Things as an agent finds them by itself: tracks of detections, named in the order in which they were found.

The agent is told before what there is to rescue: two bowls are `bowl#1` and `bowl#2`. The first bowl that is found is
`bowl#1`, whichever it is in truth. Where more are found than there are, or other things, they get names and indices
behind these. What a hand takes at a track is what lies there in truth. Of the carts that are found, as many as there
are count, the surest ones, until a drop finds none there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.beliefs import believed
from hazard_ms.sensing.detection.carts import lies_in, surest
from hazard_ms.sensing.detection.detector import Detector
from hazard_ms.sensing.detection.hand import loose_things, nearest_to
from hazard_ms.sensing.detection.labeller import DetectingLabeller
from hazard_ms.sensing.detection.numbered import found_in, labels_of, numbered
from hazard_ms.sensing.detection.track import CART_WIDEST, WIDEST, Track
from hazard_ms.sensing.detection.tracks import ENOUGH, Tracker
from hazard_ms.sensing.observations import SLOTS
from hazard_ms.sensing.sighting import sightings
from hazard_ms.sensing.target_table import Target
from hazard_ms.sensing.view import View
from hazard_ms.simulation.world import World
from hazard_ms.spec.checks import one_of

WITHIN = 0.35  # distance from where a thing is believed to be within which a hand finds what is there [m] [ours]
CART_WITHIN = 1.0  # the same for carts, by their middles [m] [ours]
MOST_THINGS = 512  # that are given names; scenes have up to 200 things [ours]
LEAST, FORGET = 0.1, 0.03  # beliefs from which an agent is told of a track, and below which no more [ours]
CART_LEAST, CART_FORGET = 0.4, 0.15  # the same of a cart, to which a way may be in vain with something in hand [ours]
UNSURE = MOST_THINGS  # label of pixels that may be of something that can move


class OwnLabeller(DetectingLabeller):
    """An agent's own tracks; truth only tells what a hand meets, what it holds, and whether that is safe."""

    def __init__(
        self, world: World, containers: Sequence[str], detector: Detector, threshold: float, fused: bool = False
    ) -> None:
        """Begin an episode in `world`; detections of `detector` with a score below `threshold` do not count.

        `fused`: whether looks are fused by the errors of the detector, where these are known.
        """
        super().__init__(world, containers, detector, threshold, fused)
        self._carts = [world.index(0, name) for name in containers]
        rows, count = self._table.rows(world), Counter[str]()
        self._told: list[Target] = []
        names = []
        for category in [*(row.category for row in rows), *(self._categories[cart] for cart in self._carts)]:
            count[category] += 1
            names.append(f"{category}#{count[category]}")
        for index, row in enumerate(rows):
            self._told.append(replace(row, index=index, name=names[index], rescued=False, held=False))
        self.names, self.containers = tuple(names), tuple(names[len(rows) :])
        self._count = count
        self._kinds = [name.partition("#")[0] for name in names]
        self.loose = np.ones(MOST_THINGS + 1, bool)
        self.loose[len(rows) : len(names)] = False  # carts stay where they are
        self._tracker = Tracker(self._confusion)
        self._expected = Counter(self._kinds)  # of each category, as the agent is told before the episode
        self._by_index: dict[int, Track] = {}
        self._reached: dict[int, Track] = {}  # by index: what the hand reached for last
        self._taken: tuple[Track, int] | None = None  # the track in the hand, and the index along B of what it is
        self._stowed: list[Track] = []  # in the bag
        self._lost: list[int] = []  # at the last look
        self._missed: list[int] = []  # since the last look

    def view(self, rgb: NDArray[np.uint8] | None, true: View, frame: int) -> View:
        assert true.labels is not None
        found = self._detect(rgb, true, frame)
        carts = {number for number, detection in enumerate(found) if self._seeks(detection.category)}
        view = numbered(true, found, self._own(true.labels), carts)
        seen = sightings(view, frame, len(found), frozenset(), None)
        self._let_go()
        out_of_sight = [*self._stowed, *([self._taken[0]] if self._taken else [])]
        named = {n: found_in(view, n, found[n], sighting, n in carts) for n, sighting in seen.items()}
        tracks, lost = self._tracker.update(view, frame, named, out_of_sight)
        self._lost = [*self._missed, *(track.index for track in lost if track.index >= 0)]
        self._missed = []
        for track in lost:
            self._by_index.pop(track.index, None)
        for number, track in tracks.items():
            track.score = max(track.score, found[number].score)
        if self._confusion is not None:
            self._believe(out_of_sight)
        near = [track for track in self._tracker.tracks if track not in out_of_sight]
        self._pass_over(near)
        for track in tracks.values():
            self._introduce(track)
        self.containers = self._surest_carts()
        return replace(true, labels=labels_of(view, tracks, near, frame, UNSURE))

    def _seeks(self, category: str) -> bool:
        """Whether it is one of carts, which the agent seeks."""
        return bool(self._carts) and category == self._categories[self._carts[0]]

    def _introduce(self, track: Track) -> None:
        """Give a track that was seen often enough its index: one of what was told if that is free, else a new one."""
        often = track.frames >= ENOUGH or (track.evidence is not None and not track.loose)  # a cart by its odds
        if track.index >= 0 or not often or track.refuted or track.belief < self._limits(track)[0]:
            return
        free = [i for i, kind in enumerate(self._kinds) if kind == track.category and i not in self._by_index]
        if free:
            track.index = free[0]
        elif len(self.names) < MOST_THINGS:
            track.index = len(self.names)
            self._count[track.category] += 1
            self.names = (*self.names, f"{track.category}#{self._count[track.category]}")
            self._kinds.append(track.category)
            self.loose[track.index] = track.loose
            same = next((row for row in self._told if row.category == track.category), None)
            if same is not None and len(self._told) < SLOTS:
                self._told.append(replace(same, index=track.index, name=self.names[track.index]))
        if track.index >= 0:
            self._by_index[track.index] = track

    def _believe(self, gone: Sequence[Track]) -> None:
        """Form the beliefs in all tracks anew from the evidence; those of categories that cannot all be there share it.

        Tracks that are `gone`, in the hand or the bag, and rescued ones are what they were taken for. A track that
        changes its category, or is hardly believed any more, loses its index.
        """
        sure = [*gone, *(t for t in self._tracker.tracks if t.rescued and t not in gone)]
        for track, category, belief in believed(self._tracker.tracks, sure, self._expected):
            track.belief = belief
            if category != track.category or track.belief < self._limits(track)[1]:
                self._drop(track)
            track.category = category

    def _pass_over(self, tracks: Sequence[Track]) -> None:
        """Refute those of `tracks` that lie in a cart, and are none that the agent put there: they are safe."""
        carts = self._believed_carts()
        for track in tracks if carts else ():
            if track.loose and not track.rescued and not track.refuted and lies_in(track, carts):
                self._drop(track)
                track.refuted = True

    def _drop(self, track: Track) -> None:
        """Take its index from a track, which stays."""
        if self._by_index.get(track.index) is track:
            del self._by_index[track.index]
            self._lost.append(track.index)
        track.index = -1

    def _limits(self, track: Track) -> tuple[float, float]:
        """The beliefs from which an agent is told of a track, and below which no more."""
        return (CART_LEAST, CART_FORGET) if self._seeks(track.category) else (LEAST, FORGET)

    def _is_cart(self, index: int) -> bool:
        """Whether the agent takes the thing `index` for a cart."""
        return self._seeks(self._kinds[index])

    def _surest_carts(self) -> tuple[str, ...]:
        """The names of the carts that count, in the order of their indices: as many as there are in truth.

        They are those of the surest detections; where too few are found, names of others that must be somewhere.
        """
        count = sorted(track.index for track in self._believed_carts())
        names = [name for i, name in enumerate(self.names) if self._is_cart(i) and i not in self._by_index]
        return (*(self.names[index] for index in count), *names)[: len(self._carts)]

    def _believed_carts(self) -> list[Track]:
        return surest([track for index, track in self._by_index.items() if self._is_cart(index)], len(self._carts))

    def missed(self, index: int) -> None:
        track = self._by_index.pop(index, None)
        if track is not None:
            track.index, track.refuted = -1, True
            self._missed.append(index)
        self.containers = self._surest_carts()

    def refused(self, index: int, other: bool) -> None:
        track = self._by_index.get(index)
        if self._confusion is not None and track is not None and not track.rescued and (other or self.thing(index) < 0):
            self.missed(index)

    def _let_go(self) -> None:
        """Note what has become of the thing that was in the hand, once it is not there any more."""
        if self._taken is None or bool(self._world.held[0, self._taken[1]]):
            return
        track, thing = self._taken
        self._taken = None
        track.rescued = bool(self._world.safe[0, thing])
        if bool(self._world.away[0, thing]):
            self._stowed.append(track)
        else:  # the hand knows where it let go of it
            place = self._world.position[0, thing].cpu().numpy().astype(np.float32)
            track.sighting = replace(track.sighting, position=place, pixels=0)

    def index(self, name: str) -> int:
        return self.names.index(one_of(name, self.names, "a thing"))

    def thing(self, index: int) -> int:
        if index not in self._by_index:
            return -1
        place, cart = self._by_index[index].sighting.position, self._is_cart(index)
        there = self._carts if cart else loose_things(self._world)
        return nearest_to(self._world, there, place, CART_WITHIN if cart else WITHIN, 2 if cart else 3)

    def reach_for(self, index: int) -> int:
        if index in self._by_index:
            self._reached[index] = self._by_index[index]
        return self.thing(index)

    def half_width(self, index: int) -> float:
        return WIDEST if self.loose[index] else CART_WIDEST if self._is_cart(index) else float("inf")

    def targets(self, damaged: frozenset[int] = frozenset()) -> tuple[Target, ...]:
        held = self._held_track()
        made = []
        for row in self._told:
            track = self._by_index.get(row.index)
            rescued, in_hand = track is not None and track.rescued, track is not None and track is held
            belief = 1.0 if track is None or rescued or in_hand else track.belief
            made.append(replace(row, rescued=rescued, held=in_hand, damaged=row.index in damaged, belief=belief))
        return tuple(made)

    def damaged(self, true: NDArray[np.bool_]) -> NDArray[np.bool_] | None:
        return None

    def unmapped(self) -> list[int]:
        held = self._held_track()
        gone = [*self._stowed, *([held] if held else [])]
        return [*(track.index for track in gone), *self._lost, UNSURE]

    @property
    def held(self) -> str | None:
        track = self._held_track()
        return None if track is None else self.names[track.index]

    def _held_track(self) -> Track | None:
        """The track in the hand."""
        self._let_go()
        return self._taken[0] if self._taken else None

    def took(self, index: int) -> None:
        held, track = np.flatnonzero(self._world.held[0].cpu().numpy()), self._reached.get(index)
        track = track or self._by_index[index]
        if self._by_index.get(index) is not track:  # a look on the way has made it something else
            if index in self._by_index:
                self._drop(self._by_index[index])
            track.index, self._by_index[index] = index, track
        self._taken = track, int(held[0])
