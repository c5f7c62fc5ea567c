"""Options of `hazard-ms serve` as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

MOST_SESSIONS = 4  # rescues at once, each a process of 1 to 2 GB [ours]
IDLE_MINUTES = 10.0  # time after which a rescue that nobody looks at gives its process back [min] [ours]
PORTS = 65535  # the highest port


@dataclass(frozen=True)
class ServeOptions:
    """Options of `hazard-ms serve`."""

    port: int = 0
    """Port on this machine; 0: any free one, new at each start."""
    folder: tuple[Path, ...] = ()
    """Folders of results; rescues go to the first. By default `rescues`."""
    sessions: int = MOST_SESSIONS
    """Largest number of rescues at once; each is a process of 1 to 2 GB."""
    idle: float = IDLE_MINUTES
    """Time after which a rescue that no page shows ends its process; it can be resumed later [min]."""
    load: tuple[str, ...] = ()
    """Modules, or files NAME.py, that register your own tasks, hazards, robots and agents."""

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders of results, of which the first one is written to."""
        return self.folder or (Path("rescues"),)

    def check(self) -> None:
        """Check all numbers. Raises ValueError for those that are not allowed."""
        from hazard_ms.spec.checks import whole  # loads torch

        whole(self.port, 0, PORTS, "port")
        whole(self.sessions, 1, 64, "sessions")
        if not 0.0 < self.idle <= 1440.0:
            raise ValueError(f"idle must be more than 0 and at most 1440 min, got {self.idle}")
