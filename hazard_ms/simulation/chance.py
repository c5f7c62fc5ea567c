"""Counter-based random numbers: a draw is a function of (seed, frame, stream, index) and of nothing else.

An episode therefore unfolds the same way alone, among 4,096 others, and after a restore: there is no generator to
advance or to save. Integers are mixed by the finaliser `lowbias32` of C. Wellons' hash-prospector (bias 0.17), applied
to each word of the key in turn.
"""

from __future__ import annotations

import functools
import math
import zlib

import torch
from torch import Tensor

from hazard_ms.spec import rounding

_WORD = 0xFFFFFFFF


def _mix(x: Tensor) -> Tensor:
    x = ((x ^ (x >> 16)) * 0x7FEB352D) & _WORD
    x = ((x ^ (x >> 15)) * 0x846CA68B) & _WORD
    return x ^ (x >> 16)


@functools.lru_cache(maxsize=256)
def _mixed_index(count: int, device: torch.device) -> Tensor:
    """The mixed words of the indices 0 to count - 1: the same at every draw, so made once per size."""
    return _mix(torch.arange(1, count + 1, device=device))


class Chance:
    """Random numbers of E environments. All of its state is `seed` [E] and `frame` [E], both int64.

    On a GPU the host counts frames, too, so that it need not wait to know what is due.
    """

    def __init__(self, num_envs: int, device: torch.device | str = "cpu") -> None:
        self.seed = torch.zeros(num_envs, dtype=torch.int64, device=device)
        self.frame = torch.zeros(num_envs, dtype=torch.int64, device=device)
        self._on_host = None if self.frame.device.type == "cpu" else torch.zeros(num_envs, dtype=torch.int64)

    def restart(self, rows: Tensor, seeds: Tensor, frames: Tensor | int = 0) -> None:
        """Begin episodes with `seeds` [R] in the R environments `rows` [R], or go on with them after `frames` [R]."""
        self.seed[rows] = seeds.to(self.seed)
        self.frame[rows] = frames
        if self._on_host is not None:
            self._on_host[rows.cpu()] = frames.cpu() if isinstance(frames, Tensor) else frames

    def tick(self) -> None:
        """Count one frame, after which all draws are new."""
        self.frame += 1
        if self._on_host is not None:
            self._on_host += 1

    def due(self, every: int) -> Tensor | None:
        """The environments in which it is time for what happens `every` so many frames, bool [E]; None for none."""
        counted = self.frame if self._on_host is None else self._on_host
        now = counted % every == 0
        if not bool(now.any()):
            return None
        return now if self._on_host is None else self.frame % every == 0

    def uniform(self, stream: str, *shape: int) -> Tensor:
        """Uniform random numbers in (0, 1), [E, *shape], float32. Two streams of different names are independent."""
        word = zlib.crc32(stream.encode())  # stable across processes, unlike hash()
        key = _mix((self.seed & _WORD) ^ word)
        key = _mix(key ^ ((self.seed >> 32) & _WORD))
        key = _mix(key ^ (self.frame & _WORD))
        bits = _mix(key[:, None] ^ _mixed_index(math.prod(shape), self.seed.device)[None, :])
        # 23 bits and a half: the most that float32 holds without rounding to 1
        return (((bits >> 9).float() + 0.5) / 2.0**23).reshape(-1, *shape)

    def normal(self, stream: str, *shape: int) -> Tensor:
        """Standard normal random numbers, [E, *shape], float32 (Box-Muller)."""
        pair = self.uniform(stream, *shape, 2)
        return rounding.sqrt(-2.0 * rounding.log(pair[..., 0])) * rounding.cos(2.0 * math.pi * pair[..., 1])
