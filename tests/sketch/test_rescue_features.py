"""Features of rescues in the sketch: worked out by hand, blind to what was not seen, and as in real episodes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sketch import skill_times
from hazard_ms.sketch.rescues.features import MISSING, SketchEncoder
from hazard_ms.sketch.scenes import scenes_of
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.environment import HazardSkills
from hazard_ms.skills.options.options import FIRST, LOOK
from tests.worlds.sketch_scenes import random_scene, scene, sure_times

FIRE = (20.0, 620.0)  # range of the level [C]
SPARE = 0.35  # difference of a walking time that ways over a map may make, in units of its scale, 500 frames


def encoded(sketch: Sketch) -> NDArray[np.float32]:
    return SketchEncoder([FIRE]).encode(sketch.stack, sketch.state, sketch.slots)


def named(vector: NDArray[np.float32], table: str, row: int) -> dict[str, float]:
    """The numbers of one row of the first rescue by the names of its columns."""
    layout = SketchEncoder([FIRE]).layout
    columns = [column.name for column in layout.tables[table][1]]
    return dict(zip(columns, layout.split(vector[0])[table][row].tolist(), strict=True))


def one(made: object) -> Sketch:
    sketch = Sketch([made], sure_times(), 1)  # type: ignore[list-item]
    sketch.reset([0], [0])
    return sketch


def test_a_target_that_was_seen_twice() -> None:
    """3 m ahead and 4 m to the left, seen while it warms from 80 to 200 C in 60 frames of looking around."""
    level = np.full((150, 1, 1), 80.0)
    level[6:] = 200.0
    made = scene([(0.0, 0.0), (3.0, 4.0)], [1], level=level, traits=[[0.0, 1.0, 450.0]])
    sketch = one(made)
    sketch.step(np.array([FIRST[LOOK]]))
    row = named(encoded(sketch), "targets", 0)
    metres = 5.0 - 0.5  # to where it can be reached; 62 frames each and 3 to settle
    assert row.pop("walk") == pytest.approx((62 * metres + 3) / 500, abs=0.04)  # from the middle of a cell
    want = {"known": 1.0, "ahead": 0.6, "left": 0.8, "value": 1.0, "waterproof": 1.0, "ignition": 1.5, "level_0": 0.3}
    want["rise_0"] = (200.0 - 80.0) / 600.0 * 100.0 / 60.0
    assert row == pytest.approx(dict.fromkeys(row, 0.0) | want, abs=1e-6)


def test_the_rescued_and_the_whole() -> None:
    sketch = one(scene([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)], [1, 2]))
    sketch.step(np.array([0]))
    assert named(encoded(sketch), "targets", 0)["rescued"] == 1.0
    whole, frame = named(encoded(sketch), "global", 0), int(sketch.state.frame[0])
    assert whole["open"] == pytest.approx(1 / 32) and whole["rescued"] == pytest.approx(1 / 32)
    assert whole["elapsed"] == pytest.approx(frame / 1500) and whole["remaining"] == pytest.approx(1 - frame / 1500)
    assert whole["holding"] == whole["carts"] == whole["unknown"] == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_what_was_not_seen_changes_nothing(seed: int) -> None:
    """Places, levels and fates of unseen targets are changed, all numbers stay."""
    sketch = one(random_scene(seed, carts=seed % 2))
    targets = sketch.state.value.shape[1]
    unseen = np.flatnonzero(~sketch.state.known[0, :targets])
    before = encoded(sketch)
    stack = sketch.stack
    sites = stack.target_site[0, 0, unseen]
    stack.position[0, sites] += 3.0
    stack.travel[0, :, sites] += 50.0
    stack.level[0, :, unseen] += 100.0
    stack.damaged_at[0, unseen] = 1
    stack.limit[0, unseen] = 30.0
    np.testing.assert_array_equal(encoded(sketch), before)
    seen = np.flatnonzero(sketch.state.known[0, :targets])
    if len(seen):
        stack.position[0, sketch.state.seen_site[0, seen]] += 0.5
        assert (encoded(sketch) != before).any()


def test_all_numbers_are_within_the_bounds_of_real_ones() -> None:
    scenes = [random_scene(seed, carts=1, moving=True) for seed in range(8)]
    sketch, encoder = Sketch(scenes, sure_times(), 8), SketchEncoder([FIRE])
    sketch.reset(np.arange(8), np.arange(8))
    space = encoder.layout.space()
    for _ in range(6):
        made = encoded(sketch)
        assert made.dtype == np.float32 and (made >= space.low).all() and (made <= space.high).all()
        sketch.step(sketch.mask.argmax(axis=1))


@pytest.mark.long
def test_the_first_decisions_are_as_in_real_episodes() -> None:
    """Known targets have the same numbers but for the walk, which is over other ground; MISSING columns are 0.

    Landmarks are others, but about as many, with about as much unexplored around them.
    """
    env = HazardSkills(task="HazardFire-v1", split="train")
    encoder, together = SketchEncoder(env.encoder.ranges), 0
    for name, seed in (("kitchen_a/00", 0), ("kitchen_a/01", 1)):
        real, _ = env.reset(seed=seed, options={"scene": name})
        sketch = Sketch(scenes_of("HazardFire-v1", [name], [seed]), skill_times.load("fetch"), 1)
        sketch.reset([0], [seed])
        for _ in range(2):
            ours = encoder.encode(sketch.stack, sketch.state, sketch.slots)[0]
            want, got = (encoder.layout.split(vector) for vector in (real, ours))
            names = [column.name for column in encoder.layout.tables["targets"][1]]
            apart = np.abs(want["targets"] - got["targets"])
            told = [names.index(n) for n in ("value", "flammable", "waterproof", "ignition", "held", "rescued")]
            assert apart[:, told].max() < 1e-6
            both = (want["targets"][:, 0] > 0) & (got["targets"][:, 0] > 0)
            together += int(both.sum())
            near = {"ahead": 0.05, "left": 0.05, "level_0": 0.1, "unseen": 0.03, "damaged": 0.0, "failures": 0.0}
            for column, most in near.items():
                assert apart[both, names.index(column)].max(initial=0.0) <= most, column
            assert not both.any() or np.median(apart[both, names.index("walk")]) < SPARE / 3
            assert apart[both, names.index("walk")].max(initial=0.0) < SPARE
            edge = [column.name for column in encoder.layout.tables["landmarks"][1]].index("edge")
            edges = [table["landmarks"][:, edge] for table in (want, got)]
            offered = [int((each > 0).sum()) for each in edges]
            assert abs(offered[0] - offered[1]) <= 3, offered
            assert not min(offered) or 0.5 < edges[0].max() / edges[1].max() < 2.0, edges
            whole = [column.name for column in encoder.layout.tables["global"][1]]
            for column in (c for c in whole if c.startswith(MISSING)):
                assert got["global"][0, whole.index(column)] == 0.0
            for column in ("elapsed", "remaining", "holding", "carts"):
                assert abs(want["global"] - got["global"])[0, whole.index(column)] < 0.02
            real, *_ = env.step(FIRST[LOOK])
            sketch.step(np.array([FIRST[LOOK]]))
    env.close()
    assert together >= 12, "hardly any target was known in both"
