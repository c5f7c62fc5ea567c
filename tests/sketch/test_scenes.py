"""Scenes of the sketch beside the scenes that they are made from."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.presets import fire, flood, wind
from hazard_ms.scenes import splits
from hazard_ms.sketch.limits import limit_of
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.scenes import scenes_of, training_scenes
from hazard_ms.sketch.travel.ways import ARRIVED
from hazard_ms.spec.catalogue import CATEGORIES


@pytest.fixture(scope="module")
def kitchen() -> SketchScene:
    """The first test scene of fire."""
    return scenes_of("HazardFire-v1", ["kitchen_b/00"], [0])[0]


def test_targets_and_their_fate_are_those_of_the_scene(kitchen: SketchScene) -> None:
    """The frames of damage are those of the real environment with a parked robot."""
    targets = splits.scene("kitchen_b/00").targets
    assert kitchen.value.tolist() == [CATEGORIES[t.category].value for t in targets]
    assert kitchen.damaged_at.tolist() == [860, -1, 1010, -1, -1, -1, -1]
    assert (kitchen.safe_at == -1).all()
    assert kitchen.target_site.shape == (1, len(targets))
    for site, target in zip(kitchen.target_site[0], targets, strict=True):
        assert kitchen.position[site] == pytest.approx(target.position[:2], abs=0.05)
    assert (kitchen.height > [t.position[2] for t in targets]).all()
    for limit, target in zip(kitchen.limit[:, 0], targets, strict=True):
        row = CATEGORIES[target.category]
        assert limit == pytest.approx(row.ignition_temperature if row.flammable else np.inf, abs=0.01)


def test_nothing_is_damaged_before_its_limit_is_reached(kitchen: SketchScene) -> None:
    """A thing is as hot as the air around it only after a while."""
    assert (kitchen.level[0] < kitchen.limit).all()
    for target, frame in enumerate(kitchen.damaged_at):
        hot = kitchen.level[:, target, 0] >= kitchen.limit[target, 0]
        if frame >= 0:
            assert 0 < int(np.argmax(hot)) * 10 <= frame < int(np.argmax(hot)) * 10 + 300


def test_ways_end_where_a_walk_arrives(kitchen: SketchScene) -> None:
    off = np.linalg.norm(kitchen.way[:, :, -1] - kitchen.position[None], axis=-1)
    reached = np.isfinite(kitchen.travel[0])
    assert reached[kitchen.target_site[0]].all()
    assert np.median(off[:, reached]) < ARRIVED + 0.6  # and the half of the thing
    straight = np.linalg.norm(kitchen.way[:, :, -1] - kitchen.stand[:, None], axis=-1)
    assert (kitchen.travel >= 62.0 * straight - 1.0).all()


def test_every_place_has_a_stand_nearby(kitchen: SketchScene) -> None:
    start = np.asarray(splits.scene("kitchen_b/00").agent_start.position)
    x, y = np.floor((start - kitchen.grid_origin) / kitchen.grid_cell).astype(int)
    stand = kitchen.stand[kitchen.stand_of[y * kitchen.grid_shape[1] + x]]
    assert np.abs(stand - start).max() <= kitchen.grid_cell
    assert len(np.unique(kitchen.stand_of)) == len(kitchen.stand) < len(kitchen.stand_of)


def test_landmarks_lie_apart_and_sight_is_neither_all_nor_nothing(kitchen: SketchScene) -> None:
    places = kitchen.position[kitchen.landmark_site]
    apart = np.linalg.norm(places[:, None] - places, axis=-1)[~np.eye(len(places), dtype=bool)]
    assert len(places) >= 5 and apart.min() >= 1.0
    assert 0.2 < (kitchen.pixels > 3).mean() < 0.95
    assert 0 < np.bitwise_count(kitchen.spots).mean() < 16


@pytest.mark.parametrize(
    ("hazard", "category", "limit"),
    [
        (fire("paper"), next(n for n, r in CATEGORIES.items() if r.flammable), None),
        (fire("paper"), next(n for n, r in CATEGORIES.items() if not r.flammable), np.inf),
        (flood("paper"), next(n for n, r in CATEGORIES.items() if not r.waterproof), 0.4),
        (flood("paper"), next(n for n, r in CATEGORIES.items() if r.waterproof), np.inf),
        (wind("paper"), next(iter(CATEGORIES)), np.inf),
    ],
)
def test_limits_are_what_threatens_a_target_at_its_height(hazard: Hazard, category: str, limit: float | None) -> None:
    wanted = CATEGORIES[category].ignition_temperature if limit is None else limit
    assert limit_of(hazard, category, 0.4) == pytest.approx(wanted, abs=1e-2)


def test_what_there_is_not_is_refused() -> None:
    with pytest.raises(ValueError, match="HazardFire-v1"):
        scenes_of("HazardRain-v1", ["kitchen_b/00"], [0])
    with pytest.raises(ValueError, match="robot must be one of"):
        scenes_of("HazardFire-v1", ["kitchen_b/00"], [0], robot="wheelbarrow")
    with pytest.raises(ValueError, match="count must be a whole number"):
        training_scenes("HazardFire-v1", "paper", 0)


@pytest.mark.long
def test_what_the_wind_blows_away_has_sites_all_along_its_course() -> None:
    (street,) = scenes_of("HazardWind-v1", ["parking/00"], [0])
    assert len(street.cart_site) == 3
    samples, targets = street.target_site.shape
    assert samples == 301 and targets == 15
    moved = np.linalg.norm(street.position[street.target_site[-1]] - street.position[street.target_site[0]], axis=1)
    assert moved.max() > 2.0
    steps = street.position[street.target_site[1:]] - street.position[street.target_site[:-1]]
    gone = np.linalg.norm(steps, axis=-1)
    assert gone[gone > 0].min() > 0.3 and np.quantile(gone[gone > 0], 0.9) < 2.0
