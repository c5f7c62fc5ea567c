"""Random rescues by teams: their bounds, one robot as ever, and rescues alone and among others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np
import pytest

from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.rescues.state import AS_MEASURED, TRAINING, Domain
from hazard_ms.sketch.teams.world import TeamSketch
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.options import END, FIRST
from tests.sketch.test_world_random import FAMILIES
from tests.worlds.sketch_scenes import chancy_times, random_scene


def scenes(family: str) -> list[SketchScene]:
    """Small scenes, the way to whose start is open."""
    made = [random_scene(number, **FAMILIES[family]) for number in range(10)]
    return [replace(one, travel=np.where(np.arange(one.travel.shape[1]) > 0, one.travel, 9.0)) for one in made]


def choices(sketch: TeamSketch, chance: np.random.Generator) -> Iterator[np.ndarray]:
    """Options drawn among those that can be chosen, and now and then any, until all is over."""
    while not sketch.over.all():
        mask = sketch.mask[sketch.rows]
        weight = chance.random(mask.shape) * np.where(mask, 1.0, 0.2)
        weight[:, FIRST[END]] *= 0.1
        yield weight.argmax(axis=1)


@pytest.mark.parametrize("domain", [AS_MEASURED, TRAINING], ids=["measured", "training"])
@pytest.mark.parametrize("family", FAMILIES)
def test_one_robot_alone_is_the_sketch_of_one_robot(family: str, domain: Domain) -> None:
    count = 100
    one = Sketch(scenes(family), chancy_times(), count, domain)
    team = TeamSketch(scenes(family), chancy_times(), count, 1, domain)
    for sketch in (one, team):
        sketch.reset(np.arange(count) % 10, np.arange(count))
    for option in choices(team, np.random.default_rng(2)):
        for mine, own in zip(one.step(option), team.step(option), strict=True):
            assert (mine == own).all()
        for each in fields(one.state):
            assert np.array_equal(getattr(one.state, each.name), getattr(team.state, each.name)), each.name
        assert (one.mask == team.mask).all() and (one.slots == team.slots).all()
    assert one.state.over.all() and team.score.max() > 0.3


@pytest.mark.parametrize("robots", [2, 4])
@pytest.mark.parametrize("family", FAMILIES)
def test_random_episodes_keep_within_their_bounds(family: str, robots: int) -> None:
    count = 200
    sketch = TeamSketch(scenes(family), chancy_times(), count, robots, TRAINING)
    sketch.reset(np.arange(count) % 10, np.arange(count))
    state, total, before = sketch.state, np.zeros(count), sketch.saved_at.copy()
    limit = sketch.stack.max_frames[state.scene]
    targets = np.arange(before.shape[1])
    clock = np.zeros(count, np.int64)
    for option in choices(sketch, np.random.default_rng(5)):
        was_over = sketch.over.copy()
        asked = state.frame[sketch.rows]
        assert (asked >= clock)[~was_over].all()  # whoever is asked is not ahead of who was asked before
        clock = np.where(was_over, clock, asked)
        gained, over = sketch.step(option)
        total += gained
        after = sketch.saved_at
        assert ((before < 0) | (after == before)).all()  # nothing is un-rescued, or rescued twice
        assert (gained[was_over] == 0.0).all() and (over | ~was_over).all()
        held = (state.held[:, None] == targets).reshape(count, robots, -1).sum(axis=1)
        assert held.max(initial=0) <= 1 and not (held.astype(bool) & (after >= 0)).any()
        assert (state.frame <= limit).all()
        before = after.copy()
    worth = state.value[::robots] * (before >= 0) * np.where(state.spoiled[::robots], 0.5, 1.0)
    value = worth.sum(1) / state.value[::robots].sum(1)
    assert np.abs(total - value).max() < 1e-6 and np.abs(sketch.score - value).max() < 1e-6
    assert 0.0 <= value.min() and value.max() <= 1.0 and 0.05 < value.mean() < 0.95


@pytest.mark.parametrize("family", FAMILIES)
def test_a_rescue_goes_the_same_alone_as_among_others(family: str) -> None:
    some = scenes(family)
    many = TeamSketch(some, chancy_times(), 40, 3, TRAINING)
    many.reset(np.arange(40) % 10, np.arange(40))
    alone = [TeamSketch([some[row % 10]], chancy_times(), 1, 3, TRAINING) for row in (3, 20, 39)]
    for sketch, row in zip(alone, (3, 20, 39), strict=True):
        sketch.reset([0], [row])
    for option in choices(many, np.random.default_rng(1)):
        many.step(option)
        for sketch, row in zip(alone, (3, 20, 39), strict=True):
            sketch.step(option[row : row + 1])
            assert sketch.state.frame.tolist() == many.state.frame[3 * row : 3 * row + 3].tolist()
            assert sketch.score[0] == many.score[row] and sketch.turn[0] == many.turn[row]
            assert (sketch.mask == many.mask[3 * row : 3 * row + 3]).all()
    assert {bool(sketch.over[0]) for sketch in alone} == {True}


def test_a_rescue_that_begins_anew_among_others_is_as_new() -> None:
    some = scenes("carts and drift")
    many, fresh = (TeamSketch(some, chancy_times(), 4, 2, TRAINING) for _ in range(2))
    many.reset([0, 1, 2, 3], [0, 1, 2, 3])
    for _ in range(6):
        many.step(many.mask[many.rows].argmax(axis=1))
    others = many.state.copies(np.array([0, 1, 4, 5, 6, 7]))
    many.reset([5], [9], [1])
    fresh.reset([0, 5, 0, 0], [0, 9, 0, 0])
    for each in fields(others):
        assert np.array_equal(getattr(many.state, each.name)[[0, 1, 4, 5, 6, 7]], getattr(others, each.name)), each.name
    for option in choices(fresh, np.random.default_rng(3)):
        fresh.step(option)
        many.step(option)
        assert fresh.state.frame[2:4].tolist() == many.state.frame[2:4].tolist()
        assert fresh.score[1] == many.score[1]
