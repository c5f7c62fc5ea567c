"""Memory that processes share: what is seen in each environment, and which environment each process is busy with."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

MEMORY = Path("/dev/shm")  # files that are never written to a disk, on Linux
NONE = -1  # no environment


class Board:
    """The numbers that all processes see: `seen`, [N, ...] or dicts of such, and `busy`, [P], environments or NONE."""

    def __init__(self, path: Path, space: gym.Space[Any], num_envs: int, processes: int) -> None:
        """Map the file `path`, which `make_file` made for the same numbers: observations of `space`, N and P."""
        raw = np.memmap(path, dtype=_layout(space, num_envs, processes), mode="r+", shape=(1,))
        self.busy: np.ndarray = raw["busy"][0]
        self.seen, self._space = _tree(space, raw["seen"][0]), space

    def write(self, number: int, obs: Any) -> None:
        """Note what is seen in the environment `number`."""
        _write(self.seen, number, obs)

    def read(self) -> Any:
        """A copy of what is seen in all environments, [N, ...]."""
        return _copied(self.seen)


def make_file(space: gym.Space[Any], num_envs: int, processes: int) -> Path:
    """A new file for a board; who made it deletes it once all have mapped it.

    Raises ValueError for observations that are not arrays of a fixed size or dicts of such.
    """
    size = _layout(space, num_envs, processes).itemsize
    roomy = MEMORY.is_dir() and shutil.disk_usage(MEMORY).free > 2 * size
    with tempfile.NamedTemporaryFile(prefix="hazard_ms-", dir=MEMORY if roomy else None, delete=False) as file:
        file.truncate(size)
    made = Path(file.name)
    Board(made, space, num_envs, processes).busy[:] = NONE
    return made


def _layout(space: gym.Space[Any], num_envs: int, processes: int) -> np.dtype:
    return np.dtype([("busy", np.int32, (processes,)), ("seen", _row(space), (num_envs,))], align=True)


def _row(space: gym.Space[Any]) -> np.dtype:
    """The type of one observation."""
    if isinstance(space, gym.spaces.Dict):
        return np.dtype([(name, _row(part)) for name, part in space.spaces.items()], align=True)
    if space.dtype is None or space.shape is None:
        raise ValueError(f"observations must be arrays of a fixed size, or dicts of such, got {space}")
    return np.dtype((space.dtype, space.shape))


def _tree(space: gym.Space[Any], rows: np.ndarray) -> Any:
    if isinstance(space, gym.spaces.Dict):
        return {name: _tree(part, rows[name]) for name, part in space.spaces.items()}
    return rows.view(np.ndarray)


def _write(seen: Any, number: int, obs: Any) -> None:
    if isinstance(seen, dict):
        for name, part in seen.items():
            _write(part, number, obs[name])
    else:
        seen[number] = obs


def _copied(seen: Any) -> Any:
    return {name: _copied(part) for name, part in seen.items()} if isinstance(seen, dict) else np.array(seen)
