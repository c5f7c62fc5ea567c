"""Whether another process does anything: one that hangs gets no processor time, and waits for none."""

from __future__ import annotations

import os
import time
from pathlib import Path

LEAST = 0.02  # processor time that is no work: threads that wake up for a moment [s] [ours]
GAP = 1.0  # longest time between two looks that counts: after a longer one, who looks was stopped, too [s] [ours]
WAITS_ITS_TURN = "RD"  # states of a process that runs, could run, or waits for a disk


class Activity:
    """Watches a process of this machine. Where the system has no /proc, every process seems to be at work."""

    def __init__(self, pid: int) -> None:
        """Watch the process `pid` from now on."""
        self._pid, self._looked, self._spent, self._idle = pid, time.monotonic(), _state(pid)[1], 0.0

    def idle_seconds(self) -> float:
        """Time for which it has done nothing, as far as calls of this method have seen [s]."""
        state, spent = _state(self._pid)
        now = time.monotonic()
        if state in WAITS_ITS_TURN or spent - self._spent > LEAST:
            self._spent, self._idle = spent, 0.0
        else:
            self._idle += min(now - self._looked, GAP)
        self._looked = now
        return self._idle


def processor_seconds(pid: int) -> float:
    """Processor time that a process has used, with those that it started and that have ended [s]; 0 without /proc."""
    return _state(pid)[1]


def _state(pid: int) -> tuple[str, float]:
    """State of the main thread of a process, and processor time of all its threads [s]."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return "R", 0.0
    return fields[0], sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
