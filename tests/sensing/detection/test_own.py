"""Things as an agent finds them: names, what a hand meets, what it takes and lets go, and what is not told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sensing.camera import AGENT, NOTHING, STRUCTURE
from hazard_ms.sensing.detection.detector import Detection, Detector, box_of
from hazard_ms.sensing.detection.labeller import Labeller, PublishedLabeller
from hazard_ms.sensing.detection.own import UNSURE, OwnLabeller
from hazard_ms.sensing.view import View
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec
from tests.worlds.wall import view as wall

SCENE = SceneSpec(
    name="test/kinds",
    room=Room((8.0, 8.0)),
    fixtures=(Fixture("cart_1", "cart", "", (2.8, -1.5, 0.0)),),
    bodies=(
        Body("mug_1", "mug", "", (2.0, 0.0, 0.95)),
        Body("mug_2", "mug", "", (2.0, 1.0, 0.95)),
        Body("book_1", "book", "", (2.0, -1.0, 0.95)),
    ),
    target_categories=("mug",),
    fires=(),
    agent_start=AgentStart((0.0, 0.0)),
)
MUG_1, MUG_2, BOOK, CART = range(4)  # along B
# pixels of them for a camera at (0, 0, 1) that looks along +x, 50 pixels to a radian: rows, columns
SPOTS = {MUG_1: (50, 50), MUG_2: (50, 25), BOOK: (50, 75), CART: (60, 75)}


class Told(Detector):
    """Finds what it is told to find."""

    found: tuple[tuple[str, int], ...] = ()  # category, and index of the spot
    score = 1.0

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        made = []
        for category, index in self.found:
            mask = spot(index)
            made.append(Detection(category, self.score, box_of(mask), mask))
        return made


def spot(index: int) -> NDArray[np.bool_]:
    mask = np.zeros((100, 100), bool)
    row, column = SPOTS[index]
    mask[row - 2 : row + 3, column - 2 : column + 3] = True
    return mask


def scene(shown: tuple[int, ...] = (MUG_1, MUG_2, BOOK)) -> View:
    """A wall at 4 m with things 2 m before the camera."""
    made = wall(4.0)
    labels = np.full((100, 100), STRUCTURE, np.int64)
    for index in shown:
        labels[spot(index)], made.depth[spot(index)] = index, 2.0
    return replace(made, labels=labels)


@pytest.fixture
def world() -> World:
    return World.of((SCENE,), [[(0.1, 0.1, 0.1)] * 4], [[1.0] * 4])


@pytest.fixture
def labeller(world: World) -> OwnLabeller:
    return OwnLabeller(world, ("cart_1",), Told(), 0.5)


def look(labeller: OwnLabeller, frame: int, *found: tuple[str, int], shown: tuple[int, ...] = (0, 1, 2)) -> View:
    labeller._detector.found = found  # type: ignore[attr-defined]
    return labeller.view(np.zeros((100, 100, 3), np.uint8), scene(shown), frame)


def at(seen: View, index: int) -> int:
    assert seen.labels is not None
    return int(seen.labels[SPOTS[index]])


def test_the_agent_is_told_what_there_is_but_not_which_is_where(labeller: OwnLabeller) -> None:
    assert labeller.names == ("mug#1", "mug#2", "cart#1") and labeller.containers == ("cart#1",)
    assert [(t.index, t.name, t.category) for t in labeller.targets()] == [(0, "mug#1", "mug"), (1, "mug#2", "mug")]


def test_a_thing_is_believed_when_it_was_seen_in_two_frames(labeller: OwnLabeller) -> None:
    for frame, label in ((0, UNSURE), (0, UNSURE), (1, 0)):
        assert at(look(labeller, frame, ("mug", MUG_2)), MUG_2) == label
    assert UNSURE in labeller.unmapped()


def test_names_follow_the_order_in_which_things_are_found(labeller: OwnLabeller) -> None:
    """The third mug that is found, which is a book, is behind what was told, and a target like the others."""
    every = (("mug", MUG_2), ("mug", MUG_1), ("mug", BOOK))
    for frame in range(2):
        look(labeller, frame, every[0])
    for frame in range(2, 4):
        seen = look(labeller, frame, *every)
    assert [at(seen, thing) for thing in (MUG_2, MUG_1, BOOK)] == [0, 1, 3]
    assert labeller.names[3] == "mug#3" and [t.name for t in labeller.targets()] == ["mug#1", "mug#2", "mug#3"]
    assert labeller.loose[:4].tolist() == [True, True, False, True]
    with pytest.raises(ValueError, match="a thing must be one of .*mug#3, got 'mug_1'"):
        labeller.index("mug_1")


def test_detections_with_low_scores_and_of_unknown_kinds_do_not_count(labeller: OwnLabeller) -> None:
    labeller._detector.score = 0.49  # type: ignore[attr-defined]
    assert all(at(look(labeller, frame, ("mug", MUG_1)), MUG_1) == STRUCTURE for frame in range(3))
    labeller._detector.score = 0.5  # type: ignore[attr-defined]
    assert all(at(look(labeller, frame, ("unicorn", MUG_1)), MUG_1) == STRUCTURE for frame in range(3))


def test_a_thing_that_is_missed_for_once_does_not_become_a_wall(labeller: OwnLabeller) -> None:
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1))
    seen = look(labeller, 2)
    assert at(seen, MUG_1) == UNSURE and at(seen, MUG_2) == STRUCTURE


def test_the_robot_knows_itself_and_what_it_holds(labeller: OwnLabeller, world: World) -> None:
    world.held[0, MUG_1] = True
    true = scene()
    true.depth[0, 0], true.labels[99, 99] = 0.0, AGENT  # type: ignore[index]
    labeller._detector.found = (("mug", MUG_1),)  # type: ignore[attr-defined]
    labels = labeller.view(np.zeros((100, 100, 3), np.uint8), true, 0).labels
    assert labels is not None and labels[SPOTS[MUG_1]] == AGENT
    assert labels[99, 99] == AGENT and labels[0, 0] == NOTHING


def test_a_hand_meets_what_is_really_there(labeller: OwnLabeller, world: World) -> None:
    """Whatever it is taken for: a book that was taken for a mug is a book."""
    for frame in range(2):
        look(labeller, frame, ("mug", BOOK))
    assert labeller.thing(0) == BOOK
    seen = -1.02  # where the middle of its pixels is [m]
    world.position[0, BOOK, 1] = seen - 0.34
    assert labeller.thing(0) == BOOK
    world.position[0, BOOK, 1] = seen - 0.36
    assert labeller.thing(0) == -1 and labeller.thing(1) == -1


def test_carts_are_met_by_the_middle_of_their_floor(labeller: OwnLabeller, world: World) -> None:
    for frame in range(2):
        look(labeller, frame, ("cart", CART), shown=(CART,))
    assert labeller.thing(2) == CART  # seen at (2, -1.02), 0.93 m from its middle, and 1.07 m with its height
    world.position[0, CART, 0] = 2.9
    assert labeller.thing(2) == -1


def test_what_was_taken_is_rescued_if_it_ends_in_the_bag(labeller: OwnLabeller, world: World) -> None:
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1), ("mug", MUG_2))
    world.held[0, MUG_1] = True
    labeller.took(0)
    assert labeller.held == "mug#1" and 0 in labeller.unmapped()
    assert [(t.held, t.rescued) for t in labeller.targets()] == [(True, False), (False, False)]
    world.held[0, MUG_1], world.safe[0, MUG_1], world.away[0, MUG_1] = False, True, True
    assert labeller.held is None and 0 in labeller.unmapped()
    assert [(t.held, t.rescued) for t in labeller.targets()] == [(False, True), (False, False)]
    assert at(look(labeller, 2, ("mug", MUG_2), shown=(MUG_2,)), MUG_2) == 1


def test_what_was_put_into_a_cart_stays_rescued_even_if_it_is_not_found_there(
    labeller: OwnLabeller, world: World
) -> None:
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1))
    world.held[0, MUG_1] = True
    labeller.took(0)
    world.held[0, MUG_1], world.safe[0, MUG_1] = False, True
    for frame in range(2, 6):
        look(labeller, frame, ("mug", MUG_2), shown=(MUG_2,))
    assert [t.rescued for t in labeller.targets()] == [True, False] and 0 not in labeller.unmapped()


def test_what_was_let_go_elsewhere_is_where_the_hand_was(labeller: OwnLabeller, world: World) -> None:
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1))
    world.held[0, MUG_1] = True
    labeller.took(0)
    world.held[0, MUG_1] = False
    world.position[0, MUG_1, 1] = 1.0
    assert labeller.held is None and not labeller.targets()[0].rescued and 0 not in labeller.unmapped()
    assert at(look(labeller, 2, ("mug", MUG_2), shown=(MUG_2,)), MUG_2) == 0


def test_a_thing_that_is_gone_frees_its_name(labeller: OwnLabeller) -> None:
    for frame in range(2):
        look(labeller, frame, ("mug", MUG_1))
    for frame in (2, 3):
        look(labeller, frame, shown=())
    assert 0 in labeller.unmapped() and labeller.thing(0) == -1
    for frame in (4, 5):
        seen = look(labeller, frame, ("mug", MUG_2), shown=(MUG_2,))
    assert at(seen, MUG_2) == 0 and 0 not in labeller.unmapped()


def test_damage_is_told_by_the_truth_and_as_published_but_not_to_own_eyes(world: World) -> None:
    flags = np.array([True, False, True, False])
    told = [
        kind(world, (), *given).damaged(flags) for kind, given in ((Labeller, ()), (PublishedLabeller, (Told(), 0.5)))
    ]
    assert all(damaged is flags for damaged in told)
    assert OwnLabeller(world, (), Told(), 0.5).damaged(flags) is None


def test_as_published_indices_are_those_of_the_truth(world: World) -> None:
    labeller = PublishedLabeller(world, ("cart_1",), Told(), 0.5)
    labeller._detector.found = (("mug", MUG_2), ("mug", BOOK))  # type: ignore[attr-defined]
    seen = labeller.view(np.zeros((100, 100, 3), np.uint8), scene(), 0)
    assert [at(seen, thing) for thing in (MUG_1, MUG_2, BOOK)] == [STRUCTURE, MUG_2, STRUCTURE]
    assert labeller.names == world.names[0] and labeller.withheld


@pytest.mark.parametrize(
    ("mask", "told"), [(np.ones((4, 4), bool), r"bool \(4, 4\)"), (np.ones((100, 100), np.uint8), "uint8")]
)
def test_masks_of_another_kind_are_refused(
    labeller: OwnLabeller, monkeypatch: pytest.MonkeyPatch, mask: NDArray[np.generic], told: str
) -> None:
    """Numbers in place of bool would be read as rows of the picture."""
    wrong = Detection("mug", 1.0, (0.0, 0.0, 1.0, 1.0), mask)  # type: ignore[arg-type]
    monkeypatch.setattr(labeller._detector, "detect", lambda rgb, depth: [wrong])
    with pytest.raises(ValueError, match=rf"a mask must be bool \(100, 100\), got {told}"):
        look(labeller, 0)


def test_a_detector_may_write_on_what_it_is_shown(labeller: OwnLabeller, monkeypatch: pytest.MonkeyPatch) -> None:
    def scribble(rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        rgb[:], depth[:] = 255, 0.0
        return []

    monkeypatch.setattr(labeller._detector, "detect", scribble)
    rgb, true = np.zeros((100, 100, 3), np.uint8), scene()
    assert labeller.view(rgb, true, 0).depth.all() and not rgb.any()
