"""The town around a street is seen alone: nothing of it stands where things can be, and labels do not know it."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401  # registers the tasks
from hazard_ms.effects.streets.ground import HIGHEST
from hazard_ms.effects.streets.hung import ABOVE
from hazard_ms.effects.streets.plan import town_of
from hazard_ms.effects.streets.street import CLOUDS, FIRM, LOOSE
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import box_of
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import SceneSpec

PLACES = ("street/03", "street/07", "crossing/02", "park/04", "parking/01", "parking_hard/02")
MOST_TRIANGLES = 12_000  # of a town: what a single model of a car has
WIND = 0.6  # the wind moves nothing farther [m]
LABELS = ("segmentation", "depth")


def corners(spec: SceneSpec) -> np.ndarray:
    """All corners of the town around `spec` [m], [V, 3]."""
    return np.concatenate([mesh.vertices for mesh in town_of(spec).meshes])


@pytest.mark.parametrize("name", PLACES)
def test_where_things_can_be_it_is_flat_or_overhead(name: str) -> None:
    """A corner is within 2 cm of the ground, above what a robot looks at, or above the fixture that carries it."""
    spec = scene(name)
    points = corners(spec)
    beyond, (x, y) = spec.room.beyond, spec.room.size
    low, high = np.array([-beyond, -beyond]), np.array([x + beyond, y + beyond])
    inside = ((points[:, :2] > low) & (points[:, :2] < high)).all(1)
    near = points[inside]
    assert len(near) > 100
    free = (near[:, 2] > HIGHEST) & (near[:, 2] < ABOVE)
    for fixture in spec.fixtures:
        box = box_of(fixture, asset(fixture.asset).extent)
        free &= ~((box.distance(near[:, 0], near[:, 1]) < 0.05) & (near[:, 2] > box.high - 0.1))
    assert not free.any(), near[free][:5]
    assert (near[:, 2] > 0.006).all()  # above the patches of ground: two at one height would flicker


@pytest.mark.parametrize("name", PLACES)
def test_it_surrounds_the_place_and_is_light(name: str) -> None:
    """In each of eight directions something stands out there; and all of it together is no more than one model."""
    spec = scene(name)
    town = town_of(spec)
    points = corners(spec) - [spec.room.size[0] / 2, spec.room.size[1] / 2, 0.0]
    standing = points[(points[:, 2] > 3.0) & (np.abs(points[:, :2]).max(1) > spec.room.size[0] / 2 + spec.room.beyond)]
    sectors = np.floor((np.arctan2(standing[:, 1], standing[:, 0]) / np.pi + 1.0) * 4.0).astype(int) % 8
    assert set(sectors) == set(range(8))
    assert 2 * sum(map(len, town.meshes)) < MOST_TRIANGLES


def test_a_scene_has_one_town_and_another_scene_another_one() -> None:
    first, again, other = corners(scene("street/03")), corners(scene("street/03")), corners(scene("street/04"))
    np.testing.assert_array_equal(first, again)
    assert first.shape != other.shape or not np.allclose(first, other)


def test_no_two_houses_share_ground() -> None:
    """Walls of houses, which reach from the ground to 5 m, do not cross: lots are taken once, and roads stay free."""
    from hazard_ms.effects.streets.lots import Lots
    from hazard_ms.effects.streets.mesh import Frame

    spec = scene("street/03")
    lots = Lots(spec.room)
    assert lots.take(Frame(40.0, -20.0), 6.0, 6.0)
    assert not lots.take(Frame(44.0, -18.0), 6.0, 6.0)
    assert lots.take(Frame(46.1, -20.0), 6.0, 6.0)
    assert not lots.take(Frame(40.0, 13.0), 2.0, 2.0)  # the road
    assert not lots.take(Frame(8.0, 2.0), 2.0, 2.0)  # where things can be


@pytest.mark.render
@pytest.mark.long
@pytest.mark.parametrize("name", ["street/03", "parking/01"])
def test_labels_and_depth_are_those_without_it(name: str) -> None:
    seen = {}
    for mode in ("full", "off"):
        size = {"width": 160, "height": 128}
        env = gym.make("HazardWind-v1", obs_mode="rgb+depth+segmentation", effects=mode, sensor_configs=size)
        obs, _ = env.reset(seed=0, options={"scene": name})
        (camera,) = obs["sensor_data"].values()
        seen[mode] = {k: v.cpu().numpy() for k, v in camera.items()}
        names = {e.name for e in env.unwrapped.scene.sub_scenes[0].entities}
        assert names.issuperset({FIRM, LOOSE, CLOUDS}) == (mode == "full")
        env.close()
    for label in LABELS:
        np.testing.assert_array_equal(seen["full"][label], seen["off"][label])
    assert (seen["full"]["rgb"] != seen["off"]["rgb"]).any(-1).mean() > 0.2


@pytest.mark.render
def test_it_has_no_collision() -> None:
    env = gym.make("HazardWind-v1", obs_mode="rgb")
    env.reset(seed=0, options={"scene": "street/03"})
    (place,) = env.unwrapped.scene.sub_scenes
    town = [e for e in place.entities if e.name in (FIRM, LOOSE, CLOUDS)]
    assert len(town) == 3
    for entity in town:
        assert [type(c).__name__ for c in entity.components] == ["RenderBodyComponent"]
    env.close()
