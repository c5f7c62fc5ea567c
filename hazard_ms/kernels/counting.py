"""The course of rescues in numbers, from which info and rewards are made (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def count(
    target: wp.array2d(dtype=bool),
    value: wp.array2d(dtype=float),
    safe: wp.array2d(dtype=bool),
    damaged: wp.array2d(dtype=bool),
    rescued: wp.array2d(dtype=bool),
    rescued_at: wp.array2d(dtype=wp.int64),
    rescued_damaged: wp.array2d(dtype=bool),
    frame: wp.array(dtype=wp.int64),
    share: float,
    number: wp.array2d(dtype=wp.int64),
    amount: wp.array2d(dtype=float),
):
    """Count, in each environment, its targets and what became of them.

    `number`: targets, those that are safe, those that are not but damaged. `amount`: value of those that are safe as a
    share of that of all, one that was damaged counting as `share`; things rescued in this `frame`, counted likewise.
    """
    e = wp.tid()
    targets, saved, spoilt = int(0), int(0), int(0)
    total, worth, now = float(0.0), float(0.0), float(0.0)
    for b in range(target.shape[1]):
        counts = float(1.0)
        if rescued_damaged[e, b]:
            counts = share
        if rescued[e, b] and rescued_at[e, b] == frame[e]:
            now += counts
        if target[e, b]:
            targets += 1
            total += value[e, b]
            if safe[e, b]:
                saved += 1
                worth += counts * value[e, b]
            elif damaged[e, b]:
                spoilt += 1
    number[e, 0] = wp.int64(targets)
    number[e, 1] = wp.int64(saved)
    number[e, 2] = wp.int64(spoilt)
    amount[e, 0] = worth / wp.max(total, 1.0)
    amount[e, 1] = now
