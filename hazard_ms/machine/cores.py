"""The number of processor cores that a process may use."""

from __future__ import annotations

import os


def cores() -> int:
    """Number of processor cores that this process may use: on a shared machine often fewer than there are."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS and Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
