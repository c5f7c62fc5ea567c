"""Kernels: laws written once, for one body, compiled for CPUs and GPUs by NVIDIA Warp, and the one way to start them.

A step of a hazard in torch is some 250 operations of 3 us each, however few bodies there are; as a kernel it is one of 10 us. What it
computes does not depend on how many environments there are. A kernel is compiled when it is first used: about 10 s for all, once per
machine (kept beside everything else of hazard_ms; WARP_CACHE_PATH moves it). Set `OPTIONS` in every module of kernels: products and sums
are not fused, so that all processors round alike.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from typing import Any

import torch
import warp as wp
from torch import Tensor

from hazard_ms.rendering import home

OPTIONS = {"enable_backward": False, "fuse_fp": False}

Argument = Tensor | float | int | bool


class Launches:
    """Launches of kernels, recorded: to repeat one takes 10 us, and 20 us more for each tensor that is another one; a first one 0.2 ms.

    A tensor's storage must stay: `tensor.data = ...` and `resize_` are not noticed, other tensors and numbers are.
    """

    def __init__(self) -> None:
        self._made: dict[wp.Kernel, tuple[list[Argument], Any]] = {}
        self._results: dict[wp.Kernel, tuple[Tensor, ...]] = {}

    def __reduce__(self) -> tuple[type[Launches], tuple[()]]:
        """A copy records anew."""
        return Launches, ()

    def results(self, kernel: wp.Kernel, *like: Tensor) -> tuple[Tensor, ...]:
        """Tensors like the given ones for a kernel to write, the same ones at every call: clone what is to outlast the next launch."""
        known = self._results.get(kernel, ())
        if [(t.shape, t.dtype, t.device) for t in known] != [(t.shape, t.dtype, t.device) for t in like]:
            known = self._results[kernel] = tuple(torch.empty_like(t, memory_format=torch.contiguous_format) for t in like)
        return known

    def run(self, kernel: wp.Kernel, size: tuple[int, ...], *arguments: Argument) -> None:
        """Run `kernel` for every index below `size`. `arguments`: in its order; for its arrays tensors of one device, used in place.

        The caller answers for the sizes of the tensors: a kernel does not check them.
        """
        if 0 in size:
            return
        if kernel not in self._made:
            self._made[kernel] = list(arguments), _recorded(kernel, size, arguments)
        known, launch = self._made[kernel]
        for k, (before, now) in enumerate(zip(known, arguments, strict=True)):
            if before is not now and (isinstance(now, Tensor) or before != now):
                launch.set_param_at_index(k, now)
                known[k] = now  # and keeps the tensor alive
        launch.set_dim(size)
        launch.launch(stream=_stream(launch.device))


def of_environments(points: Tensor, count: int) -> Tensor:
    """`points`, [E, P, 3] or [1, P, 3] for all, as kernels take them, [E, P, 3]. Raises ValueError for those of another number `count`."""
    if points.ndim != 3 or points.shape[0] not in (1, count) or points.shape[2] != 3:
        raise ValueError(f"points of shape {list(points.shape)} were given; [{count}, P, 3] is allowed")
    return points.expand(count, -1, -1).contiguous()


def _recorded(kernel: wp.Kernel, size: tuple[int, ...], arguments: tuple[Argument, ...]) -> Any:
    device = next(a.device for a in arguments if isinstance(a, Tensor))
    return wp.launch(kernel, dim=size, inputs=arguments, device=wp.device_from_torch(device), record_cmd=True)


def _stream(device: Any) -> Any:
    """That in which torch works on a GPU, so that kernels keep their place between its operations; None on a CPU."""
    return wp.stream_from_torch(torch.cuda.current_stream(device.ordinal)) if device.is_cuda else None


@contextlib.contextmanager
def _without_a_word() -> Iterator[None]:
    """Warp's library says on the standard error that there is no GPU; torch knows."""
    try:
        kept = os.dup(2)
    except OSError:  # a process without a standard error
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _cache() -> str:
    """Where compiled kernels are kept; a folder for this process alone if that cannot be written."""
    place = home() / "kernels"
    with contextlib.suppress(OSError):
        place.mkdir(parents=True, exist_ok=True)
    return str(place) if os.access(place, os.W_OK) else tempfile.mkdtemp(prefix="hazard_ms_kernels_")


def _begin() -> None:
    wp.config.log_level = wp.LOG_WARNING
    if "WARP_CACHE_PATH" not in os.environ:
        wp.config.kernel_cache_dir = _cache()
    with contextlib.nullcontext() if torch.cuda.is_available() else _without_a_word():
        wp.init()


_begin()
