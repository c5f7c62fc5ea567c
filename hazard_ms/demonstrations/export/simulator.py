"""Simulates recorded episodes again, for observations and states that were not recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.demonstrations.export.source import HIDDEN, STATE, Source
from hazard_ms.demonstrations.reading import Demonstration

Play = Callable[[Demonstration], tuple[Any, Any]]  # gives observations and states, as `_play` describes them
WITHOUT_PICTURES = (HIDDEN, STATE, "state_dict")  # modes that need no renderer


@contextmanager
def simulated(source: Source) -> Iterator[Play | None]:
    """A function that plays an episode again, while its environment is open; None where nothing has to be played."""
    if source.obs is None and not source.states:
        yield None
        return
    common, mode = source.common, source.obs or HIDDEN
    keywords = {**common.settings, **({"render_backend": "none"} if mode in WITHOUT_PICTURES else {})}
    env = gym.make(common.env_id, obs_mode=mode, control_mode=common.control_mode, **keywords)
    try:
        yield partial(_play, source, env)
    finally:
        env.close()


def _play(source: Source, env: gym.Env, one: Demonstration) -> tuple[Any, Any]:
    """Observations and states of the environment in T + 1 frames, each nested dicts of arrays [T + 1, ...].

    Raises ValueError for an episode that does not come out as it was recorded, bit by bit.
    """
    options, actions = source.options(one), one.frames["action"]
    obs, _ = env.reset(seed=options.seed, options=options.reset_options)
    base: Any = env.unwrapped
    rows = {int(frame): row for row, frame in enumerate(one.frames["state_frame"])}
    seen, states = [], []
    for frame in range(len(actions) + 1):
        if frame:
            obs = env.step(actions[frame - 1])[0]
        same = np.array_equal(_first(base.agent.robot.get_qpos()), one.frames["qpos"][frame])
        if not same or (
            frame in rows and not np.array_equal(_first(base.get_state()), one.frames["state"][rows[frame]])
        ):
            raise ValueError(
                f"{one.folder} must replay exactly as recorded, got another state in frame {frame}; use the versions "
                f"in its manifest, {one.result.versions}"
            )
        if source.obs is not None:
            seen.append(_first(obs))
        if source.states:
            states.append(_first(base.get_state_dict()))
    return _stacked(seen), _stacked(states)


def _first(tree: Any) -> Any:
    """The entries of the first environment in nested tensors [E, ...], as arrays."""
    if isinstance(tree, dict):
        return {key: _first(entry) for key, entry in tree.items()}
    return tree[0].cpu().numpy()


def _stacked(trees: Sequence[Any]) -> Any:
    """One nested dict of arrays [N, ...] from N nested dicts of arrays; empty for none."""
    if not trees:
        return {}
    if isinstance(trees[0], dict):
        return {key: _stacked([tree[key] for tree in trees]) for key in trees[0]}
    return np.stack(trees)
