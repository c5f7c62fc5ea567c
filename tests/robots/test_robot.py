"""The robots: their speed limits, collisions, cameras, kinematics, against the benchmark's rules and the simulator."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import sapien
import torch
from mani_skill.agents.robots.fetch import Fetch
from mani_skill.agents.robots.unitree_g1.g1_upper_body import UnitreeG1UpperBodyWithHeadCamera

from hazard_ms.spec.registry import ROBOTS
from hazard_ms.spec.registry.robots import robot_class, robot_uid
from tests.worlds.arena import Arena, Box

WALK = 1.0 / 62.0  # m per frame (docs/benchmark.md 1)
TURN = np.deg2rad(6.0)  # rad per frame (docs/benchmark.md 1)
# half the width of what meets furniture, at its narrowest [m] (Fetch's URDF: 0.264; G1's feet: 0.15)
BASE = {"fetch": 0.26, "g1": 0.19}
WIDEST = 0.32  # and at its widest, with the play of a contact [m]
NATIVE = {"fetch": Fetch, "g1": UnitreeG1UpperBodyWithHeadCamera}

BOXES = (
    Box("wall", (1.5, 0.0, 0.5), (0.2, 6.0, 1.0)),
    Box("table", (0.0, 2.0, 0.37), (1.0, 1.0, 0.74)),
    Box("bag", (0.0, -1.0, 0.1), (0.2, 0.2, 0.2), 0.3),
    Box("barrier", (0.0, -2.0, 0.5), (6.0, 0.1, 1.0)),
    Box("pen", (-0.6, 0.0, 0.004), (0.14, 0.008, 0.008), 0.01),
)


RATES = {"30Hz": (120, 30), "100Hz": (100, 100)}


@pytest.fixture(scope="module", params=[(robot, rate) for robot in ROBOTS for rate in RATES], ids="-".join)
def arena(request: pytest.FixtureRequest) -> Iterator[Arena]:
    robot, rate = request.param
    made = Arena(BOXES, RATES[rate], robot=robot)
    yield made
    made.close()


def drive(arena: Arena, frames: int, forward: float = 0.0, turn: float = 0.0) -> np.ndarray:
    """x, y, heading before and after every frame, [frames + 1, 3]."""
    track = [arena.agent.base()]
    for _ in range(frames):
        arena.step(arena.agent.action(forward, turn, arena.agent.tucked, True))
        track.append(arena.agent.base())
    return np.array(track)


def test_forward_speed_is_the_limit_per_frame_and_straight(arena: Arena) -> None:
    arena.restart(-1.0, 0.5)
    track = drive(arena, 40, forward=1.0)  # asks for more than is allowed
    steps = np.diff(track[:, 0])
    assert steps.max() <= WALK * 1.005
    np.testing.assert_allclose(steps[-10:], WALK, rtol=0.01)
    assert np.abs(track[:, 1] - 0.5).max() < 0.002 and np.abs(track[:, 2]).max() < 0.002
    rest = drive(arena, 12)
    assert np.abs(np.diff(rest[-3:, 0])).max() < 0.1 * WALK
    assert rest[-1, 0] - rest[0, 0] < 0.06


def test_turning_speed_is_the_limit_per_frame_on_the_spot(arena: Arena) -> None:
    arena.restart(-1.0, 0.5)
    track = drive(arena, 30, turn=1.0)
    np.testing.assert_allclose(np.diff(track[:, 2])[-10:], TURN, rtol=0.01)
    assert np.abs(track[:, :2] - (-1.0, 0.5)).max() < 0.01
    assert abs(drive(arena, 5)[-1, 2] - track[-1, 2]) < TURN


@pytest.mark.parametrize(("heading", "axis", "stop"), [(0.0, 0, 1.4), (np.pi / 2, 1, 1.5)])
def test_fixed_things_stop_it(arena: Arena, heading: float, axis: int, stop: float) -> None:
    arena.restart(heading=heading)
    track = drive(arena, 150, forward=WALK)
    assert stop - WIDEST < track[-1, axis] < stop - BASE[arena.robot]
    assert np.linalg.norm(np.diff(track[:, :2], axis=0), axis=1).max() < 1.05 * WALK
    spin = drive(arena, 60, forward=WALK, turn=TURN)
    assert np.linalg.norm(np.diff(spin[:, :2], axis=0), axis=1).max() < 2.0 * WALK


def test_it_pushes_light_things_without_flinging_them_through_walls(arena: Arena) -> None:
    arena.restart(heading=-np.pi / 2)
    drive(arena, 150, forward=WALK)
    bag = arena.world.position[0, arena.index("bag")]
    assert -1.95 < float(bag[1]) < -1.1
    assert arena.agent.base()[1] > -2.0 + BASE[arena.robot]


def test_it_does_not_climb_what_lies_on_the_floor(arena: Arena) -> None:
    arena.restart(heading=np.pi)
    before = lowest(arena)
    assert 0.005 < before < 0.03  # above a pen, which is 8 mm thick, or pushing it
    drive(arena, 80, forward=WALK)
    assert lowest(arena) == pytest.approx(before, abs=1e-3)
    assert abs(arena.agent.base()[0] + 80 * WALK) < 0.1


def hulls(arena: Arena) -> Iterator[tuple[str, np.ndarray]]:
    """Name of every link that collides, and points of its hull [m], [P, 3]."""
    for link in arena.agent.robot.links:
        for shape in link._objs[0].collision_shapes:
            pose = (link._objs[0].entity_pose * shape.local_pose).to_transformation_matrix()
            points = np.asarray(shape.vertices) * shape.scale if hasattr(shape, "vertices") else outline(shape)
            yield link.name, points @ pose[:3, :3].T + pose[:3, 3]


def outline(shape: Any) -> np.ndarray:
    """The rims of a cylinder, whose axis is x, or the corners of a box [m], [P, 3]."""
    if hasattr(shape, "half_size"):
        return np.array(list(itertools.product(*([-h, h] for h in shape.half_size))))
    around = np.linspace(0.0, 2.0 * np.pi, 32)
    rim = np.stack([np.ones_like(around), np.cos(around), np.sin(around)], axis=1) * (
        shape.half_length,
        shape.radius,
        shape.radius,
    )
    return np.vstack([rim, rim * (-1.0, 1.0, 1.0)])


def lowest(arena: Arena) -> float:
    """Height of the robot's lowest point, wheels left out: they touch nothing [m]."""
    return min(float(points[:, 2].min()) for name, points in hulls(arena) if "wheel" not in name)


