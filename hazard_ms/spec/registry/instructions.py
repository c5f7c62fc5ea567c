"""One set of instructions of the processor for the packages that choose theirs when they are loaded.

Sums, products and functions such as exp are computed in other orders with wider registers, and then round differently.
What torch, numpy and OpenBLAS use with AVX2 is there on every processor that has AVX2, also on those with more.
"""

from __future__ import annotations

import os
from pathlib import Path

# Variables by which they are told; numpy names what it must not use
CHOICES = {
    "ATEN_CPU_CAPABILITY": "avx2",  # torch, read at its first operation
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",  # numpy, read when it is imported
    "OPENBLAS_CORETYPE": "Haswell",  # numpy and scipy, likewise
}


def agree(processor: Path = Path("/proc/cpuinfo")) -> None:
    """Choose AVX2 in this process, and in those that it starts, where the `processor` described in this file has it.

    What the user has chosen stays. What has been loaded before keeps its own choice.
    """
    if _has_avx2(processor):
        for name, value in CHOICES.items():
            os.environ.setdefault(name, value)


def _has_avx2(processor: Path) -> bool:
    try:
        with processor.open() as lines:
            flags: set[str] = next((set(line.split()) for line in lines if line.startswith("flags")), set())
    except OSError:  # no Linux
        return False
    return {"avx2", "fma"} <= flags
