"""Futures of a fire against the fire itself, and flames that are found behind the temperatures that they cause."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.fire.fire_state import lit
from hazard_ms.sketch.planning import creeping_fire
from hazard_ms.sketch.planning.creeping_fire import (
    FLAME,
    ROOM,
    Flames,
    Things,
    burning_from,
    flame_weight,
    found,
    weights,
)
from hazard_ms.spec.catalogue import CATEGORIES
from tests.worlds.fire_worlds import begin, room_world, run

ORIGIN = (10.0, 10.0)
COPIES = 40
DISTANCES = (0.6, 0.9, 1.2, 3.5, 7.0)  # of books from the first flame [m]
BOOK = CATEGORIES["book"].ignition_temperature  # [C]
GROWN = creeping_fire.GROWN  # age of the first flame at which it begins to spread [frames]


def test_the_rules_are_those_of_the_fire() -> None:
    fire = Fire()
    assert (ROOM, FLAME, creeping_fire.REACH) == (fire.room_temperature, fire.flame_temperature, fire.reach)
    assert fire.nearest == fire.reach and fire.image_room_weight == 1.0
    assert pytest.approx((1 - fire.decay) ** (spread.EVERY // fire.heat_every)) == creeping_fire.KEPT
    assert (creeping_fire.CELL, creeping_fire.STEP) == (spread.STEP, spread.EVERY)
    assert creeping_fire.FIRST_CHANCE == spread.FIRST_CHANCE
    assert creeping_fire.AGES == tuple(age * spread.AGE_UNIT for age in spread.AGES)
    assert creeping_fire.FARTHEST >= spread.lattice_reach(1500)
    ages = torch.arange(0, 400, spread.EVERY)
    grown = spread.growth(torch.zeros_like(ages), ages - spread.EVERY) == spread.GROWTH_STEPS
    assert int(ages[grown][0]) == creeping_fire.GROWN


def burnt_in_truth(frames: int) -> tuple[np.ndarray, np.ndarray]:
    """The frame at which each book catches fire in many runs of the fire itself, [N, M]; inf for not by `frames`.

    And the temperatures when the first flame was grown [C], [M], before chance plays any part.
    """
    books = [("book", (ORIGIN[0] + d, ORIGIN[1], 0.0)) for d in DISTANCES]
    fire, world = Fire(), room_world(books, [ORIGIN], copies=COPIES)
    state = begin(fire, world)
    caught = np.full((COPIES, len(DISTANCES)), np.inf)
    for _ in range(frames // 10):
        run(fire, state, world, 10)
        if int(world.frame[0]) == GROWN:
            warm = state.temperature[0, : len(DISTANCES)].double().numpy()
        burns = fire.damaged(state, world)[:, : len(DISTANCES)].numpy()
        caught[burns & np.isinf(caught)] = float(world.frame[0])
    return caught, warm


def one_flame() -> Flames:
    """A floor of 31 x 31 cells with one flame in the middle, which is at ORIGIN."""
    chance = np.zeros((31, 31))
    chance[15, 15] = 1.0
    return Flames(np.array(ORIGIN) - 15 * creeping_fire.CELL, chance, np.ones((31, 31), bool))


def books(temperature: np.ndarray | None = None) -> Things:
    base = np.array([(ORIGIN[0] + d, ORIGIN[1], 0.0) for d in DISTANCES])
    warm = np.full(len(base), ROOM) if temperature is None else temperature
    return Things(base, warm, np.full(len(base), BOOK))


def test_futures_burn_what_the_fire_burns_when_it_does() -> None:
    """From when the first flame is grown, which truly is overdue to spread: medians within 100 frames of the truth."""
    frames, warm = burnt_in_truth(1400)
    futures = burning_from(one_flame(), books(warm), GROWN, 1400, COPIES, np.random.default_rng(0))
    truth, foreseen = np.median(frames, axis=0), np.median(futures, axis=0)
    assert np.isfinite(truth).tolist() == np.isfinite(foreseen).tolist() == [True] * 4 + [False]
    assert np.abs(foreseen[:4] - truth[:4]).max() < 100


def test_fire_does_not_creep_over_furniture() -> None:
    walled = one_flame()
    walled.free[:, 16] = False
    walled.free[[14, 16], :] = False
    far = books()
    open_floor = burning_from(one_flame(), far, GROWN, 1400, 8, np.random.default_rng(0))
    behind = burning_from(walled, far, GROWN, 1400, 8, np.random.default_rng(0))
    assert (behind[:, 2] > open_floor[:, 2]).all()


def test_a_burning_thing_lights_the_next() -> None:
    """No flame on the floor: a thing of 600 C heats one beside it, at 0.5 m, to (20 + 600) / 2 = 310 C at most."""
    no_flame = Flames(np.zeros(2), np.zeros((3, 3)), np.ones((3, 3), bool))
    base = np.array([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 0.5, 0.0)])
    for threshold, burns in ((300.0, True), (320.0, False)):
        things = Things(base[:2], np.array([FLAME, ROOM]), np.array([300.0, threshold]))
        caught = burning_from(no_flame, things, 0, 1500, 2, np.random.default_rng(0))
        assert caught[:, 0].tolist() == [0.0, 0.0]
        assert np.isfinite(caught[:, 1]).tolist() == [burns, burns]
        if burns:  # 310 - 290 x 0.97^n is 300 after n = 110.5 updates, each 5 frames
            assert caught[0, 1] == pytest.approx(555, abs=10)


def seen(frame: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Points on the floor, [P, 3], what the fire's image shows there at a frame, [P], and how many flames there are."""
    fire, world = Fire(), room_world([], [ORIGIN])
    state = begin(fire, world)
    run(fire, state, world, frame)
    x, y = np.meshgrid(np.arange(8.0, 12.0, 0.2), np.arange(8.0, 12.0, 0.2))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    image = fire.image(state, world, torch.tensor(points, dtype=torch.float32)[None])[0].numpy()
    return points, image.astype(np.float64), int(lit(state, world.frame).sum())


@pytest.mark.parametrize("frame", [100, 900])
def test_flames_are_found_behind_what_they_heat(frame: int) -> None:
    """As many as there are, within a quarter, and they explain the image within 10 C wherever it is not hot."""
    points, image, count = seen(frame)
    nothing = Things(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    flames = found(points, image, nothing, np.zeros((0, 2)))
    assert flames is not None
    assert flames.chance.sum() == pytest.approx(count, rel=0.25)
    weight = weights(points, flames.places) @ flames.chance.ravel()
    again = (ROOM + FLAME * weight) / (1 + weight)
    assert np.abs(again - image).max() < 25


def test_cool_things_hide_no_flame() -> None:
    """A flame at 0.4 m and a cool thing at 0.3 m: (20 + 600 + 20) / 3 C; the weight of the flame is 1."""
    thing = Things(np.array([(0.3, 0.0, 0.0)]), np.array([ROOM]), np.array([np.inf]))
    weight = flame_weight(np.zeros((1, 3)), np.array([640.0 / 3.0]), thing)
    assert weight[0] == pytest.approx(1.0)


def test_a_cool_floor_holds_no_flames() -> None:
    points = np.column_stack([np.arange(9.0), np.zeros(9), np.zeros(9)])
    nothing = Things(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    assert found(points, np.full(9, ROOM + 30.0), nothing, np.zeros((0, 2))) is None
