"""Lets several processes write one dataset: each claims an episode before it plays it.

Claims are locks of the operating system on files `.s000012.lock`, which also name their holder for whoever looks. They
end with the process that holds them, however it ends, so that none can be left over.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import json
import os
import socket
import stat
import time
from collections.abc import Iterator
from pathlib import Path

DATASET_LOCK = ".lock"  # held by all who publish, together, and by whoever repairs, alone


@contextlib.contextmanager
def publishing(dataset: Path) -> Iterator[None]:
    """Let nobody repair the dataset meanwhile. Raises OSError where no file can be written."""
    with _locked(dataset / DATASET_LOCK, fcntl.LOCK_SH):
        yield


@contextlib.contextmanager
def repairing(dataset: Path) -> Iterator[None]:
    """Let nobody publish in the dataset meanwhile. Raises OSError where no file can be written."""
    with _locked(dataset / DATASET_LOCK, fcntl.LOCK_EX):
        yield


@contextlib.contextmanager
def claimed(dataset: Path, seed: int) -> Iterator[bool]:
    """Claim the episode of `seed`: False where another process has it. Raises OSError where no file can be written."""
    path = dataset / f"{tag(seed)}.lock"
    try:
        opened = _taken(path)
    except BlockingIOError:
        yield False
        return
    try:
        holder = {"pid": os.getpid(), "host": socket.gethostname(), "time": time.time()}
        os.pwrite(opened, json.dumps(holder).encode().ljust(200), 0)
        yield True
    finally:
        path.unlink(missing_ok=True)
        os.close(opened)


def tag(seed: int) -> str:
    """The beginning of the names of an episode's files while it is under way."""
    return f".s{seed:06d}"


def _taken(path: Path) -> int:
    """A locked descriptor of the file at `path`, made if need be.

    Raises BlockingIOError where it is locked, and ValueError for what is no regular file.
    """
    while True:
        opened = _opened(path)
        try:
            _lock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if path.exists() and os.path.samestat(os.stat(path), os.fstat(opened)):
                return opened  # else its holder has just deleted it
        except BaseException:
            os.close(opened)
            raise
        os.close(opened)


@contextlib.contextmanager
def _locked(path: Path, kind: int) -> Iterator[None]:
    opened = _opened(path)
    try:
        _lock(opened, kind)
        yield
    finally:
        os.close(opened)


def _opened(path: Path) -> int:
    """A descriptor of the file at `path`, made if need be. Raises ValueError for what is no regular file."""
    try:
        opened = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    except OSError as error:
        if error.errno not in (errno.ELOOP, errno.EISDIR, errno.ENXIO):
            raise
    else:
        if stat.S_ISREG(os.fstat(opened).st_mode):
            return opened
        os.close(opened)
    raise ValueError(f"{path} must be a regular file, got a link, a folder or a pipe; delete it")


def _lock(opened: int, kind: int) -> None:
    """Lock a file. Where files cannot be locked, two processes may do the same work; the first to publish wins."""
    try:
        fcntl.flock(opened, kind)
    except BlockingIOError:
        raise
    except OSError:
        pass
