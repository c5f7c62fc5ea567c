"""Labels of pictures: the same whatever hazards look like; and the state of things in fire and water."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from hazard_ms.perception.coco import add_amodal, annotations_of
from hazard_ms.perception.eye import Eye
from hazard_ms.perception.states import Watch, attributes, submerged
from hazard_ms.perception.viewpoints import viewpoints
from hazard_ms.sensing.camera import AGENT
from hazard_ms.simulation.world import World
from tests.worlds.flood_worlds import Thing, room

CUBE = 0.2  # edge [m]
TILT = (float(np.cos(np.pi / 8)), float(np.sin(np.pi / 8)), 0.0, 0.0)  # by 45 degrees about x


@pytest.fixture(scope="module")
def burning() -> Iterator[tuple[Any, Eye]]:
    """A kitchen in which things burn, and the camera in it."""
    env: Any = gym.make("HazardFire-v1", obs_mode="none").unwrapped
    env.reset(seed=3, options={"scene": "kitchen_a/03"})
    still = torch.zeros(env.action_space.shape)
    for _ in range(700):
        env.advance(still)
    eye = Eye(env, 128, 1.2)
    eye.show()
    yield env, eye
    env.close()


def poses_of(env: Any, count: int) -> list[Any]:
    burns = env.episode.states["fire"].status[0].numpy() == 1
    drawn = viewpoints(env, np.random.default_rng(0), burns, 1.2)
    return [next(drawn) for _ in range(count)]


@pytest.mark.render
def test_labels_and_depth_are_the_same_behind_flames_and_without_any(burning: tuple[Any, Eye]) -> None:
    env, eye = burning
    changed = 0
    for pose in poses_of(env, 4):
        shots = {mode: eye.shot(pose, mode) for mode in ("full", "fast", "off")}
        for mode in ("fast", "off"):
            assert np.array_equal(shots["full"].labels, shots[mode].labels), mode
            assert (shots["full"].depth.astype(int) - shots[mode].depth).max() <= 1, mode
        changed += int((np.abs(shots["full"].rgb.astype(int) - shots["off"].rgb).max(-1) > 50).sum())
        assert not (shots["full"].labels == AGENT).any(), "the robot is hidden"
    assert changed > 500, "flames are seen in the pictures"


@pytest.mark.render
def test_a_wider_view_shows_the_same_things_smaller(burning: tuple[Any, Eye]) -> None:
    """What the wide picture shows in its middle part is what the narrow one shows."""
    env, narrow = burning
    (pose,) = poses_of(env, 1)
    wide = Eye(env, 128, 2.0 * np.pi / 3.0)
    wide.show()
    shots = [eye.shot(pose, "off") for eye in (narrow, wide)]
    focal = [shot.intrinsic[0, 0] for shot in shots]
    assert focal == pytest.approx([64 / np.tan(0.6), 64 / np.tan(np.pi / 3)], rel=1e-5)
    edge = round(64 * focal[1] / focal[0])
    small = shots[1].labels[64 - edge : 64 + edge, 64 - edge : 64 + edge]
    places = ((np.arange(2 * edge) + 0.5) * 64 / edge).astype(int)
    assert (shots[0].labels[np.ix_(places, places)] == small).mean() > 0.9


@pytest.mark.render
def test_amodal_masks_hold_the_visible_ones_and_what_is_hidden(burning: tuple[Any, Eye]) -> None:
    env, eye = burning
    (pose,) = poses_of(env, 1)
    shot, states = eye.shot(pose, "full"), attributes(env, Watch(env))
    rows = annotations_of(shot, 1, env.specs[0].things, states, env.world.position[0].double().numpy())
    alone = eye.alone(pose, [row["instance"] for row in rows])
    for row in rows:
        mask = alone[row["instance"]]
        assert mask[shot.labels == row["instance"]].all()
        add_amodal(row, mask)
        assert row["attributes"]["visible"] == pytest.approx(row["area"] / mask.sum(), abs=1e-4)
    assert min(row["attributes"]["visible"] for row in rows) < 0.9, "something is hidden"
    assert np.array_equal(eye.shot(pose, "full").labels, shot.labels), "all is shown again"


@pytest.mark.long
@pytest.mark.render
def test_labels_are_the_same_before_and_after_a_ray_traced_picture(burning: tuple[Any, Eye]) -> None:
    env, eye = burning
    (pose,) = poses_of(env, 1)
    before = eye.shot(pose, "full")
    traced = eye.ray_traced(pose, "rt-fast", 2)
    assert traced.shape == before.rgb.shape and traced.std() > 5.0
    assert np.array_equal(eye.shot(pose, "full").labels, before.labels)


def pool(level: float, tilted: bool = False) -> World:
    """A cube, whose lowest point touches the floor of a room with water up to `level` [m]."""
    half = CUBE / 2 * (np.sqrt(2.0) if tilted else 1.0)
    world = room([Thing((CUBE, CUBE, CUBE), at=(10.0, 10.0, half))])
    world.position[0, 0, 2] = half
    world.rotation[0, 0] = torch.tensor(TILT if tilted else (1.0, 0.0, 0.0, 0.0))
    world.fields["water"] = lambda points: torch.full(points.shape[:2], level)
    return world


@pytest.mark.parametrize(("level", "share"), [(0.0, 0.0), (0.05, 0.25), (0.2, 1.0), (0.5, 1.0)])
def test_the_share_under_water_of_a_cube_on_the_floor(level: float, share: float) -> None:
    assert float(submerged(pool(level))[0]) == pytest.approx(share)


def test_the_share_under_water_of_a_cube_on_its_edge() -> None:
    """Water of depth h fills a wedge of cross-section h^2 as long as it is below the middle."""
    level = 0.08
    assert float(submerged(pool(level, tilted=True))[0]) == pytest.approx(level**2 / CUBE**2, abs=0.02)
