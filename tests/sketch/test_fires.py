"""Fires that are put out in the sketch: what that averts, what it takes, and what is known of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.fires.fates import damaged_at
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import END, FIRE, FIRST, MEASURED_COUNT, TARGET, TOOL
from tests.sketch.test_world import walk
from tests.worlds.sketch_scenes import BAG_FRAMES, PICK_FRAMES, scene, sure_times

NEVER = -1


def home(**more: Any) -> SketchScene:
    """Two targets of 10 and 30, lost to one fire each; the fires 4 m ahead and behind, an extinguisher 1 m ahead.

    Sites: the start, the targets, where fires are fought from, the extinguisher.
    """
    places = [(0, 0), (3, 0), (3, 1), (4, 0), (-4, 0), (1, 0)]
    plain: dict[str, Any] = {
        "value": [10.0, 30.0],
        "damaged_at": [900, 1200],
        "fire_site": [3, 4],
        "fire_place": [(4.0, 0.0), (-4.0, 0.0)],
        "hit_at": [[900, NEVER], [NEVER, 1200]],
        "fire_level": np.full((150, 2, 2), 500.0, np.float16),
        "flames": np.full((150, 2), 2),
        "tool_site": [5],
        "tool_charge": [360.0],
        "max_frames": 1500,
    }
    made = scene(places, [1, 2], **{**plain, **more})
    seen = np.ones((len(made.stand), 2), bool)
    return scene(places, [1, 2], **{**plain, "fire_seen": seen, **more})


def begun(made: SketchScene, count: int = 64) -> Sketch:
    sketch = Sketch([made], sure_times(), count)
    sketch.reset(np.zeros(count, int), np.arange(count))
    return sketch


def do(sketch: Sketch, option: int) -> np.ndarray:
    return sketch.step(np.full(len(sketch.state.frame), option))[0]


def test_a_fire_that_is_put_out_averts_what_it_would_have_damaged() -> None:
    """Half of 10 and of 30 would be lost: the first fire is a quarter of that, unless the attempt failed."""
    sketch = begun(home())
    assert sketch.mask.shape[1] == MEASURED_COUNT
    gained = do(sketch, FIRST[FIRE])
    out = sketch.state.out_at[:, 0] >= 0
    assert 0.6 < out.mean() < 1.0  # 0.95 of the pick-ups and 0.9 of the attempts
    assert gained[out] == pytest.approx(0.25) and gained[~out] == pytest.approx(0.0)
    left = damaged_at(sketch.stack, sketch.state, np.arange(64))
    assert (left[out] == [NEVER, 1200]).all() and (left[~out] == [900, 1200]).all()
    assert not sketch.mask[out, FIRST[FIRE]].any()


def test_what_was_damaged_before_stays_damaged() -> None:
    sketch = begun(home(damaged_at=[50, 1200], hit_at=[[50, NEVER], [NEVER, 1200]]))
    assert do(sketch, FIRST[FIRE]) == pytest.approx(0.0)
    assert (damaged_at(sketch.stack, sketch.state, np.arange(64))[:, 0] == 50).all()


def test_a_rescue_averts_what_the_target_would_lose_and_nothing_if_it_is_damaged() -> None:
    sketch = begun(home())
    assert do(sketch, FIRST[TARGET] + 1) == pytest.approx(0.75)
    sketch = begun(home(damaged_at=[900, 10], hit_at=[[900, NEVER], [NEVER, 10]]))
    assert do(sketch, FIRST[TARGET] + 1) == pytest.approx(0.0)


def test_a_large_fire_takes_the_charge_and_goes_on() -> None:
    """A jet puts out a flame in 18 frames; 40 flames bear one every 10."""
    sketch = begun(home(flames=np.full((150, 2), 40)))
    assert do(sketch, FIRST[FIRE]) == pytest.approx(0.0)
    armed = sketch.state.armed == 0
    assert armed.any() and (sketch.state.tool_left[armed] == 0.0).all() and (sketch.state.out_at == NEVER).all()
    assert not sketch.mask[armed, FIRST[FIRE] : FIRST[TOOL] + 1].any()


def test_a_tool_is_put_down_for_a_target_and_lies_there() -> None:
    """85 frames to put it down; then the walk, the pick-up and the bag."""
    sketch = begun(home())
    do(sketch, FIRST[TOOL])
    rows = np.flatnonzero(sketch.state.armed == 0)
    assert 50 < len(rows) and not sketch.mask[rows, FIRST[TOOL]].any()
    before = sketch.state.frame.copy()
    do(sketch, FIRST[TARGET])
    spent = sketch.state.frame[rows] - before[rows]
    assert spent == pytest.approx(85 + walk(2.5) + PICK_FRAMES + BAG_FRAMES, abs=2)
    assert (sketch.state.armed[rows] == -1).all() and (sketch.state.tool_site[rows, 0] == 5).all()
    assert sketch.mask[rows, FIRST[TOOL]].all()


def test_measures_are_offered_once_both_were_seen() -> None:
    made = home(fire_seen=np.zeros((len(home().stand), 2), bool))
    sketch = begun(made)
    assert sketch.mask[:, FIRST[TOOL]].all() and not sketch.mask[:, FIRST[FIRE] : FIRST[TOOL]].any()
    hidden = np.full((len(made.stand), 6), 99.0)
    hidden[:, 5] = 0.0
    assert not begun(home(pixels=hidden)).mask[:, FIRST[END] + 1 :].any()


def test_a_fire_behind_is_not_seen_before_a_look_around() -> None:
    sketch = begun(home())
    assert sketch.mask[0, FIRST[FIRE]] and not sketch.mask[0, FIRST[FIRE] + 1]


def test_features_of_the_fire_and_the_tool() -> None:
    """As the simulator tells them: 4 m ahead, two flames, the targets within 3 m worth 10 + 30 of 40."""
    sketch = begun(home())
    encoder = SketchEncoder([(20.0, 600.0)], measures=True)
    parts = encoder.layout.split(encoder.encode(sketch.stack, sketch.state, sketch.slots, sketch.tool))
    fire, tool = parts["fires"][0, 0], parts["tools"][0, 0]
    assert (
        fire[:3] == pytest.approx([1.0, 0.8, 0.0]) and fire[4] == pytest.approx(0.2) and fire[6] == pytest.approx(1.0)
    )
    assert parts["fires"][0, 1:].sum() == 0.0
    assert tool == pytest.approx([1.0, 0.0, 0.2, 0.0, (walk(1.0)) / 500, 360 / 500, 0.0], abs=1e-2)
