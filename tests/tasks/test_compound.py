"""Hazards that act together: one writer per field, water against fire, wind with fire, and whole environments."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401
from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.coupling import PER_WIND, drift
from hazard_ms.hazards.fire.fire_state import BURNING, BURNT, NORMAL, lit
from hazard_ms.hazards.presets import hazard
from hazard_ms.simulation.world import World
from hazard_ms.tasks.compound import hazard_compound
from hazard_ms.tasks.episode.episode import Episode
from tests.worlds.fire_worlds import room_world

FRAME = 1 / 30  # [s]
PHYSICS = ("paper", "shipped", "realistic")


def begun(world: World, *names: str, physics: str = "paper") -> Episode:
    episode = Episode(world, tuple(hazard(name, physics) for name in names))
    rows = torch.arange(world.num_envs)
    episode.begin(rows, rows + 3)
    episode.begin_hazards(rows)
    return episode


def pond(level: float, until: float = 10.0) -> Any:
    """Water of a level [m] west of x = `until` [m]."""
    return lambda points: torch.where(points[..., 0] < until, level, 0.0)


def test_a_field_has_one_writer_and_its_readers_come_after_it() -> None:
    world = room_world([("book", (5.0, 5.0, 0.0))], [(6.0, 5.0)])
    with pytest.raises(ValueError, match="'flood' must come before 'fire', which reads 'water'"):
        begun(world, "fire", "flood")
    with pytest.raises(ValueError, match="'water' must be written by one hazard alone, got a second: 'flood'"):
        begun(world, "flood", "flood")
    assert set(begun(world, "flood", "wind", "fire").world.fields) == {"water", "air"}
    assert begun(world, "fire").world.fields == {}


@pytest.mark.parametrize("physics", PHYSICS)
def test_what_burns_goes_out_under_water_and_does_not_burn_again(physics: str) -> None:
    """Two books between two fires; only the western half is under 2 cm of water.

    In `realistic` the fires stand for chairs, which burn above it.
    """
    world = room_world([("book", (9.0, 10.0, 0.0)), ("book", (11.0, 10.0, 0.0))], [(9.0, 10.2), (11.0, 10.2)])
    episode = begun(world, "fire", physics=physics)
    state = episode.states["fire"]
    state.status[:] = BURNING
    state.temperature[:] = 500.0
    world.fields["water"] = pond(0.02)
    episode.advance(FRAME)
    assert state.status[0].tolist() == [BURNT, BURNING]
    assert float(state.temperature[0, 0]) <= 100.0 < float(state.temperature[0, 1])
    assert lit(state, world.frame)[0, :2].tolist() == [physics == "realistic", True]
    world.fields["water"] = pond(0.0)
    state.status[:] = NORMAL
    state.temperature[:] = 599.0
    for _ in range(15):
        episode.advance(FRAME)
    assert state.status[0].tolist() == [NORMAL, BURNING]  # the wetted one is as hot and does not ignite


def test_fire_does_not_spread_into_water() -> None:
    """600 frames, water everywhere west of the fire, 22 cm cells: no flame is lit there."""
    world = room_world([("pan", (3.0, 3.0, 0.0))], [(10.1, 10.0)])
    episode = begun(world, "fire")
    world.fields["water"] = pond(0.05, until=10.0)
    for _ in range(900):
        episode.advance(FRAME)
    state = episode.states["fire"]
    burning = state.flame_place[lit(state, world.frame)]
    assert len(burning) > 4 and float(burning[:, 0].min()) >= 10.0


def test_wind_drives_the_fire_as_the_factor_says() -> None:
    """exp(0.0842 w . d) by hand for 5 m/s to the north-east; and picks of a direction in these proportions."""
    world = room_world([("pan", (3.0, 3.0, 0.0))], [(10.0, 10.0)])
    wind = torch.tensor([3.0, 4.0])
    world.fields = {"air": lambda points: wind.expand(*points.shape[:2], 2)}
    weight = drift(world, torch.zeros(1, 1, 3))
    assert weight is not None
    expected = np.exp(PER_WIND * np.array([3.0, -3.0, 4.0, -4.0]))
    assert weight[0, 0].numpy() == pytest.approx(expected, rel=1e-6)
    number = 40_000
    draw = (torch.arange(number, dtype=torch.float64) + 0.5) / number
    picked = spread.pick(torch.zeros(1, number, dtype=torch.int64), draw[None].float(), weight.expand(1, number, 4))
    share = np.bincount(picked[0].numpy(), minlength=4) / number
    assert share == pytest.approx(expected / expected.sum(), abs=1e-3)
    used = torch.full((1, number), 0b0101)  # the first and the third are used up
    picked = spread.pick(used, draw[None].float(), weight.expand(1, number, 4))
    assert set(picked[0].tolist()) == {1, 3}


def test_fire_gets_farther_with_the_wind_than_against_it() -> None:
    """64 scenes, 5 m/s to the east: the mean place of the flames moves east by more than chance allows."""
    world = room_world([("pan", (3.0, 3.0, 0.0))], [(10.0, 10.0)], copies=64)
    episode = begun(world, "fire")
    world.fields["air"] = lambda points: points.new_tensor([5.0, 0.0]).expand(*points.shape[:2], 2)
    for _ in range(1200):
        episode.advance(FRAME)
    state = episode.states["fire"]
    burns = lit(state, world.frame)
    east = torch.where(burns, state.flame_place[..., 0] - 10.0, 0.0).sum(1) / burns.sum(1)
    north = torch.where(burns, state.flame_place[..., 1] - 10.0, 0.0).sum(1) / burns.sum(1)
    assert float(east.mean()) > 5 * float(east.std()) / 8
    assert abs(float(north.mean())) < 4 * float(north.std()) / 8


@pytest.mark.parametrize("bad", [(), ("fire", "fire"), ("quake",), "fire", ("fire", "rain")])
def test_bad_tuples_of_hazards_are_refused(bad: Any) -> None:
    with pytest.raises(ValueError, match="some of fire, flood, wind, each once"):
        hazard_compound("paper", bad)


def test_hazards_are_for_the_compound_task_only() -> None:
    with pytest.raises(ValueError, match="hazards must be None for HazardFire-v1"):
        gym.make("HazardFire-v1", hazards=("fire",), render_backend="none", obs_mode="state")


@pytest.mark.parametrize("hazards", [("fire", "flood"), ("wind", "fire"), ("flood", "wind", "fire")])
def test_whole_environments_run_and_repeat(hazards: tuple[str, ...]) -> None:
    """The same seed gives the same bits in a new environment; nothing breaks in 40 frames of random actions."""
    ends = []
    for _ in range(2):
        env = gym.make("HazardCompound-v1", hazards=hazards, obs_mode="state", render_backend="none")
        env.reset(seed=5)
        env.action_space.seed(1)
        for _ in range(40):
            _, _, _, truncated, info = env.step(env.action_space.sample())
            assert not bool(truncated) and not bool(info["sim_error"])
        base: Any = env.unwrapped
        ends.append((base.world.position.clone(), base.episode.states["fire"].temperature.clone()))
        assert [h.name for h in base.task.hazards] == [n for n in ("flood", "wind", "fire") if n in hazards]
        assert bool(base.world.fields["water" if "flood" in hazards else "air"](base.world.position).isfinite().all())
        env.close()
    assert all(torch.equal(a, b) for a, b in zip(*ends, strict=True))
