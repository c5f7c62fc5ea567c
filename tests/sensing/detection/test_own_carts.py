"""Which of the carts that an agent believes to have found count, and what a drop that finds none changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.detection.beliefs import crowded
from hazard_ms.sensing.detection.confusion import Confusion, Look
from hazard_ms.sensing.detection.detector import Detection, Detector, box_of
from hazard_ms.sensing.detection.fusion import Evidence
from hazard_ms.sensing.detection.own import OwnLabeller
from hazard_ms.sensing.detection.track import Track
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.view import View
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec
from tests.sensing.detection.test_confusion import TABLE
from tests.worlds.wall import view as wall

SCENE = SceneSpec(
    name="test/carts",
    room=Room((8.0, 8.0)),
    fixtures=(Fixture("cart_1", "cart", "", (2.0, 0.5, 0.0)), Fixture("cart_2", "cart", "", (2.0, -1.0, 0.0))),
    bodies=(Body("mug_1", "mug", "", (2.0, 0.0, 0.95)),),
    target_categories=("mug",),
    fires=(),
    agent_start=AgentStart((0.0, 0.0)),
)
CARTS = ("cart_1", "cart_2")
MUG, CART_1, CART_2 = range(3)  # along B
COLUMNS = (10, 25, 50, 75)  # of the pictures, 2 m before a camera at (0, 0, 1) that looks along +x, left to right


class Scored(Detector):
    """Finds a cart at each of COLUMNS that it is given a score for."""

    scores: dict[int, float]

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        masks = {column: spot(column) for column in self.scores}
        return [Detection("cart", self.scores[column], box_of(mask), mask) for column, mask in masks.items()]


def spot(column: int) -> NDArray[np.bool_]:
    mask = np.zeros((100, 100), bool)
    mask[58:63, column - 2 : column + 3] = True
    return mask


def scene() -> View:
    made = wall(4.0)
    for column in COLUMNS:
        made.depth[spot(column)] = 2.0
    return replace(made, labels=np.full((100, 100), STRUCTURE, np.int64))


@pytest.fixture
def labeller() -> OwnLabeller:
    world = World.of((SCENE,), [[(0.1, 0.1, 0.1)] * 3], [[1.0] * 3])
    return OwnLabeller(world, CARTS, Scored(), 0.5)


def look(labeller: OwnLabeller, frame: int, scores: dict[int, float], seen: View | None = None) -> View:
    labeller._detector.scores = scores  # type: ignore[attr-defined]
    return labeller.view(np.zeros((100, 100, 3), np.uint8), seen or scene(), frame)


def test_the_surest_count_whichever_was_found_first(labeller: OwnLabeller) -> None:
    assert labeller.containers == ("cart#1", "cart#2")
    for frame in range(2):
        look(labeller, frame, {10: 0.6, 50: 0.7})
    assert labeller.containers == ("cart#1", "cart#2")
    for frame in range(2, 4):
        look(labeller, frame, {10: 0.6, 50: 0.7, 25: 0.8})
    assert labeller.names[3] == "cart#3" and labeller.containers == ("cart#2", "cart#3")
    look(labeller, 4, {10: 0.9, 50: 0.5})  # sure once is sure
    assert labeller.containers == ("cart#1", "cart#3")


def test_a_cart_that_was_not_there_is_forgotten_and_never_believed_again(labeller: OwnLabeller) -> None:
    for frame in range(2):  # of one picture, the least sure is entered first
        look(labeller, frame, {10: 0.9, 50: 0.7, 75: 0.6})
    false, true = labeller.index("cart#3"), labeller.index("cart#2")
    assert labeller.containers == ("cart#2", "cart#3") and labeller.thing(false) == -1
    labeller.missed(false)
    assert labeller.containers == ("cart#1", "cart#2")
    seen = look(labeller, 2, {10: 0.9, 50: 0.7})
    assert false in labeller.unmapped() and labeller.containers == ("cart#1", "cart#2")
    assert seen.labels is not None
    assert seen.labels[60, 10] == STRUCTURE and seen.labels[60, 50] == true
    for frame in (3, 4):  # its name is that of the next one
        seen = look(labeller, frame, {10: 0.9, 50: 0.7, 25: 0.95})
    assert seen.labels is not None
    assert seen.labels[60, 25] == false and labeller.containers == ("cart#2", "cart#3")
    look(labeller, 5, {})
    assert false not in labeller.unmapped()


def test_a_mask_that_is_wider_than_a_cart_shows_more_than_the_cart(labeller: OwnLabeller) -> None:
    """Else a walk would end at the edge of whatever the mask shows, too far for a drop."""
    assert labeller.half_width(labeller.index("cart#1")) == pytest.approx(np.hypot(0.56, 0.94) / 2, abs=0.01)
    assert labeller.half_width(labeller.index("mug#1")) < 0.55


def test_there_are_as_many_names_as_carts_even_if_none_is_believed(labeller: OwnLabeller) -> None:
    """Without any, the hand would let go into the bag."""
    for frame in range(2):
        look(labeller, frame, {10: 0.9, 50: 0.7})
    for name in labeller.containers:
        labeller.missed(labeller.index(name))
    assert labeller.containers == ("cart#1", "cart#2")


def test_nothing_is_brought_to_what_is_hardly_believed_to_be_a_cart(labeller: OwnLabeller) -> None:
    """An agent that is told of every chance of a cart carries things past true ones to fences."""
    look(labeller, 0, {10: 0.9})
    (track,) = labeller._tracker.tracks
    told = []
    for category, belief in (("cart", 0.3), ("cart", 0.5), ("mug", 0.3)):
        made = Track(category, track.sighting, frames=9, belief=belief)
        labeller._introduce(made)
        told.append(made.index >= 0)
    assert told == [False, True, True]


def test_one_look_that_tells_a_cart_for_sure_is_enough(labeller: OwnLabeller) -> None:
    """Beliefs count looks already; of what can be carried two are needed, and without beliefs, of carts, too."""
    look(labeller, 0, {10: 0.9})
    (track,) = labeller._tracker.tracks
    evidence, told = Evidence(TABLE, Look("mug", 50), np.zeros(3)), []
    for category, known in (("cart", None), ("cart", evidence), ("mug", evidence)):
        made = Track(category, track.sighting, frames=1, belief=0.9, evidence=known)
        labeller._introduce(made)
        told.append(made.index >= 0)
    assert told == [False, True, False]


def test_a_cart_lies_where_it_stands_and_not_behind_its_wire(labeller: OwnLabeller) -> None:
    """Three of its five columns show the wall 4 m away; the other two, 2 m away, are left of the middle."""
    through = scene()
    through.depth[58:63, 48:51] = 4.0
    seen = look(labeller, 0, {50: 0.9}, through)
    (track,) = labeller._tracker.tracks
    assert track.sighting.position.tolist() == pytest.approx([2.0, -0.06, 0.56], abs=0.021)
    assert seen.labels is not None and seen.labels[60, 49] == STRUCTURE


class Knowing(Scored):
    """The same, whose errors are known: what is shown of a cart counts by its width alone."""

    confusion = Confusion(
        ("cart", "mug"), (0,), (0.5,), (0.6,), {}, {"cart": 1.0}, 0.25, 0.8, 0.5,
        sharpness=1.0, surer=(0.0,), real=(1.0,), false=(1.0,), odds_of={"cart": (3.0, 0.0, 0.0, 0.0, 0.0, 1.0)},
    )  # fmt: skip

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        return [replace(each, chances=(0.9, 0.0)) for each in super().detect(rgb, depth)]


def test_what_a_look_shows_of_a_cart_reaches_the_belief_in_it(labeller: OwnLabeller) -> None:
    """Flat as it is, the logarithm of its odds is 3 + log2(0.01); two carts, half of which are found, and one clutter.

    All that cart and mug have together, 0.6 and 0.4, is the cart's, since the detector gives the mug no chance.
    """
    knowing = OwnLabeller(labeller._world, CARTS, Knowing(), 0.5, fused=True)
    look(knowing, 0, {50: 0.9})
    (track,) = knowing._tracker.tracks
    cart = 0.5 * 2 * np.exp(3.0 + np.log2(0.01))
    assert track.belief == pytest.approx(cart / (cart + 1.0), rel=1e-3)


def seen(y: float) -> Sighting:
    return Sighting(np.array([2.0, y, 1.0], np.float32), 0.05, 1.0, 0, 50)


def test_a_cart_beside_others_is_rather_a_fence() -> None:
    """Each other one 0.7 to 1.5 m away, three at most, takes the odds, 0.8 : 0.2, times 0.3; mugs may stand so."""
    along = np.cumsum([0.0, 0.6, 0.8, 1.6, 4.0])  # nearer than a cart is long: the same one twice
    tracks = [Track("cart", seen(y)) for y in along]
    odds = np.array(crowded(tracks, ["cart"] * 5, [0.8] * 5))
    assert (odds / (1.0 - odds) / 4.0).tolist() == pytest.approx([0.3, 0.3, 0.09, 1.0, 1.0])
    close = [Track("cart", seen(0.71 * k)) for k in range(5)]
    assert crowded(close, ["cart"] * 5, [0.5] * 5)[2] == pytest.approx(0.027 / 1.027), "of four others three count"
    assert crowded(close, ["mug"] * 5, [0.5] * 5) == [0.5] * 5


def test_what_lies_in_a_cart_is_none_to_fetch(labeller: OwnLabeller) -> None:
    """Its basket begins 0.45 m above the ground, within 0.45 m of the middle of the cart."""
    for frame in range(2):
        look(labeller, frame, {50: 0.9})
    (cart,) = labeller._tracker.tracks
    x, y, _ = cart.sighting.position.tolist()
    for beside, height, told in ((0.0, 0.5, False), (0.44, 0.5, False), (0.46, 0.5, True), (0.0, 0.3, True)):
        for known in (False, True):
            place = np.array([x, y + beside, height], np.float32)
            track = Track("mug", replace(cart.sighting, position=place), frames=9, belief=0.9)
            if known:
                labeller._introduce(track)
            labeller._pass_over([track])
            labeller._introduce(track)
            assert (track.index >= 0) is told and track.refuted is not told, (beside, height)
            labeller._drop(track)


def test_what_the_agent_itself_put_there_stays_known_as_rescued(labeller: OwnLabeller) -> None:
    knowing = OwnLabeller(labeller._world, CARTS, Knowing(), 0.5, fused=True)
    place = np.array([2.0, 0.5, 0.6], np.float32)
    cart = Track("cart", replace(seen(0.5), position=place), frames=9, belief=0.9)
    track = Track("mug", replace(seen(0.5), position=place), frames=9, belief=0.9)
    for each in (cart, track):
        knowing._introduce(each)
    track.rescued = True
    knowing._pass_over([track])
    knowing.refused(track.index, True)
    assert [row.rescued for row in knowing.targets()] == [True]
