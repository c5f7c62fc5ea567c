"""The processor: the number of its cores that a process may use, and who made it."""

from __future__ import annotations

import os
from pathlib import Path


def cores() -> int:
    """Number of processor cores that this process may use: on a shared machine often fewer than there are."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS and Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def maker(processor: Path = Path("/proc/cpuinfo")) -> str:
    """The maker of the `processor` described in this file, "AuthenticAMD"; "unknown" where it does not say.

    Makers build the approximate reciprocals that PhysX takes differently (docs/reliability.md M15).
    """
    try:
        rows = [line.partition(":") for line in processor.read_text(encoding="utf-8").splitlines()]
    except OSError:  # no Linux
        return "unknown"
    return next((value.strip() for name, _, value in rows if name.strip() == "vendor_id"), "unknown")
