"""Practice at a door: rewards worked out by hand, starts, what is observed, states, and hazards."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.clearance import obstacle
from hazard_ms.skills.context import Stage
from hazard_ms.skills.mitigations.guiding import guide
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.motor.arm import go, posture_for
from hazard_ms.spec.registry import TASKS
from hazard_ms.tasks import task_of
from tests.worlds.practice_rooms import made, reward
from tests.worlds.registering import practising

TASK = "HazardOpenDoor-v1"
PASSING = 2 * 0.29  # width of Fetch [m]


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module")
def door() -> Iterator[Any]:
    yield from made(TASK)


def geometry(base: Any) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """The width of the door [m], its hinge [m], the directions of its leaf and of its swing, from the scene alone."""
    (opening,), (wall,) = base.specs[0].room.openings, base.specs[0].room.partitions
    low = opening.centre - opening.width / 2
    if wall.axis == "y":
        return opening.width, np.array([wall.at, low]), np.array([0.0, 1.0]), np.array([-1.0, 0.0])
    return opening.width, np.array([low, wall.at]), np.array([1.0, 0.0]), np.array([0.0, -1.0])


def handle(base: Any, angle: float) -> np.ndarray:
    """The middle of the handle at an `angle` of the leaf [rad], [3] [m]."""
    wide, hinge, along, out = geometry(base)
    return np.array([*(hinge + (wide - 0.07) * (math.cos(angle) * along + math.sin(angle) * out)), 1.0])


def turn(base: Any, angle: float) -> None:
    base.world.openings.set_open(torch.arange(1), 0, 1.0 - math.cos(angle))


# [m] from the hand to the handle, whether it holds it, and the turn of the leaf as a share of what it has to be; the
# hint: thirds of 0.25 / (0.25 + gap beyond 0.15 m), of the hold, and of the turn
HINTS = (
    (0.0, False, 0.0, 1 / 3),
    (0.15, False, 0.0, 1 / 3),
    (0.4, False, 0.0, 1 / 6),
    (0.65, False, 0.0, 1 / 9),
    (0.1, True, 0.0, 2 / 3),
    (0.1, True, 0.5, 5 / 6),
    (0.4, False, 0.5, 1 / 3),
    (0.1, True, 0.99, 2.99 / 3),
)


@pytest.mark.parametrize(("gap", "holds", "turned", "hint"), HINTS)
def test_opening_pays_as_worked_out_by_hand(
    door: Any, monkeypatch: pytest.MonkeyPatch, gap: float, holds: bool, turned: float, hint: float
) -> None:
    base = door.unwrapped
    door.reset(seed=0)
    angle = turned * math.acos(1.0 - PASSING / geometry(base)[0])
    turn(base, angle)
    base.world.door_grip.state.holds[0, 0] = holds
    at = torch.from_numpy(handle(base, angle) + (0.0, 0.0, gap)).float()[None]
    monkeypatch.setattr(base.agent, "gripper_pose", lambda: (at, torch.tensor([[1.0, 0.0, 0.0, 0.0]])))
    assert reward(base) == pytest.approx(hint / 300, abs=1e-5)
    info = base.get_info()
    assert not info["success"] and not info["fail"] and float(base.compute_sparse_reward(None, None, info)) == 0.0
    assert float(info["gap"]) == pytest.approx(gap, abs=1e-4) and float(info["angle"]) == pytest.approx(angle, abs=1e-4)


def test_a_door_is_open_where_the_robot_gets_through(door: Any) -> None:
    """In a door of 0.9 m that is at 69 degrees; a leaf that is gone opens nothing any more."""
    base = door.unwrapped
    assert (base.task.goal.largest - 1.0) * door.spec.max_episode_steps <= 1.0 + 1e-9  # nobody gains by waiting
    assert math.degrees(math.acos(1.0 - PASSING / 0.9)) == pytest.approx(69.2, abs=0.1)
    for seed in range(3):
        door.reset(seed=seed)
        wide_enough = math.acos(1.0 - PASSING / geometry(base)[0])
        for angle, opened in ((wide_enough - 0.01, False), (wide_enough + 0.01, True), (math.pi / 2, True)):
            turn(base, angle)
            info = base.get_info()
            assert bool(info["success"]) is opened and not info["fail"]
            assert float(base.compute_sparse_reward(None, None, info)) == float(opened)
            assert (reward(base) > 1.0) is opened and 0.0 <= reward(base) <= base.task.goal.largest
        base.world.openings.state.broken[0, 0] = True
        assert not base.get_info()["success"] and base.get_info()["fail"]


def test_robots_start_before_the_door_and_out_of_its_way(door: Any) -> None:
    base, starts, axes = door.unwrapped, set(), set()
    for seed in range(12):
        door.reset(seed=seed)
        wide, hinge, along, out = geometry(base)
        x, y, heading = base.agent.base()
        assert obstacle(base.world, 0, (x, y), base.agent.build.radius) == ""
        way = handle(base, 0.0)[:2] - (x, y)
        assert 0.9 <= np.hypot(*way) <= 1.0 and (np.array([x, y]) - hinge) @ out > 0.8
        askew = math.atan2(way[1], way[0]) - heading
        assert abs(math.atan2(math.sin(askew), math.cos(askew))) < 0.301
        assert np.hypot(*(np.array([x, y]) - hinge)) > wide + base.agent.build.radius + 0.02  # half of the leaf
        starts.add((round(x, 3), round(y, 3), round(heading, 3)))
        axes.add(tuple(along))
        assert not base.get_info()["success"].any() and float(base.get_info()["angle"]) == 0.0
    assert len(starts) == 12 and len(axes) == 2


def test_what_is_observed_is_where_the_geometry_says(door: Any) -> None:
    base = door.unwrapped
    for seed, angle in ((1, 0.0), (2, 0.8)):
        door.reset(seed=seed)
        turn(base, angle)
        base.world.door_grip.state.holds[0, 0] = True
        seen = {key: value[0].numpy() for key, value in base._get_obs_extra({}).items()}
        x, y, heading = base.agent.base()
        c, s = math.cos(heading), math.sin(heading)
        into = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        wanted, hinge = handle(base, angle), np.array([*geometry(base)[1], 1.0])
        np.testing.assert_allclose(seen["handle"], into @ (wanted - (x, y, 0.0)), atol=1e-4)
        np.testing.assert_allclose(seen["hinge"], into @ (hinge - (x, y, 0.0)), atol=1e-4)
        np.testing.assert_allclose(seen["from_hand"], into @ (wanted - base.agent.hand()), atol=2e-3)
        np.testing.assert_allclose(seen["hand"] + seen["from_hand"], seen["handle"], atol=1e-5)
        assert seen["angle"] == pytest.approx(angle, abs=1e-4) and seen["holding"] == 1.0 and seen["shut"] == 0.0


def test_rooms_of_the_splits_differ_and_can_be_built(practice: Any) -> None:
    rooms = [practice.door_room(name) for split in ("train", "test") for name in practice.names(split)]
    assert len({room.room.openings for room in rooms}) == 125
    for room in rooms:
        (opening,), (wall,) = room.room.openings, room.room.partitions
        length, deep = room.room.size if wall.axis == "x" else room.room.size[::-1]
        assert 0.9 <= opening.width <= 1.0 and opening.wall == wall.name
        assert opening.width < opening.centre < length - opening.width and 2.4 < wall.at < deep - 2.4
        assert room == practice.door_room(room.name) and len(room.targets) == 1
    with pytest.raises(ValueError, match=r"^scene must be one of"):
        practice.door_room("kitchen_a/00")


def test_hazards_act_at_doors_and_change_neither_rooms_nor_starts() -> None:
    calm = gym.make(TASK, obs_mode="none", render_backend="none", deterministic=False)
    env = gym.make(TASK, obs_mode="none", render_backend="none", hazards=["fire", "flood"], deterministic=False)
    for each in (calm, env):
        each.reset(seed=3)
    assert calm.unwrapped.specs == env.unwrapped.specs and calm.unwrapped.agent.base() == env.unwrapped.agent.base()
    _, hinge, along, out = geometry(env.unwrapped)
    for place in env.unwrapped.specs[0].fires:  # before the door, and beside it
        assert np.hypot(*(hinge + along * geometry(env.unwrapped)[0] / 2 - place)) < 0.91
        assert (np.array(place) - hinge) @ out > 0.0
    for _ in range(60):
        env.unwrapped.advance(None)
    assert env.unwrapped.episode.flames().lit.any() and float(env.unwrapped.get_info()["angle"]) == 0.0
    calm.close()
    env.close()


def opened_by_hand(base: Any) -> Iterator[Any]:
    """The joint actions with which a skill brings the hand to the handle and opens the door, given no map."""
    stage = Stage(base, SemanticMap((0.0, 0.0), base.world.movable[0].numpy(), hazards=0), lambda: None)
    leaf = Leaf(base.world, 0)
    x, y, _ = stage.robot.base()
    towards = np.array([x, y, leaf.handle()[2]]) - leaf.handle()
    posture = posture_for(stage, leaf.handle() + 0.08 * towards / np.linalg.norm(towards) + (0.0, 0.0, 0.05))
    yield from go(stage, posture.arm, 60, lambda: float(np.linalg.norm(stage.robot.hand() - leaf.handle())) < 0.13)
    yield from guide(stage, leaf, math.pi / 2)


def test_joint_actions_open_a_door_again_from_the_start_and_from_a_state_on_the_way() -> None:
    """Bit for bit from the start; a state holds the leaf and the hand at its handle exactly."""
    env = gym.make(TASK, obs_mode="none", render_backend="none", control_mode="pd_joint_pos")
    base = env.unwrapped
    env.reset(seed=5)
    actions, angles, state, number = [], [], None, 0
    for action in opened_by_hand(base):
        _, reward, terminated, _, info = env.step(action)
        actions.append(action.copy())
        angles.append(float(base.get_info()["angle"]))
        if state is None and angles[-1] > 0.5:
            state, number = base.get_state_dict(), len(actions)
        if terminated.any():
            break
    assert bool(terminated) and bool(info["success"]) and not info["fail"] and float(reward) > 0.99
    assert bool(base.get_info()["success"]) and angles[-1] > 1.0 and state is not None
    part = state["hazard_ms"]["door_grip"]
    assert bool(part["holds"][0, 0]) and math.acos(1.0 - float(state["hazard_ms"]["openings"]["open"][0, 0])) > 0.5
    assert np.diff(angles).max() <= math.pi / 2 / 120 + 1e-6

    env.reset(seed=5)
    again = []
    for action in actions:
        env.step(action)
        again.append(float(base.get_info()["angle"]))
    assert again == angles and bool(base.get_info()["success"])

    env.reset(seed=5)
    assert not base.world.door_grip.state.holds.any() and float(base.get_info()["angle"]) == 0.0
    base.set_state_dict(state)
    assert float(base.get_info()["angle"]) == angles[number - 1] and bool(base.world.door_grip.state.holds[0, 0])
    rest = []
    for action in actions[number:]:
        env.step(action)
        rest.append(float(base.get_info()["angle"]))
    assert rest == pytest.approx(angles[number:], abs=0.01) and bool(base.get_info()["success"])
    wrong = {**part, "ahead": part["ahead"] + 5.0}
    with pytest.raises(ValueError, match=r"door_grip\.ahead must hold numbers from -4 to 4"):
        base.set_state_dict({**state, "hazard_ms": {**state["hazard_ms"], "door_grip": wrong}})
    env.close()


def test_no_other_task_has_handles_to_hold(practice: Any) -> None:
    assert not any(task_of(name, "paper").doors_by_hand for name in TASKS if name != TASK)
    env = gym.make("HazardPickUp-v1", obs_mode="none", render_backend="none")
    env.reset(seed=0)
    assert env.unwrapped.world.door_grip is None and "door_grip" not in env.unwrapped.get_state_dict()["hazard_ms"]
    env.close()
