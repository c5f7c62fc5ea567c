"""Folders that appear whole or not at all: filled under another name by one process, and renamed."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def part_of(place: Path) -> Iterator[Path | None]:
    """A new, empty and locked folder beside `place`, which whoever has filled it renames; else it is deleted.

    None where another process has one. What killed processes left is deleted.
    """
    home = place.parent
    for left in sorted(home.glob(f".{place.name}.part-*")):
        opened = os.open(left, os.O_RDONLY)
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(left)
        except BlockingIOError:
            yield None
            return
        finally:
            os.close(opened)
    part = home / f".{place.name}.part-{os.getpid()}"
    part.mkdir()
    lock = os.open(part, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield part
    finally:
        shutil.rmtree(part, ignore_errors=True)
        os.close(lock)
