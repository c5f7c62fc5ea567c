"""A Minari dataset: observations, actions and rewards of the environment, frame by frame."""

from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.demonstrations.export.simulator import simulated
from hazard_ms.demonstrations.export.source import STATE, Source, needed
from hazard_ms.demonstrations.layout import plain

ROOT = "MINARI_DATASETS_PATH"  # environment variable that names the folder in which Minari keeps its datasets
NUMPY = "hazard_ms:NumpyEnv"  # Minari's environments are not batched


def write(source: Source, folder: Path) -> str:
    """Write the dataset into `folder`, as the one in which Minari keeps datasets. Returns the dataset's id.

    Raises ValueError where minari is missing, and for recordings without observations unless they are asked for.
    """
    minari = needed("minari", "minari")
    import gymnasium as gym

    common = source.common
    if source.obs is None and not common.observed:
        raise ValueError(
            f"obs must be {STATE} in the recording, got {common.obs}; "
            f"add --obs {STATE}, which simulates the episodes again"
        )
    name = f"hazard/{plain(common.env_id.split('-')[0].removeprefix('Hazard')).lower()}/{plain(common.agent)}-v0"
    env = gym.make(_spec(source))
    try:
        with _kept_in(folder), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # advice to fill in what a dataset that is not shared lacks
            minari.create_dataset_from_buffers(
                name,
                _buffers(source, needed("minari.data_collector", "minari").EpisodeBuffer),
                env=env,
                algorithm_name=common.agent,
                description=source.action_text,
            )
    finally:
        env.close()
    return name


def _spec(source: Source) -> Any:
    """The environment's spec, which `recover_environment` of the dataset makes again."""
    import gymnasium as gym
    from gymnasium.envs.registration import WrapperSpec

    common = source.common
    spec = gym.spec(common.env_id)
    modes = {"obs_mode": source.obs or STATE, "control_mode": common.control_mode, "reward_mode": common.reward_mode}
    return dataclasses.replace(
        spec,
        kwargs={**spec.kwargs, **common.settings, **modes},
        additional_wrappers=(*spec.additional_wrappers, WrapperSpec("NumpyEnv", NUMPY, {})),
    )


def _buffers(source: Source, buffer: Any) -> Iterator[Any]:
    """The episodes as Minari takes them; T + 1 observations and infos, T of all else."""
    with simulated(source) as play:
        for one in source:
            frames, options = one.frames, source.options(one)
            yield buffer(
                seed=options.seed,
                options=options.reset_options,
                observations=play(one)[0] if play else frames["obs"],
                actions=frames["action"],
                rewards=frames["reward"],
                terminations=frames["terminated"],
                truncations=frames["truncated"],
                infos={"success": np.concatenate([[False], frames["success"]])},
            )


@contextmanager
def _kept_in(folder: Path) -> Iterator[None]:
    """Let Minari keep its datasets in `folder` meanwhile."""
    before = os.environ.get(ROOT)
    os.environ[ROOT] = str(folder)
    try:
        yield
    finally:
        if before is None:
            del os.environ[ROOT]
        else:
            os.environ[ROOT] = before
