"""Starts commands under faults: killed, without a reader, two at once, on a full or a read-only file system."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.faults.commands import Command, environment
from tests.worlds.files.checkout import ROOT

LONGEST = 280.0  # of a command [s]
SIZE = 64_000_000  # of a file system that is made for a test [bytes]


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    code: int
    error: str

    @property
    def last(self) -> str:
        """Last line on the standard error."""
        return (self.error.strip().splitlines() or ["nothing was said"])[-1][:160]


def started(command: Command, folder: Path, seed: int, **changes: str | None) -> subprocess.Popen[str]:
    """The command, in a session of its own."""
    words, environ = command.words(folder, seed), environment(command, folder, **changes)
    pipe = subprocess.PIPE
    return subprocess.Popen(
        words, env=environ, cwd=ROOT, stdout=pipe, stderr=pipe, text=True, errors="replace", start_new_session=True
    )


def ended(process: subprocess.Popen[str]) -> Ended:
    """Wait for the end; what takes too long is killed, and counts as hanging."""
    try:
        _, error = process.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return Ended(-1, "it hangs")
    return Ended(process.returncode, error)


def run(command: Command, folder: Path, seed: int, **changes: str | None) -> Ended:
    """Run the command to its end."""
    return ended(started(command, folder, seed, **changes))


def killed(command: Command, folder: Path, seed: int, seconds: float) -> None:
    """Kill the command and all that it started after `seconds`."""
    process = started(command, folder, seed)
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def run_two(command: Command, folder: Path) -> list[Ended]:
    """Run two of it at once."""
    return [ended(process) for process in [started(command, folder, seed) for seed in (0, 1)]]


def start_without_reader(command: Command, folder: Path, seed: int) -> Ended:
    """Run it while nobody reads what it prints."""
    process = started(command, folder, seed)
    assert process.stdout is not None
    process.stdout.close()
    process.stdout = None
    return ended(process)


def can_mount() -> bool:
    """Whether this process may make file systems."""
    return os.geteuid() == 0 and subprocess.run(["unshare", "-m", "true"], check=False).returncode == 0


@contextmanager
def mounted(folder: Path, free: int | None = None, read_only: bool = False) -> Iterator[None]:
    """Put a file system of its own on `folder`: with `free` bytes, or read-only."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(folder)], check=True)
    try:
        if free is not None:
            with (folder / ".filling").open("wb") as file:
                file.write(b"\0" * (SIZE // 4096 * 4096 - (free // 4096 + 1) * 4096))
        if read_only:
            subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
        yield
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)
