"""Cameras of the robot under a perturbation: how far they are moved, and that all that looks through them knows it."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from hazard_ms.simulation.drawing import moved_cameras
from hazard_ms.spec.perturbation import MOST_LEVEL
from tests.worlds.perturbed import begun, made


def angle(a: np.ndarray, b: np.ndarray) -> float:
    """The angle between two rotations [rad], from matrices [3, 3]."""
    return math.acos(min(1.0, max(-1.0, (np.trace(a.T @ b) - 1.0) / 2.0)))


@pytest.mark.render
def test_a_camera_is_moved_as_far_as_its_level_says_and_the_observation_tells_where() -> None:
    seeds = (1, 2)
    plain = [params for _, params, _ in begun(None, seeds)]
    amounts = []
    for level in range(1, MOST_LEVEL + 1):
        for before, (_, after, _) in zip(plain, begun(f"camera:{level}", seeds), strict=True):
            a, b = before["cam2world_gl"][0], after["cam2world_gl"][0]
            zoom = after["intrinsic_cv"][0, 0, 0] / before["intrinsic_cv"][0, 0, 0]
            amounts.append((angle(a[:3, :3], b[:3, :3]), np.linalg.norm(a[:3, 3] - b[:3, 3]), abs(math.log(zoom))))
            assert after["intrinsic_cv"][0, 1, 1] == pytest.approx(after["intrinsic_cv"][0, 0, 0])
            ahead = -a[:3, 2] @ (b[:3, 3] - a[:3, 3])
            assert ahead > -1e-6  # never back into the head
    found = np.array(amounts).reshape(MOST_LEVEL, len(seeds), 3)
    assert (found[1:].min(1) > found[:-1].max(1)).all()  # every level is farther than the one below
    most = np.array([moved_cameras.ANGLES, moved_cameras.SHIFTS, moved_cameras.ZOOMS]).T[1:, None]
    assert (found <= most + 1e-3).all() and (found >= 0.75 * most - 1e-3).all()


@pytest.mark.render
def test_looks_and_observations_are_those_of_the_moved_camera() -> None:
    """Looks see labels with a camera of their own, which must be moved, too."""
    env = made("camera:3", obs_mode="rgb+depth+segmentation", deterministic=False)
    for seed in (3, 78):  # the same scene, which is not built anew
        obs, _ = env.reset(seed=seed)
        eye = env.unwrapped._sensors["head"].camera._render_cameras[0]
        assert obs["sensor_param"]["head"]["intrinsic_cv"][0, 0, 0] == pytest.approx(eye.fx)
        _, view = env.unwrapped.observer.look()
        glance = env.unwrapped.observer.glance()
        depth = obs["sensor_data"]["head"]["depth"][0, ..., 0].numpy().astype(np.float32) * 1e-3
        for seen in (view, glance):
            np.testing.assert_array_equal(seen.cam2world, obs["sensor_param"]["head"]["cam2world_gl"][0].numpy())
            assert np.median(np.abs(seen.depth - depth)) < 2e-3
    env.close()


@pytest.mark.render
def test_every_camera_of_the_robot_is_moved_in_its_own_way_and_noisy() -> None:
    places, pictures = [], []
    for perturb in ("", "camera:2", "camera:2,noise:2"):
        env = made(perturb, obs_mode="rgb", cameras=["wrist"])
        obs, _ = env.reset(seed=1)
        eyes = [env.unwrapped._sensors[name].camera._render_cameras[0] for name in ("head", "wrist")]
        places.append([eye.local_pose.to_transformation_matrix() for eye in eyes])
        env.unwrapped.observer.look()
        picture = env.unwrapped.observer.picture("wrist")
        assert torch.equal(picture, obs["sensor_data"]["wrist"]["rgb"][0])
        pictures.append(picture)
        env.close()
    head, wrist = (np.linalg.inv(before) @ after for before, after in zip(*places[:2], strict=True))
    assert angle(head[:3, :3], np.eye(3)) > 0.1 and angle(wrist[:3, :3], np.eye(3)) > 0.1
    assert angle(head[:3, :3], wrist[:3, :3]) > 0.01
    assert not torch.equal(pictures[0], pictures[1]) and not torch.equal(pictures[1], pictures[2])


def test_cameras_of_a_batch_on_a_gpu_are_not_moved() -> None:
    drawn = SimpleNamespace(scene=SimpleNamespace(gpu_sim_enabled=True), _render_cameras=[])
    moved_cameras.MovedCameras({"head": SimpleNamespace(camera=drawn)}, 0)
    with pytest.raises(ValueError, match="camera in perturb must be 0 where physics runs on a GPU, got 1"):
        moved_cameras.MovedCameras({"head": SimpleNamespace(camera=drawn)}, 1)
