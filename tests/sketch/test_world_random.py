"""Random episodes of the sketch: their bounds, a slow copy of the rules, and rescues alone and among others."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.rescues.state import TRAINING, Domain
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import END, FIRST
from tests.worlds.sketch_scenes import chancy_times, random_scene
from tests.worlds.slow_sketch import SlowSketch

FAMILIES: dict[str, dict[str, Any]] = {
    "rooms": {},
    "carts": {"carts": 2},
    "carts and drift": {"carts": 1, "moving": True},
}


def choices(sketch: Sketch, chance: np.random.Generator) -> Iterator[np.ndarray]:
    """Options drawn among those that can be chosen, and now and then any, until all is over."""
    while not sketch.state.over.all():
        weight = chance.random(sketch.mask.shape) * np.where(sketch.mask, 1.0, 0.2)
        weight[:, FIRST[END]] *= 0.1
        yield weight.argmax(axis=1)


@pytest.mark.parametrize("missed", [0.0, 0.3])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_slow_copy_of_the_rules_agrees(family: str, missed: float) -> None:
    for number in range(20):
        made = random_scene(number, **FAMILIES[family])
        sketch = Sketch([made], chancy_times(), 1, Domain(missed=missed))
        sketch.reset([0], [number])
        slow = SlowSketch(made, chancy_times(), number, missed)
        for option in choices(sketch, np.random.default_rng(number)):
            assert set(sketch.mask[0].nonzero()[0].tolist()) == slow.options()
            sketch.step(option)
            slow.step(int(option[0]))
            assert int(sketch.state.frame[0]) == slow.frame
            assert float(sketch.state.score[0]) == pytest.approx(slow.value)
            rescued = {t: int(f) for t, f in enumerate(sketch.state.rescued_at[0]) if f >= 0}
            assert rescued == slow.rescued
        assert slow.over


@pytest.mark.parametrize("family", FAMILIES)
def test_random_episodes_keep_within_their_bounds(family: str) -> None:
    scenes = [random_scene(number, **FAMILIES[family]) for number in range(25)]
    sketch = Sketch(scenes, chancy_times(), 1000, TRAINING)
    sketch.reset(np.arange(1000) % 25, np.arange(1000))
    total, before = np.zeros(1000), sketch.state.rescued_at.copy()
    limit = sketch.stack.max_frames[sketch.state.scene]
    for option in choices(sketch, np.random.default_rng(5)):
        frame, over = sketch.state.frame.copy(), sketch.state.over.copy()
        reward, _ = sketch.step(option)
        total += reward
        after = sketch.state.rescued_at
        assert ((before < 0) | (after == before)).all()  # nothing is un-rescued
        assert (sketch.state.frame <= limit).all()
        assert ((sketch.state.frame > frame) | over | sketch.state.over).all()
        before = after.copy()
    worth = sketch.state.value * (before >= 0) * np.where(sketch.state.spoiled, 0.5, 1.0)
    value = worth.sum(1) / sketch.state.value.sum(1)
    assert np.abs(total - value).max() < 1e-6
    assert value.min() >= 0.0 and value.max() <= 1.0 and 0.05 < value.mean() < 0.95


@pytest.mark.parametrize("family", FAMILIES)
def test_a_rescue_goes_the_same_alone_as_among_others(family: str) -> None:
    scenes = [random_scene(number, **FAMILIES[family]) for number in range(8)]
    many = Sketch(scenes, chancy_times(), 64, TRAINING)
    many.reset(np.arange(64) % 8, np.arange(64))
    alone = [Sketch([scenes[row % 8]], chancy_times(), 1, TRAINING) for row in (3, 20, 63)]
    for sketch, row in zip(alone, (3, 20, 63), strict=True):
        sketch.reset([0], [row])
    for option in choices(many, np.random.default_rng(1)):
        many.step(option)
        for sketch, row in zip(alone, (3, 20, 63), strict=True):
            sketch.step(option[row : row + 1])
            assert sketch.state.frame[0] == many.state.frame[row]
            assert sketch.state.score[0] == many.state.score[row]
            assert (sketch.mask[0] == many.mask[row]).all()
    assert {sketch.state.over[0] for sketch in alone} == {True}
