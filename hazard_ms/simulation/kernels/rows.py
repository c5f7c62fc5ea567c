"""Numbers of arrays in memory, [E, N] float, whose rows have no gaps, as those of states (Warp).

Warp's own indexing multiplies both indices by strides that it looks up. Kernels that read many numbers of each cell
take a third less time with these.
"""

from __future__ import annotations

import warp as wp


@wp.func_native("return ((const float*)((const char*)array.data + (long long)row * array.strides[0]))[index];")
def at(array: wp.array2d(dtype=float), row: int, index: int) -> float:
    """The number `index` of a row."""
    ...


@wp.func_native("((float*)((char*)array.data + (long long)row * array.strides[0]))[index] = value;")
def put(array: wp.array2d(dtype=float), row: int, index: int, value: float):
    """Set the number `index` of a row."""
    ...
