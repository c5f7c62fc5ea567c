"""Labels: what each option leads to, worked out by hand."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from hazard_ms.learning.labels import collect, worth
from hazard_ms.sketch.policies import greedy, nearest
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import END, FIRST, LOOK
from tests.worlds.sketch_scenes import BAG_FRAMES, PICK_FRAMES, random_scene, scene, sure_times

EACH = 62 * 1.5 + 3 + PICK_FRAMES + BAG_FRAMES  # frames of a rescue 2 m away


def test_the_worth_of_options_when_there_is_time_for_one_rescue() -> None:
    """Values 5 and 1, both 2 m away: fetching one leaves no time for the other."""
    made = scene([(0.0, 0.0), (2.0, 0.0), (1.2, 1.6)], [1, 2], value=[5.0, 1.0], max_frames=round(EACH) + 80)
    sketch = Sketch([made], sure_times(), 1)
    sketch.reset([0], [0])
    before = {f.name: getattr(sketch.state, f.name).copy() for f in fields(sketch.state)}
    mask, found = worth(sketch, np.array([0]), greedy, np.random.default_rng(0))
    assert found[0, [0, 1]] == pytest.approx([5 / 6, 1 / 6])
    assert found[0, FIRST[LOOK]] == pytest.approx(5 / 6)  # 60 frames later, and then the greedy one
    assert np.flatnonzero(mask[0]).tolist() == [0, 1, FIRST[LOOK]] and not mask[0, FIRST[END]]
    assert (found[~mask] == 0.0).all()
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(sketch.state, name), value)


def test_every_decision_of_every_rescue_is_labelled() -> None:
    scenes = [random_scene(seed) for seed in range(4)]
    sketch, encoder = Sketch(scenes, sure_times(), 8), SketchEncoder([(20.0, 600.0)])
    seeds = np.arange(8)
    sketch.reset(seeds % 4, seeds)
    first = encoder.encode(sketch.stack, sketch.state, sketch.slots)
    made = collect(sketch, encoder, nearest, greedy, 0.5, np.random.default_rng(0))
    assert sketch.state.over.all() and len(made.mask) > 16
    np.testing.assert_array_equal(made.features[:8], first)
    assert made.mask.any(axis=1).all() and made.worth.min() >= 0.0 and made.worth.max() <= 1.0
    both = made + made
    assert len(both.features) == len(both.mask) == len(both.worth) == 2 * len(made.mask)
