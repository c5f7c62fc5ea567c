"""The course of rescues in numbers, from which info and rewards are made (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

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
    targets: wp.array(dtype=wp.int64),
    saved: wp.array(dtype=wp.int64),
    spoilt: wp.array(dtype=wp.int64),
    worth: wp.array(dtype=float),
    now: wp.array(dtype=float),
    done: wp.array(dtype=bool),
):
    """Count, in each environment, its `targets`, those that are `saved`, and those that are not but `spoilt`.

    `worth`: value of those that are saved as a share of that of all, one that was damaged counting as `share`; `now`:
    things rescued in this `frame`, counted likewise; `done`: there are targets, and all are saved.
    """
    e = wp.tid()
    every, safe_ones, damaged_ones = int(0), int(0), int(0)
    total, kept, fresh = float(0.0), float(0.0), float(0.0)
    for b in range(target.shape[1]):
        counts = float(1.0)
        if rescued_damaged[e, b]:
            counts = share
        if rescued[e, b] and rescued_at[e, b] == frame[e]:
            fresh += counts
        if target[e, b]:
            every += 1
            total += value[e, b]
            if safe[e, b]:
                safe_ones += 1
                kept += counts * value[e, b]
            elif damaged[e, b]:
                damaged_ones += 1
    targets[e] = wp.int64(every)
    saved[e] = wp.int64(safe_ones)
    spoilt[e] = wp.int64(damaged_ones)
    worth[e] = kept / wp.max(total, 1.0)
    now[e] = fresh
    done[e] = every > 0 and safe_ones == every
