"""Kernels: laws written once, for one body, compiled for CPUs and GPUs by NVIDIA Warp, and the one way to start them.

A step of a hazard in torch is some 250 operations of 3 us each, however few bodies there are; as a kernel it is one of 10 us. What it
computes does not depend on how many environments there are. A kernel is compiled when it is first used (seconds; kept in Warp's cache
of the user). Set `OPTIONS` in every module of kernels: products and sums are not fused, so that all processors round alike.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import torch
import warp as wp
from torch import Tensor

OPTIONS = {"enable_backward": False, "fuse_fp": False}

Argument = Tensor | float | int | bool


class Launches:
    """Launches of kernels, recorded: to repeat one takes 10 us, and 20 us more for each tensor that is another one; a first one 0.2 ms."""

    def __init__(self) -> None:
        self._made: dict[wp.Kernel, tuple[list[Argument], Any]] = {}
        self._results: dict[wp.Kernel, tuple[Tensor, ...]] = {}

    def results(self, kernel: wp.Kernel, *like: Tensor) -> tuple[Tensor, ...]:
        """Tensors like the given ones for a kernel to write, the same ones at every call: clone what is to outlast the next launch."""
        if kernel not in self._results:
            self._results[kernel] = tuple(torch.empty_like(t, memory_format=torch.contiguous_format) for t in like)
        return self._results[kernel]

    def run(self, kernel: wp.Kernel, size: tuple[int, ...], *arguments: Argument) -> None:
        """Run `kernel` for every index below `size`. `arguments`: in its order; for its arrays tensors of one device, used in place."""
        if kernel not in self._made:
            self._made[kernel] = list(arguments), _recorded(kernel, size, arguments)
        known, launch = self._made[kernel]
        for k, (before, now) in enumerate(zip(known, arguments, strict=True)):
            if before is not now and (isinstance(now, Tensor) or before != now):
                launch.set_param_at_index(k, now)
                known[k] = now  # and keeps the tensor alive
        launch.set_dim(size)
        launch.launch()


def _recorded(kernel: wp.Kernel, size: tuple[int, ...], arguments: tuple[Argument, ...]) -> Any:
    device = next(a.device for a in arguments if isinstance(a, Tensor))
    stream = wp.stream_from_torch(device) if device.type == "cuda" else None
    return wp.launch(kernel, dim=size, inputs=arguments, device=wp.device_from_torch(device), stream=stream, record_cmd=True)


@contextlib.contextmanager
def _without_a_word() -> Iterator[None]:
    """Warp's library says on the standard error that there is no GPU; torch knows."""
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _begin() -> None:
    wp.config.log_level = wp.LOG_WARNING
    with contextlib.nullcontext() if torch.cuda.is_available() else _without_a_word():
        wp.init()


_begin()
