"""The numbers of targets in observations, taken from those of all things (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def tell(
    things: wp.array3d(dtype=float),
    index: wp.array2d(dtype=wp.int64),
    first: wp.array(dtype=wp.int64),
    width: wp.array(dtype=wp.int64),
    told: wp.array2d(dtype=float),
):
    """Write the numbers of T targets, [E, T K], one term after the other, from those of all `things`, [E, B, K].

    `index`, [E, T], says which thing a target is, -1 for none, whose numbers are 0. Of each of the K numbers, `first`
    is that of its own term which comes first, `width` how many its term has.
    """
    e, t, k = wp.tid()
    start, wide = int(first[k]), int(width[k])
    value = float(0.0)
    if index[e, t] >= wp.int64(0):
        value = things[e, int(index[e, t]), k]
    told[e, start * index.shape[1] + t * wide + k - start] = value
