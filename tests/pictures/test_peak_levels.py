"""The number that films and the page tell of a hazard: where it meets things and robots, not in the sky."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401  # registers the tasks
from hazard_ms.pictures.peak_levels import peak_levels
from hazard_ms.sensing.view import View
from tests.worlds.rays import Block, cast, intrinsic, looking

STREET = (16.0, 16.0, 30.0)
EYE = (2.0, 8.0, 1.1)
TOWER = Block((9.0, 3.0, 0.0), (10.0, 13.0, 20.0), 0)


def view(at: tuple[float, float, float], sky: bool) -> View:
    """A look at a place, in a street with a tower; the ceiling of the box is the sky, where nothing is seen."""
    depth, labels = cast(looking(EYE, at), 64, (TOWER,), STREET)
    seen = View(depth, intrinsic(64), looking(EYE, at), labels, np.full((1, 16, 16), 70.0, np.float32))
    row, column = np.mgrid[0:64, 0:64]
    high = seen.points(row.ravel(), column.ravel())[:, 2].reshape(64, 64) > 29.9
    return replace(seen, depth=np.where(high & sky, 0.0, depth).astype(np.float32))


def test_points_of_the_sky_are_not_among_those_that_are_seen() -> None:
    up = (8.0, 8.0, 6.0)
    with_sky, without = view(up, True).sampled, view(up, False).sampled
    assert len(without) == 256 and (without[:, 2] > 29.9).sum() > 10
    np.testing.assert_array_equal(with_sky, without[without[:, 2] < 29.9])


@pytest.mark.parametrize("at", [(8.0, 8.0, 1.1), (8.0, 8.0, 6.0)])
def test_the_wind_is_that_at_two_metres(at: tuple[float, float, float]) -> None:
    """In `realistic` it follows the logarithmic profile of docs/physics.md, z0 = 0.03 m, from 1 m up."""
    env = gym.make("HazardWind-v1", obs_mode="none", physics="realistic", render_backend="none")
    env.reset(seed=0)
    base: Any = env.unwrapped
    (number,) = peak_levels(SimpleNamespace(base=base), view(at, True))
    aloft = float(base.episode.levels(base.world.agent_position.new_tensor([[[8.0, 8.0, 10.0]]]))[0, 0, 0])
    assert number == pytest.approx(aloft * np.log(2.0 / 0.03) / np.log(10.0 / 0.03), rel=0.02)
    high = replace(view(at, True), depth=np.zeros((64, 64), np.float32))
    assert peak_levels(SimpleNamespace(base=base), high) == (-np.inf,)
    env.close()


def test_a_fire_is_told_as_it_is_seen() -> None:
    env = gym.make("HazardFire-v1", obs_mode="none", render_backend="none")
    base: Any = env.unwrapped
    assert peak_levels(SimpleNamespace(base=base), view((8.0, 8.0, 1.1), True)) == (70.0,)
    env.close()
