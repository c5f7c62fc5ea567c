"""The G1 alone has legs that crouch, a body that bends, two hands, and a description derived from the installed one."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import gymnasium as gym
import numpy as np
import pytest
import sapien
import torch
from mani_skill.agents.robots.unitree_g1.g1_upper_body import UnitreeG1UpperBodyWithHeadCamera

import hazard_ms  # noqa: F401
from hazard_ms.robots.g1_description import LEG_JOINTS, UnknownDescriptionError, g1_description
from hazard_ms.skills.motor.arm import reach_for
from hazard_ms.skills.motor.grasping import pick_up
from tests.worlds.arena import Arena, Box
from tests.worlds.episodes import episode

INSTALLED = Path(UnitreeG1UpperBodyWithHeadCamera.urdf_path)
HIPS = 0.652  # height of the hips' axis when it stands [m] (Unitree's data sheet: leg of 0.6 m, and the foot)
RIGHT, LEFT = 0, 1
BOXES = (
    Box("cup", (0.5, -0.25, 0.05), (0.08, 0.08, 0.1), 0.2),
    Box("can", (0.5, 0.25, 0.05), (0.08, 0.08, 0.1), 0.2),
)


@pytest.fixture(scope="module")
def arena() -> Iterator[Arena]:
    made = Arena(BOXES, robot="g1")
    yield made
    made.close()


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make("HazardFire-v1", robot_uids="g1", obs_mode="state", render_backend="none")
    yield made
    made.close()


def link(arena: Arena, name: str) -> np.ndarray:
    """Where a link is [m], [3]."""
    return arena.agent.robot.links_map[name].pose.p[0].numpy()


@pytest.mark.parametrize(("crouch", "bend"), [(0.5, 0.0), (1.0, 0.5), (1.7, 1.1), (0.0, 1.1)])
def test_feet_stay_on_their_place_and_joints_within_their_limits(arena: Arena, crouch: float, bend: float) -> None:
    """The limits are those of the installed robot; a crouch of 1 is 0.2 m, by the docstring 0.33 m down at most."""
    arena.restart()
    feet = [link(arena, f"{side}_ankle_roll_link") for side in ("left", "right")]
    assert link(arena, "hips")[2] == pytest.approx(HIPS, abs=0.005)
    arm = arena.agent.tucked.copy()
    arm[1:3] = crouch, bend
    for _ in range(60):
        arena.step(arena.stage.act(arm=arm))
    x, y, _ = arena.agent.base()
    assert np.hypot(x, y) < 0.01
    for side, before in zip(("left", "right"), feet, strict=True):
        np.testing.assert_allclose(link(arena, f"{side}_ankle_roll_link"), before + (x, y, 0.0), atol=0.005)
        turn = arena.agent.robot.links_map[f"{side}_ankle_roll_link"].pose.sp.to_transformation_matrix()[:3, :3]
        np.testing.assert_allclose(turn, np.eye(3), atol=0.05)  # flat
    assert link(arena, "hips")[2] == pytest.approx(HIPS - 0.96 * 0.2 * crouch, abs=0.01)
    joints = {j.name: j for j in arena.agent.robot.active_joints}
    limits = {j.get("name"): j.find("limit") for j in ElementTree.parse(INSTALLED).getroot().findall("joint")}
    for name in LEG_JOINTS:
        least, most = (float(limits[name].get(end)) for end in ("lower", "upper"))
        angle = float(joints[name].qpos[0]) - (bend if "hip" in name else 0.0)  # the hips carry the bend, too
        assert least <= angle <= most, name


@pytest.mark.parametrize(("y", "hand"), [(-0.25, RIGHT), (0.25, LEFT)])
def test_it_reaches_with_the_hand_on_the_thing_s_side(arena: Arena, y: float, hand: int) -> None:
    arena.restart()
    assert arena.run(reach_for(arena.stage, (0.4, y, 0.7))).ok
    tcp = link(arena, "right_tcp_link" if hand == RIGHT else "left_tcp_link")
    np.testing.assert_allclose(tcp, (0.4, y, 0.7), atol=0.05)
    np.testing.assert_allclose(tcp, arena.agent.hand(), atol=1e-6)


@pytest.mark.parametrize("name", ["cup", "can"])
def test_either_hand_picks_up(arena: Arena, name: str) -> None:
    arena.restart()
    index = arena.index(name)
    arena.agent.use_hand(arena.stage.position(index), attempt=1)  # a pick-up chooses for itself
    assert arena.run(pick_up(arena.stage, index)).ok
    distances = [
        np.linalg.norm(link(arena, f"{side}_tcp_link") - arena.base.actors[name].pose.p[0].numpy())
        for side in ("right", "left")
    ]
    assert min(distances) < 0.15 and max(distances) > 0.2


def test_the_other_hand_is_for_the_second_attempt_and_a_hand_that_holds_stays(arena: Arena) -> None:
    arena.restart()
    agent, left = arena.agent, np.array([0.5, 0.25, 0.1])
    for attempt, hand in ((0, "left"), (1, "right"), (2, "left")):
        agent.use_hand(left, attempt)
        np.testing.assert_allclose(agent.hand(), link(arena, f"{hand}_tcp_link"), atol=1e-6)
    arena.step(agent.action(0.0, 0.0, agent.tucked, False))
    agent.use_hand(left, 1)
    np.testing.assert_allclose(agent.hand(), link(arena, "left_tcp_link"), atol=1e-6)


def test_of_two_hands_that_shut_the_first_is_in_use_until_it_opens(arena: Arena) -> None:
    """Commands of right and left, and which hand then counts, and whether it is shut.

    A hand opens for a frame before the other counts.
    """
    arena.restart()
    start, end = arena.agent.controller.action_mapping["hands"]
    rest = arena.agent.action(0.0, 0.0, arena.agent.tucked, True)
    for right, left, hand, shut in (
        (1, 1, "right", False),
        (1, -1, "left", True),
        (-1, -1, "left", True),
        (-1, 1, "left", False),
        (-1, 1, "right", True),
        (1, 1, "right", False),
    ):
        rest[start:end] = right, left
        arena.step(rest)
        assert bool(arena.agent.grip_closed()[0]) == shut
        np.testing.assert_allclose(arena.agent.hand(), link(arena, f"{hand}_tcp_link"), atol=1e-6)


def test_fingers_shut_around_the_middle_of_the_hand(arena: Arena) -> None:
    arena.restart()
    agent, tips = arena.agent, [f"right_{n}_link" for n in ("two", "four", "six")]
    apart = [np.linalg.norm(link(arena, tip) - agent.hand()) for tip in tips]
    for _ in range(20):
        arena.step(agent.action(0.0, 0.0, agent.tucked, False))
    shut = [np.linalg.norm(link(arena, tip) - agent.hand()) for tip in tips]
    assert np.mean(shut) < np.mean(apart) and max(shut) < 0.08


def test_a_saved_state_knows_the_hands(env: Any) -> None:
    env.reset(seed=0)
    agent = env.unwrapped.agent
    agent.use_hand(np.array([*(np.array(agent.base()[:2]) + (-np.sin(agent.base()[2]), np.cos(agent.base()[2]))), 0.5]))
    for _ in range(10):
        env.step(agent.action(0.0, 0.0, agent.tucked, False))
    saved, hand = env.unwrapped.get_state_dict(), agent.hand()
    env.reset(seed=0)
    assert not bool(env.unwrapped.agent.grip_closed()[0]) and np.linalg.norm(env.unwrapped.agent.hand() - hand) > 0.2
    env.unwrapped.set_state_dict(saved)
    assert bool(env.unwrapped.agent.grip_closed()[0])
    np.testing.assert_allclose(env.unwrapped.agent.hand(), hand, atol=1e-3)


@pytest.mark.parametrize("mode", ["pd_joint_pos", "pd_joint_delta_pos"])
def test_random_actions_leave_it_finite_and_upright(mode: str) -> None:
    made = gym.make(
        "HazardFire-v1",
        robot_uids="g1",
        obs_mode="state",
        render_backend="none",
        control_mode=mode,
        reward_mode="none",
        deterministic=False,
    )
    base, rng = made.unwrapped, np.random.default_rng(0)
    try:
        for seed in range(5):
            made.reset(seed=seed)
            low, high = base.single_action_space.low, base.single_action_space.high
            for _ in range(60):
                _, _, _, truncated, info = made.step(rng.uniform(low, high).astype(np.float32))
                assert not bool(truncated.any()) and not bool(info["sim_error"][0])
            qpos = base.agent.robot.get_qpos()
            # no joint's limit is higher
            assert bool(torch.isfinite(qpos).all()) and float(qpos[0, 3:].abs().max()) < 3.6
            up = base.agent.base_link.pose.sp.to_transformation_matrix()[:3, 2]
            np.testing.assert_allclose(up, (0.0, 0.0, 1.0), atol=1e-4)
            assert abs(float(base.agent.base_link.pose.p[0, 2])) < 1e-4
            width, depth = base.world.room[0].tolist()
            x, y, _ = base.agent.base()
            assert 0.0 < x < width and 0.0 < y < depth
    finally:
        made.close()


@pytest.mark.long
def test_the_same_seed_gives_the_same_bits(env: Any) -> None:
    """After another episode, and in a new process."""
    command = [sys.executable, "-m", "tests.worlds.episodes", "--robot", "g1", "--steps", "60", "3"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2])
    episode(env, 4, 10)
    first = episode(env, 3, 60)
    out, _ = process.communicate(timeout=280)
    assert f'"3": "{first}"' in out


def test_the_description_is_derived_and_the_installed_one_stays_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path))
    before = INSTALLED.read_bytes()
    made = g1_description.__wrapped__(INSTALLED)
    assert made.is_relative_to(tmp_path) and INSTALLED.read_bytes() == before
    assert g1_description.__wrapped__(INSTALLED) == made
    bare = ElementTree.parse(g1_description.__wrapped__(INSTALLED, bare=True)).getroot()
    assert not list(bare.iter("visual")) and len(list(bare.iter("collision"))) == len(
        list(ElementTree.parse(made).getroot().iter("collision"))
    )
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    robot = loader.load(str(g1_description.__wrapped__(INSTALLED, bare=True)))
    # of the installed links, and what joins them
    assert sum(link.mass for link in robot.links) == pytest.approx(33.0, abs=1.5)


def test_an_unknown_description_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "g1.urdf"
    other.write_text(INSTALLED.read_text().replace("left_knee_joint", "left_knee"))
    with pytest.raises(UnknownDescriptionError, match="left_knee_joint"):
        g1_description(other)
