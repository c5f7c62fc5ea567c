"""A robot put at any place that is said to be clear stands still there, and touches nothing."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401
from hazard_ms.scenes.floor import FLOOR_CELL, free_floor
from hazard_ms.simulation.clearance import clear_points
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.episodes import feed

SPACING = 0.1  # [m]
FRAMES = 10  # within which PhysX drives apart what overlaps
STILL = 0.02  # most that a thing or the robot may move meanwhile [m]
SCENES = [
    *[("HazardFire-v1", f"kitchen_a/{n:02d}") for n in (9, 3, 16, 23)],
    *[("HazardFire-v1", f"living_room_a/{n:02d}") for n in (7, 12, 22)],
    *[("HazardFire-v1", f"craft_room_a/{n:02d}") for n in (4, 5)],
    ("HazardWind-v1", "street/09"),
]


def made(task: str, scene: str, robot: str) -> Any:
    env = gym.make(
        task,
        obs_mode="none",
        render_backend="none",
        robot_uids=robot,
        control_mode="pd_joint_pos",
        deterministic=False,
        scene_every=0,
    )
    env.reset(seed=0, options={"scene": scene})
    return env


def frames(base: Any) -> tuple[bool, float]:
    """Let some frames pass; whether the simulation broke, and how far the fastest thing went in the first of them."""
    still = base.agent.action(0.0, 0.0, base.agent.tucked, True)
    broke, fastest = False, 0.0
    for _ in range(FRAMES):
        broke |= bool(base.advance(still)["sim_error"])
        fastest = max(fastest, float(base.world.velocity.norm(dim=-1).max()))
    return broke, fastest


def try_places(env: Any, count: int) -> None:
    base, draw = env.unwrapped, np.random.default_rng(0)
    usual = frames(base)[1]  # things settle a little in the first frames, wherever the robot is
    env.reset()
    places = clear_points(base.world, 0, base.agent.build.radius, SPACING)
    for x, y in places[draw.permutation(len(places))[:count]].tolist():
        env.reset()
        heading = float(draw.uniform(-np.pi, np.pi))
        base.place_robot((x, y), heading)
        assert base.agent.base() == pytest.approx((x, y, heading), abs=1e-5)
        broke, fastest = frames(base)
        assert not broke and fastest <= usual + 0.05, (x, y, heading, fastest, usual)
        assert base.agent.base() == pytest.approx((x, y, heading), abs=STILL), (x, y, heading)


@pytest.mark.parametrize("robot", list(ROBOTS))
def test_clear_places_in_a_kitchen(robot: str) -> None:
    env = made("HazardFire-v1", "kitchen_a/09", robot)
    try_places(env, 5)
    env.close()


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("robot", list(ROBOTS))
@pytest.mark.parametrize(("task", "scene"), SCENES)
def test_clear_places_in_many_scenes(task: str, scene: str, robot: str) -> None:
    env = made(task, scene, robot)
    try_places(env, 20)
    env.close()


def test_a_place_in_furniture_is_refused_and_the_robot_stays() -> None:
    """Here the middle of the robot is over free floor, and its sides are not: the simulation broke at this place."""
    env = made("HazardFire-v1", "kitchen_a/09", "fetch")
    base = env.unwrapped
    spot = (3.975, 3.125)
    grid = free_floor(base.specs[0], 0.0)
    assert grid[int(spot[0] / FLOOR_CELL), int(spot[1] / FLOOR_CELL)], "it is free for a point"

    def state() -> bytes:
        import hashlib

        digest = hashlib.sha256()
        feed(digest, base.get_state_dict())
        return digest.digest()

    before = state()
    with pytest.raises(ValueError, match=r"must start 0.29 m clear of all things, got \(3.975, 3.125\), too close to "):
        base.place_robot(spot, 1.98)
    for place, heading in ((None, 0.0), ((1.0,), 0.0), ((1.0, torch.nan), 0.0), ((1.0, 1.0), "north"), (("a", 1), 0.0)):
        with pytest.raises(ValueError, match=" must be "):
            base.place_robot(place, heading)
    with pytest.raises(ValueError, match="env must be a whole number from 0 to 0, got 1"):
        base.place_robot((1.0, 1.0), 0.0, env=1)
    assert state() == before
    base.agent.place(torch.tensor([0]), torch.tensor([spot]), torch.tensor([1.98]))
    broke, fastest = frames(base)
    assert broke or fastest > 1.0, "so the refusal is for a reason"
    env.close()
