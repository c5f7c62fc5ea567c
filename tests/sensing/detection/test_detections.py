"""Boxes, faults of the noisy detector, and the index that a detection takes from the truth."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sensing.camera import AGENT, NOTHING, STRUCTURE
from hazard_ms.sensing.detection.detector import Box, Detection, Truth, box_of, overlap
from hazard_ms.sensing.detection.labeller import blank, boxes_of, nearest
from hazard_ms.sensing.detection.noisy import Noisy

ROOT = Path(__file__).parents[3]
SIDE, EDGE = 60, 6  # of a picture and of the squares in it [pixels]
KINDS = ("mug", "bowl", "apple", "table")  # of the squares, over and over
EMPTY = np.zeros((SIDE, SIDE), np.float32)


def squares() -> NDArray[np.int64]:
    """100 squares of 5 x 5 pixels, with one pixel of wall to the right of and below each."""
    rows, columns = np.mgrid[0:SIDE, 0:SIDE]
    inside = (rows % EDGE < EDGE - 1) & (columns % EDGE < EDGE - 1)
    return np.where(inside, rows // EDGE * (SIDE // EDGE) + columns // EDGE, STRUCTURE).astype(np.int64)


def found(frame: int = 0, seed: int = 3, **faults: float) -> list[Detection]:
    detector = Noisy(**faults)  # type: ignore[arg-type]
    labels = squares()
    detector.truth = Truth(labels, tuple(KINDS[i % 4] for i in range(100)), seed, frame)
    return detector.detect(np.zeros((SIDE, SIDE, 3), np.uint8), EMPTY)


def told(detections: list[Detection]) -> list[tuple[str, Box]]:
    return [(d.category, d.box) for d in detections]


@pytest.mark.parametrize(
    ("one", "other", "share"),
    [
        ((0, 0, 4, 4), (0, 0, 4, 4), 1.0),
        ((0, 0, 4, 4), (2, 0, 6, 4), 8 / 24),  # half of each
        ((0, 0, 4, 4), (1, 1, 3, 3), 4 / 16),  # one in the other
        ((0, 0, 4, 4), (4, 0, 8, 4), 0.0),  # they touch
        ((0, 0, 1, 1), (5, 5, 9, 9), 0.0),
    ],
)
def test_overlap_of_boxes(one: Box, other: Box, share: float) -> None:
    assert overlap(one, other) == pytest.approx(share) and overlap(other, one) == pytest.approx(share)


def test_boxes_hold_all_pixels_and_no_more() -> None:
    labels = np.full((8, 9), STRUCTURE, np.int64)
    labels[2:5, 3:9], labels[7, 0] = 4, 1
    labels[0, 0] = AGENT
    assert boxes_of(labels) == {4: (3, 2, 9, 5), 1: (0, 7, 1, 8)}
    assert box_of(labels == 4) == (3, 2, 9, 5)


def test_a_detection_takes_the_thing_of_its_category_that_it_overlaps_most() -> None:
    boxes: dict[int, Box] = {0: (0, 0, 10, 10), 1: (8, 0, 18, 10), 2: (9, 0, 19, 10)}
    kinds = ("mug", "mug", "bowl")
    mask = np.ones((4, 4), bool)

    def index(category: str, *box: float) -> int:
        left, top, right, bottom = box
        return nearest(Detection(category, 1.0, (left, top, right, bottom), mask), boxes, kinds)

    assert index("mug", 6, 0, 16, 10) == 1  # 8 of 12 columns with 1, 4 of 16 with 0
    assert index("mug", 1, 0, 11, 10) == 0
    assert index("bowl", 0, 0, 10, 10) == 2  # one column is enough
    assert index("bowl", 0, 0, 9, 10) == -1
    assert index("apple", 0, 0, 10, 10) == -1


def test_without_faults_everything_is_found_as_it_is() -> None:
    labels = squares()
    made = found()
    assert [d.category for d in made] == [KINDS[i % 4] for i in range(100)]
    assert all((d.mask == (labels == i)).all() and d.score == 1.0 for i, d in enumerate(made))


def test_so_many_are_missed_as_stated() -> None:
    """Four standard deviations of the binomial distribution of 30 x 100 draws."""
    missed = sum(100 - len(found(frame, miss=0.3)) for frame in range(30))
    assert abs(missed - 900) < 4 * (3000 * 0.3 * 0.7) ** 0.5
    assert found(miss=1.0) == []


def test_so_many_are_confused_as_stated_and_with_their_own_kind() -> None:
    made = [d for frame in range(10) for d in found(frame, confuse=0.4)]
    names = [d.category for d in made]
    wrong = [name for i, name in enumerate(names) if name != KINDS[i % 4]]
    assert abs(len(wrong) - 300) < 4 * (750 * 0.4 * 0.6) ** 0.5  # of 750 things, there is no furniture but tables
    assert set(wrong) == {"mug", "bowl", "apple"}


def test_masks_shrink_on_all_sides_but_not_at_the_border_of_the_picture() -> None:
    made = {d.box: int(d.mask.sum()) for d in found(erode=1)}
    assert made[(7, 7, 10, 10)] == 9 and made[(0, 0, 4, 4)] == 16  # of 5 x 5 pixels each
    assert found(erode=3, miss=0.0) and len(found(erode=3)) < 100  # only those at the border are left


def test_faults_are_those_of_the_seed_and_the_frame_and_last_as_long_as_stated() -> None:
    assert told(found(7, miss=0.5)) == told(found(7, miss=0.5))
    assert told(found(7, miss=0.5)) != told(found(8, miss=0.5))
    assert told(found(7, miss=0.5)) != told(found(7, seed=4, miss=0.5))
    held = [told(found(frame, miss=0.5, hold=10)) for frame in (20, 29, 30)]
    assert held[0] == held[1] != held[2]


def test_faults_are_the_same_in_another_process() -> None:
    code = (
        "import json; from tests.sensing.detection.test_detections import found, told; "
        "print(json.dumps(told(found(5, miss=0.4, confuse=0.3))))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert [(name, tuple(box)) for name, box in json.loads(out)] == told(found(5, miss=0.4, confuse=0.3))


@pytest.mark.parametrize(
    "faults", [{"miss": 1.1}, {"miss": float("nan")}, {"confuse": -0.1}, {"erode": -1}, {"hold": 0}]
)
def test_faults_that_cannot_be_are_refused(faults: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(faults))} must be"):
        Noisy(**faults)  # type: ignore[arg-type]


def test_pixels_without_a_detection_are_the_robot_a_wall_or_nothing() -> None:
    own = np.array([[True, False, False]])
    depth = np.array([[0.0, 0.0, 2.0]], np.float32)
    assert blank(own, depth).tolist() == [[AGENT, NOTHING, STRUCTURE]]
