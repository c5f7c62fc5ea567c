"""Nothing stands where a door's leaf stands open when an episode begins: robots that did were thrown by it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import box_of
from hazard_ms.scenes.check import check
from hazard_ms.scenes.floor import open_leaves, touches
from hazard_ms.scenes.splits import scene, scene_names
from hazard_ms.scenes.walls import WALLS
from hazard_ms.simulation.mitigation.hinges import angle, in_swing, on_leaf
from hazard_ms.spec import AgentStart, Opening, SceneSpec

RADIUS = 0.29  # of Fetch's base [m]
THROWN = ["house_test_1/16", "house_test_1/19", "house_flood_test_1/12", "house_flood_test_1/17"]  # of generator 2.3
ALL = [name for family in ("house", "house_flood") for name in scene_names("test", family)]
MORE = [pytest.param(name, marks=pytest.mark.long) for name in ALL if name not in THROWN]


def open_doors(spec: SceneSpec) -> list[Opening]:
    """The doors inside a home whose leaves stand open, more or less."""
    return [o for o in spec.room.openings if o.kind == "door" and o.wall not in WALLS and o.share > 0.0]


@pytest.mark.parametrize("name", [*THROWN, *MORE])
def test_no_robot_and_no_thing_begins_in_a_leaf(name: str) -> None:
    """By the swing of doors, which the skills ask, at the angle at which they begin."""
    spec = scene(name)
    boxes = [box_of(b, asset(b.asset).extent) for b in spec.bodies]
    low = [(box.x, box.y, min(box.half_x, box.half_y)) for box in boxes if box.low < 2.0]
    discs = np.array([(*spec.agent_start.position, RADIUS), *low])
    assert open_doors(spec)
    for o in open_doors(spec):
        turn = angle(o.share)
        assert not in_swing(spec.room, o, turn, turn, discs[:, :2], discs[:, 2]).any(), o


def test_who_starts_in_a_leaf_and_what_lies_in_one_is_named() -> None:
    spec = scene("house_test_1/16")
    assert check(spec) == []
    (o, *_) = open_doors(spec)
    x, y = on_leaf(spec.room, o, angle(o.share), o.width / 2).tolist()
    barred = dataclasses.replace(spec, agent_start=AgentStart((x, y), 0.0))
    assert any("the robot starts in a door's open leaf" in said for said in check(barred))
    thing = spec.bodies[0]
    moved = (dataclasses.replace(thing, position=(x, y, 0.0)), *spec.bodies[1:])
    assert f"{thing.name} is inside a door's open leaf" in check(dataclasses.replace(spec, bodies=moved))


def test_leaves_hang_on_their_hinges() -> None:
    """By hand: a quarter turn leaves a leaf on the line out of its hinge, half of it lies halfway along."""
    spec = scene("house_test_1/16")
    doors = open_doors(spec)
    leaves = open_leaves(spec.room)
    assert len(leaves) == len(doors) > 1
    for o, leaf in zip(doors, leaves, strict=True):
        for far in (0.0, o.width / 2, o.width):
            x, y = on_leaf(spec.room, o, math.acos(1.0 - o.share), far)
            assert float(leaf.distance(np.array(x), np.array(y))) == pytest.approx(0.0, abs=1e-9)
        beyond = on_leaf(spec.room, o, math.acos(1.0 - o.share), o.width + 0.5)
        assert float(leaf.distance(*np.array(beyond))) == pytest.approx(0.5)
        assert touches([leaf], (float(beyond[0]), float(beyond[1])), 0.51)
        assert not touches([leaf], (float(beyond[0]), float(beyond[1])), 0.49)


def test_a_second_robot_of_a_team_does_not_begin_in_a_leaf_either() -> None:
    """In this home the nearest free place, of those two robots of 0.29 m and 0.3 m between them leave, is in a leaf."""
    import gymnasium as gym

    import hazard_ms  # noqa: F401

    options = {"obs_mode": "none", "render_backend": "none", "effects": "off", "control_mode": "pd_joint_pos"}
    env = gym.make("HazardHouseFire-v1", robot_uids=("fetch", "fetch"), split="test", **options)
    env.reset(seed=0, options={"scene": "house_test_1/07"})
    spec = env.unwrapped.specs[0]
    places = np.array([robot.base()[:2] for robot in env.unwrapped.robots.values()])
    env.close()
    assert spec.name == "house_test_1/07" and math.dist(*places) >= 2 * RADIUS + 0.3
    for o in open_doors(spec):
        turn = angle(o.share)
        assert not in_swing(spec.room, o, turn, turn, places, np.full(2, RADIUS)).any(), o
