"""Observation spaces with true bounds, taken from the table of observations, instead of -inf to inf."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from torch import Tensor

from hazard_ms.sensing.observation_table import ObservationTable


def bounded(observation: Any, table: ObservationTable, state: dict[str, Any]) -> gym.Space[Any]:
    """The space of one environment's part of `observation`: numpy arrays, [E, ...] each, or nested dicts of such.

    `state`: see `ObservationTable.leaf`. What the table does not know is unbounded.
    """

    def space(value: Any, path: tuple[str, ...]) -> gym.Space[Any]:
        if isinstance(value, dict):
            return gym.spaces.Dict([(key, space(inner, (*path, key))) for key, inner in value.items()])
        bounds = [row.bounds() for row in table.leaf(path, value, state)]
        low, high = bounds[0] if len(bounds) == 1 else (np.concatenate(side) for side in zip(*bounds, strict=True))
        return gym.spaces.Box(low, high, dtype=value.dtype.type)

    return space(observation, ())


def tensors(obs: dict[str, Any]) -> list[Tensor]:
    """All tensors of a nested observation, [E, N] each, in its own units [-], in their order."""
    every = obs.values()
    return [tensor for value in every for tensor in (tensors(value) if isinstance(value, dict) else [value])]
