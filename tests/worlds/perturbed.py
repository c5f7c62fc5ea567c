"""Environments with small pictures under a perturbation."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np

import hazard_ms  # noqa: F401 registers the environments

SIDE = 64  # of pictures [pixels]


def made(perturb: str | None, task: str = "HazardFire-v1", **keywords: Any) -> Any:
    """An environment with small pictures; None: without the keyword."""
    asked = {} if perturb is None else {"perturb": perturb}
    return gym.make(task, sensor_configs={"width": SIDE, "height": SIDE}, effects="off", **asked, **keywords)


def begun(perturb: str | None, seeds: tuple[int, ...], **keywords: Any) -> list[tuple[np.ndarray, Any, Any]]:
    """A picture, the camera's parameters and the light of the first frame of each of the `seeds`, in one scene."""
    env, found = made(perturb, obs_mode="rgb+depth+segmentation", **keywords), []
    for seed in seeds:
        obs, _ = env.reset(seed=seed, options={"scene": "kitchen_a/03"})
        params = {k: v.numpy().copy() for k, v in obs["sensor_param"]["head"].items()}
        mood, _ = env.unwrapped.lights._lights[0].shown
        found.append((obs["sensor_data"]["head"]["rgb"].numpy().copy(), params, mood))
    env.close()
    return found
