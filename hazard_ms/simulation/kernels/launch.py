"""The one way to start Warp kernels on torch tensors.

A step of a hazard in torch is some 250 operations of 3 us each, however few bodies there are; as a kernel it is one of
10 us. A result does not depend on the number of environments. A kernel is compiled when it is first used: about 10 s
for all, once per machine (kept in the cache folder of hazard_ms; WARP_CACHE_PATH moves it). Every module of kernels
sets `OPTIONS`: products and sums are not fused, and all processors with AVX2 run the same machine code, so that they
round alike.
"""

from __future__ import annotations

import contextlib
import ctypes
import operator
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import torch
import warp as wp
from torch import Tensor

from hazard_ms.simulation.kernels.compiled import cache, verified, writable
from hazard_ms.simulation.kernels.structs import Argument, Filled, alike, another
from hazard_ms.spec.progress import slow

# Warp's own flags of the compiler (warp.config.cpu_compiler_flags), but for a processor that is every one with AVX2
_WITH_AVX2 = (
    "-target-cpu x86-64-v3 -mllvm=-inline-threshold=9000 -mllvm=-inline-cold-callsite-threshold=3000"
    " -mllvm=-slp-recursion-max-depth=4"
)
# Options of Warp that every module of kernels sets
OPTIONS = {
    "enable_backward": False,
    "fuse_fp": False,
    "cpu_compiler_flags": _WITH_AVX2 if torch.backends.cpu.get_cpu_capability().startswith("AVX") else None,
}

CPU_BLOCK, GPU_BLOCK = 1, 256  # threads of a block: Warp's own choices, which name the folder of a compiled module

_loaded: set[tuple[wp.Kernel, str]] = set()  # kernels that have been launched on a device


class Launches:
    """Recorded launches of kernels.

    Repeating a launch takes 5 us, 5 us more for each tensor that is another one than the last time, also in a struct,
    and 20 us more for each one of another shape; a first launch takes 0.2 ms. A tensor must keep its storage: other
    tensors and numbers are noticed, but not `tensor.data = ...` and `resize_`.
    """

    def __init__(self) -> None:
        self._made: dict[wp.Kernel, _Recorded] = {}
        self._results: dict[wp.Kernel, tuple[tuple[Tensor, ...], tuple[Tensor, ...]]] = {}  # by what they are like
        self._once: dict[tuple[wp.Kernel, torch.Size, torch.device], tuple[Tensor, ...]] = {}
        self._structs: dict[wp.Struct, Filled] = {}

    def __reduce__(self) -> tuple[type[Launches], tuple[()]]:
        """A copy starts with nothing recorded."""
        return Launches, ()

    def results(self, kernel: wp.Kernel, *like: Tensor) -> tuple[Tensor, ...]:
        """Tensors for the results of `kernel`, each with the shape and number type of one in `like`, [...].

        They are the same ones at every call: clone what has to outlast the next launch.
        """
        known, made = self._results.get(kernel, ((), ()))
        if len(known) == len(like) and all(map(operator.is_, known, like)):
            return made
        if [(t.shape, t.dtype, t.device) for t in made] != [(t.shape, t.dtype, t.device) for t in like]:
            made = tuple(torch.empty_like(t, memory_format=torch.contiguous_format) for t in like)
        self._results[kernel] = like, made
        return made

    def once(self, kernel: wp.Kernel, like: Tensor, make: Callable[[], tuple[Tensor, ...]]) -> tuple[Tensor, ...]:
        """Tensors for the results of `kernel`, [...] each in its own unit [-], which `make` makes at the first call.

        They are the same ones at every call with the shape and the device of `like`, [...].
        """
        key = (kernel, like.shape, like.device)
        known = self._once.get(key)
        if known is None:
            known = self._once[key] = make()
        return known

    def struct(self, kind: wp.Struct, source: object) -> Any:
        """The struct `kind`, filled with the attributes of `source` that have the names of its fields.

        Arrays share the tensors' memory. It holds until the next call for its `kind`: then it is pointed at tensors
        that took the place of others, or filled anew for other numbers and shapes. So give each kind one source.
        """
        filled = self._structs.get(kind)
        if filled is None:
            filled = self._structs[kind] = Filled(kind)
        return filled.by(source)

    def run(self, kernel: wp.Kernel, size: tuple[int, ...], *arguments: Argument) -> None:
        """Run `kernel` for every index below `size`.

        `arguments` are in the kernel's order; arrays are tensors of one device, used in place. The caller is
        responsible for the sizes of the tensors: a kernel does not check them.
        """
        if 0 in size:
            return
        made = self._made.get(kernel)
        if made is None:
            made = self._made[kernel] = _Recorded(kernel, size, arguments)
        made.launch(size, arguments)


