"""The search for scenes that tell agents apart: its hazards are the tasks' own, and its agents do as they say."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from hazard_ms.scenes.splits import scene
from hazard_ms.scenes.walls import WALLS
from hazard_ms.simulation import building
from hazard_ms.spec import SceneSpec
from hazard_ms.tasks import task_of
from hazard_ms.tasks.episode.episode import Episode
from results.scene_futures import AT, FIRE, FLOOD, Change, losses
from results.scene_plays import LIMIT, Play, changes, joined, nearest_first, play

FRAMES = 1500  # far enough for some losses and for changes at AT


@pytest.fixture(scope="module")
def home() -> SceneSpec:
    return scene("house_test_1/03")


def lost_in_the_task(spec: SceneSpec, frames: int) -> list[float]:
    """The frames at which targets are damaged in the task's own hazards, one environment, nobody acting."""
    task = task_of(FIRE, "paper")
    world = building.make_world((spec,), torch.device("cpu"))
    episode, rows = Episode(world, task.hazards, task.safe_place), torch.arange(1)
    episode.begin(rows, torch.zeros(1).long())
    episode.begin_hazards(rows)
    for _ in range(frames):
        episode.advance(1.0 / 30.0)
    at = [int(episode.damage.frame[0, world.names[0].index(t.name)]) for t in spec.targets]
    return [frame if frame >= 0 else np.inf for frame in at]


def test_fires_of_the_search_are_those_of_the_task(home: SceneSpec) -> None:
    """Its short cut, ways of heat that are worked out once, changes nothing; nor does a batch of other rows."""
    every = tuple(range(len(home.fires)))
    alone, out = losses(FIRE, [(home, Change()), (home, Change(fires=every))], frames=FRAMES)
    assert alone.tolist() == lost_in_the_task(home, FRAMES)
    assert (alone <= FRAMES).sum() >= 2
    assert out[alone <= AT].tolist() == alone[alone <= AT].tolist()
    assert np.isinf(out).sum() > np.isinf(alone).sum()


def test_a_room_whose_doors_are_shut_stays_dry(home: SceneSpec) -> None:
    inner = tuple(k for k, o in enumerate(home.room.openings) if o.kind == "door" and o.wall not in WALLS)
    alone, shut = losses(FLOOD, [(home, Change()), (home, Change(doors=inner))])
    assert np.isfinite(alone).sum() > np.isfinite(shut).sum()
    assert (shut >= alone).all()


def test_measures_are_fires_and_groups_of_rooms(home: SceneSpec) -> None:
    """A group is all rooms that doorways join: with its doors to the hall shut, nothing gets in from there."""
    burning = len(home.fires)
    offered = [c.fires for c in changes(FIRE, home)]
    assert len(set(offered)) == len(offered) == burning + burning * (burning - 1) / 2
    assert max(map(len, offered)) == 2
    assert sorted(room for group in joined(home) for room in group) == sorted(
        a.name for a in home.room.areas if a.name != "hall"
    )
    doors = [k for k, o in enumerate(home.room.openings) if o.kind == "door" and o.wall not in WALLS and o.share > 0]
    offered = [c.doors for c in changes(FLOOD, home)]
    assert set(doors) == {door for group in offered for door in group} and (doors[0],) in offered
    assert max(map(len, offered)) > 1, "in every home two rooms are joined"


def test_nearest_first_takes_the_highest_value_over_way() -> None:
    """Three targets on a line; 0 is dear and far, 1 cheap and near, 2 behind 0; by hand."""
    at = np.array([200.0, 20.0, 300.0, 0.0])  # the start is last
    table = np.abs(at[:, None] - at)
    values = np.array([20.0, 1.0, 10.0])
    # 20 / 201 > 1 / 21 > 10 / 301: 0 by frame 200 + 90; then 2, 100 away, by 480; then 1, 280 away, by 850
    saved = nearest_first(table, values, np.array([291.0, 850.0, 481.0]), 90.0)
    assert saved.tolist() == [True, False, True]
    assert nearest_first(table, values, np.array([np.inf, 851.0, 480.0]), 90.0).tolist() == [True, True, False]
    assert not nearest_first(table, values, np.full(3, np.inf), LIMIT).any()


def test_the_best_plan_is_at_least_the_plain_one_and_counts_only_what_would_be_lost(home: SceneSpec) -> None:
    """Where all is lost late but one fire's targets at once, measures gain what is known beforehand."""
    never = np.full(len(home.targets), np.inf)
    assert play(FIRE, home, never, [], False).risk == 0.0
    soon = never.copy()
    soon[:8] = 600.0  # nobody brings eight targets away by then
    out = (Change(fires=(0,)), never)
    plain, best = (play(FIRE, home, soon, made, False) for made in ([], [out]))
    values = np.array([t.value for t in home.targets])
    assert best.risk == pytest.approx(values[:8].sum() / values.sum())
    assert best.plain == pytest.approx(plain.best) and plain.best < 1.0
    assert best.best >= best.plain and best.nearest <= best.plain


def test_what_tells_agents_apart() -> None:
    good = Play(0.5, 0.3, 0.5, 0.8, 2)
    assert good.tells(FIRE)
    for wrong in ({"risk": 0.3}, {"risk": 0.8}, {"nearest": 0.6}, {"plain": 0.75}, {"best": 1.0}):
        bad = dataclasses.replace(good, **wrong)
        assert not bad.tells(FIRE), wrong
        assert (bad.margin(FIRE) < 0.0) == ("plain" not in wrong), "what measures gain is left aside"
    assert good.margin(FIRE) == pytest.approx(0.15)
