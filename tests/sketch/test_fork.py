"""Copies of rescues: they go on as the original would, and the original knows nothing of them."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from hazard_ms.sketch.rescues.state import Domain
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import FIRST, LANDMARK
from tests.worlds.sketch_scenes import grid, random_scene, scene, sure_times


def test_a_copy_goes_on_as_the_original_and_leaves_it_alone() -> None:
    scenes = [random_scene(seed) for seed in range(4)]
    sketch = Sketch(scenes, sure_times(), 4)
    sketch.reset(np.arange(4), np.arange(4))
    sketch.step(sketch.mask.argmax(axis=1))
    rows = np.array([2, 0, 2])
    before = {f.name: getattr(sketch.state, f.name).copy() for f in fields(sketch.state)}
    copied = sketch.fork(rows, [5, 6, 5])
    assert (copied.mask == sketch.mask[rows]).all() and (copied.slots == sketch.slots[rows]).all()
    for _ in range(4):
        copied.step(copied.mask.argmax(axis=1))
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(sketch.state, name), value)
    for _ in range(4):
        sketch.step(sketch.mask.argmax(axis=1))  # nothing is left to chance
    for name in before:
        np.testing.assert_array_equal(getattr(copied.state, name), getattr(sketch.state, name)[rows])


@pytest.mark.parametrize(("again", "tries"), [(1.0, 1), (0.0, 4)])
def test_what_was_out_of_reach_stays_so_if_the_world_is_like_that(again: float, tries: int) -> None:
    """After one failure that was noted by hand, pick-ups that always work do so, or never."""
    sketch = Sketch([scene([(0.0, 0.0), (1.0, 0.0)], [1])], sure_times(), 1, Domain(again=(again, again)))
    sketch.reset([0], [0])
    sketch.state.failures[0, 0] = 1
    while sketch.state.failures[0, 0] < 4 and not sketch.state.over[0]:
        sketch.step(np.array([0]))
    assert (sketch.state.score[0] == 1.0) == (tries == 1)
    assert sketch.state.failures[0, 0] == tries


@pytest.mark.parametrize(("walked", "share"), [(False, 0.25), (True, 0.75)])
def test_after_a_failure_it_matters_whether_the_robot_has_moved(walked: bool, share: float) -> None:
    """It fails with a target, and tries it again at once, or after it has searched elsewhere."""
    count = 4000
    cells = grid(-4.0, 4.0, 4.0)
    spots = np.where(cells["stand"][:, :1] > 0, 0b11, 0b01).astype(np.uint16)  # there is more to see from the east
    world = scene([(-2.0, -2.0), (-1.0, -2.0), (2.0, -2.0)], [1], landmark_site=[2], cells=cells, spots=spots)
    sketch = Sketch([world], sure_times(), count, Domain(again=(0.25, 0.75)))
    sketch.reset(np.zeros(count, int), np.arange(count))
    sketch.state.ease[:] = 0.0
    sketch.step(np.zeros(count, int))
    sketch.state.ease[:] = 1.0
    if walked:
        sketch.step(np.full(count, FIRST[LANDMARK]))
        assert (sketch.state.place[:, 0] > 0.0).all()
    sketch.step(np.zeros(count, int))
    assert (sketch.state.rescued_at[:, 0] >= 0).mean() == pytest.approx(share, abs=0.035)  # 5 standard errors