class _Recorded:
    """A launch that is ready to be repeated, with the arguments of the last time, which are kept alive.

    On a CPU the compiled function is called with a structure of arguments that stays from launch to launch; Warp itself
    makes bounds and structure anew each time, which takes several times as long as most of our kernels.
    """

    def __init__(self, kernel: wp.Kernel, size: tuple[int, ...], arguments: tuple[Argument, ...]) -> None:
        self._known, self._size = arguments, size
        self._launch = _recorded(kernel, size, arguments)
        self._names = [f"_{k}" for k in range(len(arguments))]
        fields = [(name, type(value)) for name, value in zip(self._names, self._launch.params[1:], strict=True)]
        self._packed = type("Arguments", (ctypes.Structure,), {"_fields_": fields})(*self._launch.params[1:])
        self._call = self._launch.hooks.forward if self._launch.device.is_cpu else None
        self._given = ctypes.byref(self._launch.bounds), ctypes.byref(self._packed)

    def launch(self, size: tuple[int, ...], arguments: tuple[Argument, ...]) -> None:
        """Launch again with `arguments`, for every index below `size`."""
        if not all(map(operator.is_, self._known, arguments)):
            self._change(arguments)
        if size != self._size:
            self._launch.set_dim(size)
            self._size, self._given = size, (ctypes.byref(self._launch.bounds), ctypes.byref(self._packed))
        if self._call is not None:
            self._call(*self._given)
        else:
            self._launch.launch(stream=_stream(self._launch.device))

    def _change(self, arguments: tuple[Argument, ...]) -> None:
        """Take other `arguments` than those of the last time."""
        params = self._launch.params
        for k, (before, now) in enumerate(zip(self._known, arguments, strict=True)):
            if before is now or not another(before, now):
                continue
            if alike(before, now):
                params[k + 1].data = now.data_ptr()
            else:
                self._launch.set_param_at_index(k, now)
            setattr(self._packed, self._names[k], params[k + 1])
        self._known = arguments


def of_environments(points: Tensor, count: int) -> Tensor:
    """Points [m], [E, P, 3], as kernels take them, from `points` [m], [E, P, 3], or [1, P, 3] for all environments.

    `count` is E. Raises ValueError for points of another number of environments.
    """
    if points.ndim != 3 or points.shape[0] not in (1, count) or points.shape[2] != 3:
        raise ValueError(f"points must have the shape [{count}, P, 3] or [1, P, 3], got {list(points.shape)}")
    return points.expand(count, -1, -1).contiguous()


def _recorded(kernel: wp.Kernel, size: tuple[int, ...], arguments: tuple[Argument, ...]) -> Any:
    device = _device(arguments)
    block = CPU_BLOCK if device.is_cpu else GPU_BLOCK
    with contextlib.ExitStack() as first:
        if (kernel, device.alias) not in _loaded:
            first.enter_context(slow("compiling kernels (once, about 10 s)"))
            first.enter_context(writable(wp.config.kernel_cache_dir))
            first.enter_context(verified(Path(wp.config.kernel_cache_dir) / kernel.module.get_module_identifier(block)))
        launch = wp.launch(kernel, dim=size, inputs=arguments, device=device, block_dim=block, record_cmd=True)
    _loaded.add((kernel, device.alias))
    return launch


def _device(arguments: tuple[Argument, ...]) -> Any:
    """The device of the first array among `arguments`, also inside structs."""
    for a in arguments:
        if isinstance(a, Tensor):
            return wp.device_from_torch(a.device)
        for value in getattr(a, "__dict__", {}).values():
            if isinstance(value, Tensor):
                return wp.device_from_torch(value.device)
            if isinstance(value, wp.array):
                return value.device
    raise ValueError("arguments must hold at least one tensor, got none")


def _stream(device: Any) -> Any:
    """The stream in which torch works on a GPU, so that kernels keep their place between its operations."""
    return wp.stream_from_torch(torch.cuda.current_stream(device.ordinal)) if device.is_cuda else None


@contextlib.contextmanager
def _without_a_word() -> Iterator[None]:
    """Suppress what Warp's library writes to the standard error on a machine without a GPU."""
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


def _begin() -> None:
    wp.config.log_level = wp.LOG_WARNING
    if "WARP_CACHE_PATH" not in os.environ:
        wp.config.kernel_cache_dir = cache()
    folder = wp.config.kernel_cache_dir or os.environ.get("WARP_CACHE_PATH", "")
    with writable(folder), contextlib.nullcontext() if torch.cuda.is_available() else _without_a_word():
        wp.init()


_begin()