def test_tucked_it_fits_into_its_radius_below_its_camera(arena: Arena) -> None:
    arena.restart()
    highest = 0.0
    for name, points in hulls(arena):
        assert np.hypot(points[:, 0], points[:, 1]).max() < arena.agent.build.radius, name
        if "head" not in name and "torso" not in name:
            highest = max(highest, float(points[:, 2].max()))
    assert highest < eyes(arena)[0][2] - 0.1


def eyes(arena: Arena) -> tuple[np.ndarray, np.ndarray]:
    """Where the head camera is [m] and the way it looks, [3] each."""
    (camera,) = arena.agent._sensor_configs
    pose = arena.agent.robot.links_map[camera.entity_uid].pose.sp * camera.pose.sp
    return pose.p, pose.to_transformation_matrix()[:3, 0]


def test_it_looks_ahead_and_down_from_its_head(arena: Arena) -> None:
    arena.restart(heading=0.0)
    place, way = eyes(arena)
    assert 1.0 < place[2] < 1.3 and np.hypot(place[0], place[1]) < arena.agent.build.radius
    assert way[0] > 0.8 and abs(way[1]) < 1e-3 and -np.sin(np.deg2rad(31.0)) < way[2] < -np.sin(np.deg2rad(15.0))


def test_arm_does_not_sag(arena: Arena) -> None:
    arena.restart(-1.0, 0.0)
    stretched = arena.agent.stretched[0]
    for _ in range(120):
        arena.step(arena.agent.action(0.0, 0.0, stretched, True))
    assert np.abs(arena.agent.arm() - stretched).max() < 0.02


