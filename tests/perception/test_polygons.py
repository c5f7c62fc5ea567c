"""One polygon for a mask of several parts, with holes, filled again as readers of label files do."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.perception.exports import polygons


def overlap(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    return float((a & b).sum() / (a | b).sum())


def drawn(polygon: NDArray[np.int64], like: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """As Ultralytics' `polygon2mask` fills: whole numbers, with their border."""
    return cv2.fillPoly(np.zeros_like(like), [polygon.astype(np.int32)], 1).astype(bool)


def blob(seed: int, size: int = 160) -> NDArray[np.uint8]:
    """A random shape of several parts, with holes."""
    rng = np.random.default_rng(seed)
    noise = cv2.GaussianBlur(rng.standard_normal((size, size)), (0, 0), 12.0)
    return (noise > 0.6 * noise.std()).astype(np.uint8)


@pytest.mark.parametrize("seed", range(6))
def test_shapes_of_several_parts_with_holes_are_kept(seed: int) -> None:
    shape = blob(seed)
    shape[20:140, 20:140] |= 1
    shape[60:80, 50:90] = 0  # a hole
    shape[64:76, 60:70] = 1  # an island in it
    assert overlap(drawn(polygons.outline(shape), shape), shape.astype(bool)) > 0.98


def test_two_parts_are_joined_by_a_line_of_one_pixel() -> None:
    shape = np.zeros((40, 60), np.uint8)
    shape[5:25, 5:25] = shape[5:25, 30:50] = 1
    found = drawn(polygons.outline(shape), shape)
    assert (found & (shape == 0)).sum() == 5 and not ((shape == 1) & ~found).any()


def test_a_part_that_is_smaller_than_its_line_is_left_out() -> None:
    """Six pixels, at a distance of 20: with them, 19 wrong pixels would come."""
    shape = np.zeros((40, 60), np.uint8)
    shape[5:25, 5:25] = shape[5:8, 44:46] = 1
    found = drawn(polygons.outline(shape), shape)
    assert not found[:, 25:].any() and found[5:25, 5:25].all()
    shape[5:15, 44:54] = 1
    assert drawn(polygons.outline(shape), shape)[5:15, 44:54].all()


def test_a_hole_stays_open() -> None:
    shape = np.ones((40, 40), np.uint8)
    shape[10:30, 10:30] = 0
    found = drawn(polygons.outline(shape), shape)
    assert not found[10:30, 10:30].any() and found[shape == 1].all()


@pytest.mark.parametrize("count", [1, 2])
def test_a_thing_of_one_or_two_pixels_has_three_corners(count: int) -> None:
    shape = np.zeros((9, 9), np.uint8)
    shape[4, 4 : 4 + count] = 1
    found = polygons.outline(shape)
    assert len(found) >= 3 and np.array_equal(drawn(found, shape), shape.astype(bool))
    numbers = [float(n) for n in polygons.text(7, shape).split()]
    assert numbers[0] == 7 and numbers[1:3] == pytest.approx([4.25 / 9, 4.25 / 9])


def test_a_chequered_mask_ends_in_bounded_time() -> None:
    """Half a million holes of one pixel are filled; OpenCV alone would take minutes to trace them."""
    shape = (np.indices((1000, 1000)).sum(0) % 2).astype(np.uint8)
    assert len(polygons.outline(shape)) < 10_000
    many = np.zeros((1000, 1000), np.uint8)
    many[::2, ::2] = 1
    assert len(polygons.outline(many)) == polygons.LEAST_CORNERS
