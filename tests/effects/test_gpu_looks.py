"""Effects where a GPU simulates and draws a whole batch.

Every environment shows its own hazard, over labels that stay as without.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.cli.costs.effects import go_on
from results.gpu.needs import without_physx
from tests.worlds.watching import SEED, TASKS

pytestmark = pytest.mark.render

SIDE, LATER = 64, 600  # of a picture [pixels]; frames for which hazards go on before it
LABELS = ("segmentation", "depth")


@pytest.mark.parametrize("env_id", TASKS)
@pytest.mark.parametrize(
    ("count", "simulator"),
    [pytest.param(1, "cpu", marks=pytest.mark.long), pytest.param(4, "gpu", marks=pytest.mark.gpu)],
)
def test_a_batch_shows_its_hazards_over_the_same_labels(env_id: str, count: int, simulator: str) -> None:
    if simulator == "gpu" and without_physx():
        pytest.skip(without_physx())
    shown, plain = (pictures(env_id, effects, count, simulator) for effects in ("full", "off"))
    for name in LABELS:
        np.testing.assert_array_equal(shown[name], plain[name], err_msg=name)
    changed = (shown["rgb"] != plain["rgb"]).any(-1).mean((1, 2))
    assert changed.shape == (count,) and (changed > 0.02).all(), changed


@pytest.mark.gpu
@pytest.mark.parametrize("env_id", TASKS)
def test_an_environment_of_a_batch_looks_like_one_alone(env_id: str) -> None:
    if without_physx():
        pytest.skip(without_physx())
    batch, alone = (pictures(env_id, "full", count, "gpu")["rgb"][0].astype(float) for count in (4, 1))
    assert np.abs(batch - alone).mean() < 2.0


def pictures(env_id: str, effects: str, count: int, simulator: str) -> dict[str, np.ndarray]:
    """What the heads of `count` robots in one scene see after hazards have gone on, each by its own seed.

    Modality -> [E, H, W, C].
    """
    camera = {"width": SIDE, "height": SIDE}
    made = gym.make(
        env_id,
        num_envs=count,
        sim_backend=simulator,
        obs_mode="rgb+depth+segmentation",
        effects=effects,
        sensor_configs=camera,
    )
    env: Any = made.unwrapped
    env.reset(seed=[SEED + k for k in range(count)], options={"scene": env.choice.scenes[0]})
    go_on(env, LATER)
    head = env.get_obs(env.get_info())["sensor_data"][env.agent.head_camera]
    seen = {k: torch.as_tensor(head[k]).cpu().numpy() for k in ("rgb", *LABELS)}
    made.close()
    return seen