def test_kinematics_agree_with_the_simulator_and_with_finite_differences(arena: Arena) -> None:
    arena.restart(-1.0, 0.3, 0.7)
    agent = arena.agent
    for posture in (agent.tucked, *agent.between, *agent.stretched):
        for _ in range(60):
            arena.step(agent.action(0.0, 0.0, posture, True))
        arm = agent.arm()
        assert np.abs(arm - posture).max() < 0.05
        hand, turn, jacobian = agent.kinematics(arm)
        np.testing.assert_allclose(hand, agent.hand(), atol=1e-4)
        np.testing.assert_allclose(turn, rotation_matrix(agent.gripper_pose()[1]), atol=1e-4)
        links = np.array([link.pose.p[0].numpy() for link in agent.robot.links])
        places = agent.arm_places(arm)
        assert (np.linalg.norm(places[:, None] - links, axis=-1).min(axis=1) < 1e-3).all() and len(places) > 2
        both = agent.arm_places(np.array([agent.tucked, arm]))
        np.testing.assert_array_equal(both, [agent.arm_places(agent.tucked), places])
        for j in range(len(arm)):
            step = np.zeros(len(arm))
            step[j] = 1e-3
            difference = (agent.kinematics(arm + step)[0] - agent.kinematics(arm - step)[0]) / 2e-3
            np.testing.assert_allclose(jacobian[:3, j], difference, atol=2e-3)


def rotation_matrix(quaternion: torch.Tensor) -> np.ndarray:
    """Of the first of `quaternion`, w x y z."""
    return sapien.Pose(q=quaternion[0].numpy()).to_transformation_matrix()[:3, :3]


def test_every_control_mode_of_the_native_robot_is_there(arena: Arena) -> None:
    native = set(NATIVE[arena.robot]._controller_configs.fget(arena.agent))
    native.discard("pd_ee_delta_pose_align")  # ManiSkill's own controller of it cannot take a step
    assert native == set(arena.agent.supported_control_modes) and len(native) == {"fetch": 11, "g1": 2}[arena.robot]
    assert np.isfinite(arena.agent.single_action_space.low).all()


def test_head_camera_sees_120_degrees(arena: Arena) -> None:
    (camera,) = arena.agent._sensor_configs
    assert camera.uid == arena.agent.head_camera == "head"
    assert camera.fov == pytest.approx(np.deg2rad(120.0))


def test_it_is_kept_out_of_forbidden_floor_and_may_leave_it(arena: Arena) -> None:
    arena.restart()
    stopped = []

    def forbidden(points: torch.Tensor) -> torch.Tensor:
        return points[..., 0] > 0.7

    arena.base._before_control_step = lambda: stopped.append(bool(arena.agent.keep_out(forbidden)[0]))
    try:
        there = drive(arena, 60, forward=WALK)
        assert 0.2 < there[-1, 0] < 0.7 - arena.agent.build.radius + 0.01 and stopped[-1] and not stopped[0]
        arena.agent.place(torch.tensor([0]), torch.tensor([[0.6, 0.0]]), torch.tensor([0.0]))
        assert drive(arena, 20, forward=-WALK)[-1, 0] < 0.4
    finally:
        del arena.base._before_control_step


def test_actions_of_skills_need_their_control_mode(arena: Arena) -> None:
    arena.agent.set_control_mode("pd_joint_delta_pos")
    try:
        with pytest.raises(ValueError, match="pd_joint_pos"):
            arena.agent.action(0.0, 0.0, arena.agent.tucked, True)
    finally:
        arena.agent.set_control_mode()


def test_robots_are_found_by_their_name() -> None:
    assert {robot_uid(name) for name in ("fetch", "g1")} == {robot_class(name).uid for name in ROBOTS}
    with pytest.raises(ValueError, match="one of fetch, g1, got 'spot'"):
        robot_uid("spot")


def test_hazards_are_told_each_robots_own_weight() -> None:
    """Published: Fetch 113.3 kg, base 0.508 m wide; G1 about 35 kg with its battery, 0.45 m wide with its arms."""
    builds = {name: robot_class(name).build for name in ROBOTS}
    assert builds["fetch"].mass == pytest.approx(113.3, rel=0.02) and builds["g1"].mass == pytest.approx(35.0, rel=0.02)
    assert builds["fetch"].width == pytest.approx(0.508, rel=0.01) and 0.1 < builds["g1"].width < 0.45
    slides = {n: float(np.sqrt(2 * b.friction * b.mass * 9.81 / (1.225 * b.drag_area))) for n, b in builds.items()}
    assert slides["fetch"] == pytest.approx(39.7, abs=0.1)  # docs/physics.md 3.3
    assert slides["g1"] < slides["fetch"]


@pytest.mark.parametrize("name", ["mass", "width", "drag_area", "friction"])
@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf")])
def test_a_build_without_weight_is_refused(name: str, bad: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be a positive number, got {bad}"):
        dataclasses.replace(robot_class("fetch").build, **{name: bad})
