"""Fused tracks: which looks count, what the same place is told as, and what agents then know."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.detection.beliefs import believed, shared
from hazard_ms.sensing.detection.confusion import Look
from hazard_ms.sensing.detection.fusion import Evidence, category_of
from hazard_ms.sensing.detection.own import OwnLabeller
from hazard_ms.sensing.detection.track import GATE, Found, Track
from hazard_ms.sensing.detection.tracks import CLOSE, Tracker, pairs
from hazard_ms.sensing.view import View
from hazard_ms.simulation.world import World
from tests.sensing.detection.test_confusion import TABLE
from tests.sensing.detection.test_own import BOOK, MUG_1, MUG_2, SCENE, Told, at, look
from tests.sensing.detection.test_tracks import seen
from tests.worlds.wall import view

HERE, BESIDE = np.array([0.0, 0.0, 1.0]), np.array([0.4, 0.0, 1.0])
ELSEWHERE = np.array([0.5, 0.0, 1.0])


def moved(depth: float) -> View:
    """A wall at a distance [m], seen from 0.6 m farther ahead."""
    made = view(depth)
    pose = made.cam2world.copy()
    pose[0, 3] = 0.6
    return replace(made, cam2world=pose)


def test_of_looks_from_one_place_the_one_with_the_most_pixels_counts() -> None:
    mine = Evidence(TABLE, Look("mug", 20), HERE)
    mine.look(Look(None, 15), BESIDE)
    mine.look(Look(None, 30), BESIDE)  # what was found first was found
    assert mine.looks == (Look("mug", 20),)
    mine.look(Look("bowl", 40), BESIDE)
    mine.look(Look(None, 10), ELSEWHERE)
    mine.look(Look("mug", 10), ELSEWHERE)
    assert mine.looks == (Look("bowl", 40), Look(None, 10))
    mine.look(Look("mug", 11), ELSEWHERE)
    assert mine.looks == (Look("bowl", 40), Look("mug", 11))


def test_a_track_changes_its_category_for_one_that_is_twice_as_likely() -> None:
    assert category_of({"mug": 0.3, "bowl": 0.59}, "mug") == "mug"
    assert category_of({"mug": 0.3, "bowl": 0.61}, "mug") == "bowl"
    assert category_of({"mug": 0.3, "bowl": 0.2}, "table") == "mug"


def test_a_detection_of_another_category_goes_on_with_a_track_only_where_it_is_close_and_nothing_better_is() -> None:
    tracks = [Track("mug", seen(2.0, 0.0, 0))]
    other = [Found("bowl", seen(2.0, CLOSE - 0.01, 1))]
    assert pairs(tracks, other, 1) == [] and pairs(tracks, other, 1, fused=True) == [(0, 0)]
    assert pairs(tracks, [Found("bowl", seen(2.0, CLOSE + 0.01, 1))], 1, fused=True) == []
    both = [Found("bowl", seen(2.0, 0.01, 1)), Found("mug", seen(2.0, GATE - 0.01, 1))]
    assert pairs(tracks, both, 1, fused=True) == [(0, 1)], "its own category, though that is farther away"


def test_what_should_be_seen_and_is_not_tells_against_it_and_what_is_hidden_does_not() -> None:
    """At 2 m before a wall at 2.1 m; then something at 1 m is before it."""
    tracker = Tracker(TABLE)
    ((_, track),) = tracker.update(view(2.1), 0, {0: Found("mug", seen(2.0, 0.0, 0))})[0].items()
    assert track.evidence is not None and track.evidence.looks == (Look("mug", 50),)
    tracker.update(moved(1.0), 1, {})
    assert len(track.evidence.looks) == 1
    tracker.update(moved(1.5), 2, {})
    # 50 pixels at 2 m are 50 (2 / 1.4)^2 at 1.4 m
    assert track.evidence.looks[1] == Look(None, pytest.approx(50 * (2.0 / 1.4) ** 2, rel=1e-5))
    assert tracker.tracks == [track]


def test_what_a_detector_gives_itself_goes_into_the_evidence() -> None:
    tracker = Tracker(TABLE)
    ((_, track),) = tracker.update(view(2.1), 0, {0: Found("mug", seen(2.0, 0.0, 0), (0.5, 0.3, 0.1))})[0].items()
    assert track.evidence is not None and track.evidence.looks == (Look("mug", 50, (0.5, 0.3, 0.1)),)


def covered(columns: slice = slice(40, 55)) -> View:
    """A wall close behind things that were 2 m away, seen from 0.6 m farther ahead; some pixels are of detection 0."""
    made = moved(1.5)
    labels = np.full(made.depth.shape, STRUCTURE, np.int64)
    labels[45:55, columns] = 0
    return replace(made, labels=labels)


def test_two_tracks_of_a_category_that_one_detection_covers_are_one_thing() -> None:
    """Two mugs at 2 m, 0.2 m apart, are 7 pixels apart at 1.4 m: both are in the mask of the one mug that is there."""
    tracker = Tracker(TABLE)
    far = {n: Found("mug", seen(2.0, y, 0)) for n, y in enumerate((0.0, 0.2))}
    first, second = tracker.update(view(2.1), 0, far)[0].values()
    second.index = 5
    near = Found("mug", replace(seen(2.0, 0.01, 1), pixels=150))
    matched, lost = tracker.update(covered(), 1, {0: near})
    assert matched == {0: second} and tracker.tracks == [second] and lost == [first], "the one that the agent knows"
    assert second.evidence is not None and second.evidence.looks == (Look("mug", 150), Look("mug", 50))
    assert second.sighting.position[1] == pytest.approx(0.01)


def test_of_two_tracks_that_the_agent_knows_the_one_is_kept_that_was_seen_more_often() -> None:
    tracker, far = Tracker(TABLE), {n: Found("mug", seen(2.0, y, 0)) for n, y in enumerate((0.0, 0.2))}
    new, old = tracker.update(view(2.1), 0, far)[0].values()
    new.index, old.index, old.frames = 4, 5, 9
    near = Found("mug", replace(seen(2.0, 0.01, 1), pixels=150))
    assert tracker.update(covered(), 1, {0: near}) == ({0: old}, [new])


def test_what_is_beside_a_detection_or_refuted_or_of_another_category_is_another_thing() -> None:
    for category, columns, refuted in (
        ("mug", slice(48, 55), False),
        ("mug", slice(40, 55), True),
        ("bowl", slice(40, 55), False),
    ):
        tracker = Tracker(TABLE)
        far = {0: Found("mug", seen(2.0, 0.0, 0)), 1: Found(category, seen(2.0, 0.2, 0))}
        first, second = tracker.update(view(2.1), 0, far)[0].values()
        second.refuted = refuted
        matched, lost = tracker.update(covered(columns=columns), 1, {0: Found("mug", seen(2.0, 0.01, 1))})
        assert matched == {0: first} and tracker.tracks == [first, second] and lost == []
        assert second.evidence is not None and second.evidence.looks[-1].told is None, "it was missed"


def test_a_detection_whose_mask_covers_a_place_goes_on_with_its_track_from_farther_away() -> None:
    tracks = [Track("mug", seen(2.0, 0.0, 0)), Track("bowl", seen(2.0, 0.0, 0))]
    one = [Found("mug", seen(2.0, GATE + 0.1, 1))]
    covers = np.ones((2, 1), bool)
    assert pairs(tracks, one, 1, fused=True) == []
    assert pairs(tracks, one, 1, fused=True, covers=covers) == [(0, 0)], "rather with that of its category"
    assert pairs(tracks[1:], one, 1, fused=True, covers=covers[1:]) == [(0, 0)]


def test_of_joined_looks_from_one_place_those_that_tell_count_and_of_these_the_one_with_the_most_pixels() -> None:
    mine, other = (Evidence(TABLE, Look("mug", pixels), HERE) for pixels in (20, 30))
    mine.look(Look(None, 90), ELSEWHERE)
    other.look(Look("bowl", 10), ELSEWHERE)
    other.look(Look(None, 5), 2.0 * ELSEWHERE + HERE)
    mine.join(other)
    assert mine.looks == (Look("mug", 30), Look("bowl", 10), Look(None, 5))


def test_a_mask_that_is_wider_than_a_thing_can_be_does_not_make_it_reach_farther() -> None:
    """A cart reaches 0.55 m from its middle, what can be carried 0.3 m; furniture as far as was seen of it."""
    for category, reach in (("cart", 0.55), ("mug", 0.3), ("table", 5.0)):
        assert Track(category, seen(2.0, 0.0, 0, radius=5.0)).radius == reach
    cart = [Track("cart", seen(2.0, 0.0, 0, radius=5.0))]
    assert pairs(cart, [Found("cart", seen(2.0, GATE + 0.56, 1))], 1) == []
    assert pairs(cart, [Found("cart", seen(2.0, GATE + 0.54, 1))], 1) == [(0, 0)]


def test_without_errors_that_are_known_nothing_is_weighed() -> None:
    tracker = Tracker()
    tracker.update(view(2.1), 0, {0: Found("mug", seen(2.0, 0.0, 0))})
    tracker.update(view(2.1), 1, {0: Found("bowl", seen(2.0, 0.0, 1))})
    assert [(t.category, t.evidence, t.belief) for t in tracker.tracks] == [("mug", None, 1.0), ("bowl", None, 1.0)]


def test_of_one_mug_that_is_left_two_places_share_the_belief() -> None:
    """Each by itself 0.3 / 1.3 x 2 mugs: 0.6 / 1.6; with one of two in the bag, their sum may be one at most."""
    tracks = [Track("mug", seen(2.0, y, 0), evidence=Evidence(TABLE, Look("mug", 50), HERE)) for y in (0.0, 1.0, 2.0)]
    told = {"mug": 2, "bowl": 0, "book": 0}
    assert [(k, b) for _, k, b in believed(tracks, (), told)] == [("mug", pytest.approx(0.6 / 1.6))] * 3
    made = believed(tracks, tracks[:1], {**told, "mug": 1})
    assert [(t, b) for t, _, b in made] == [(t, 0.0) for t in tracks[1:]], "the only mug is in the bag"
    tracks[1].refuted = True
    assert [t for t, _, _ in believed(tracks, (), told)] == [tracks[0], tracks[2]]
    assert shared(["mug", "book"], [0.8, 0.9], {"mug": 1}) == [0.8, 0.9]


class Measured(Told):
    """A detector whose errors were measured."""

    confusion = TABLE


@pytest.fixture
def world() -> World:
    return World.of((SCENE,), [[(0.1, 0.1, 0.1)] * 4], [[1.0] * 4])


@pytest.fixture
def labeller(world: World) -> OwnLabeller:
    return OwnLabeller(world, ("cart_1",), Measured(), 0.5, fused=True)


def test_agents_are_told_the_belief_in_each_target(labeller: OwnLabeller) -> None:
    """25 pixels of one of two mugs, from one place: 0.5 x 2 x 0.6 against 1, and 0.2 books, told so by 0.4 x 1/2."""
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1))
    book = 0.5 * 0.2 * 0.4 * 0.5
    bowl = 0.5 * 0.2 * 0.4 * 2.5 / 3.0
    first, second = labeller.targets()
    assert first.belief == pytest.approx(0.6 / (0.6 + 1.0 + book + bowl)) and second.belief == 1.0


def test_a_thing_that_a_hand_refused_is_forgotten_and_its_name_is_free(labeller: OwnLabeller) -> None:
    for frame in range(2):
        seen_now = look(labeller, frame, ("mug", BOOK))
    assert at(seen_now, BOOK) == 0
    labeller.refused(0, other=False)
    assert labeller.thing(0) == BOOK, "the arm did not get there, but something is"
    labeller.refused(0, other=True)
    assert labeller.thing(0) == -1 and 0 in [*labeller._missed]
    for frame in range(2, 5):
        seen_now = look(labeller, frame, ("mug", BOOK), ("mug", MUG_2))
    assert at(seen_now, MUG_2) == 0 and at(seen_now, BOOK) != 0
    assert [t.belief < 1.0 for t in labeller.targets()] == [True, False]


def test_what_is_told_otherwise_from_nearer_gets_another_name(labeller: OwnLabeller) -> None:
    """A mug by 25 pixels at first: then a book by many, from two other places."""
    for frame in range(2):
        look(labeller, frame, ("mug", BOOK))
    (track,) = labeller._tracker.tracks
    assert track.index == 0 and track.evidence is not None
    for x in (1.0, 2.0):
        track.evidence.look(Look("book", 200), np.array([x, 0.0, 1.0]))
    seen_now = look(labeller, 2, ("mug", BOOK))
    assert track.category == "book" and labeller.names[at(seen_now, BOOK)] == "book#1"
    assert 0 in labeller.unmapped()


def test_a_hand_holds_what_it_went_to_whatever_a_look_on_the_way_made_of_it(labeller: OwnLabeller) -> None:
    """The mug becomes a book while the hand goes there; meanwhile its name is free, and another mug gets it."""
    for frame in range(2):
        look(labeller, frame, ("mug", BOOK))
    (track,) = labeller._tracker.tracks
    assert labeller.reach_for(0) == BOOK and track.evidence is not None
    for x in (1.0, 2.0):
        track.evidence.look(Look("book", 200), np.array([x, 0.0, 1.0]))
    for frame in (2, 3):
        look(labeller, frame, ("mug", BOOK), ("mug", MUG_2))
    assert track.index not in (-1, 0) and labeller.thing(0) == MUG_2
    labeller._world.held[0, BOOK] = True
    labeller.took(0)
    assert labeller.held == "mug#1" and track.index == 0
    seen_now = look(labeller, 4, ("mug", MUG_2))
    assert at(seen_now, MUG_2) not in (0, track.index)


def test_without_fusion_all_is_as_it_seems(world: World) -> None:
    plain = OwnLabeller(world, ("cart_1",), Measured(), 0.5)
    for frame in range(2):
        look(plain, frame, ("mug", MUG_1))
    assert [t.belief for t in plain.targets()] == [1.0, 1.0]
    plain.refused(0, other=True)
    assert plain.thing(0) == MUG_1
