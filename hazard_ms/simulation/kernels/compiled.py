"""The folder of compiled kernels: what Warp finds there is what it once wrote, else it is compiled again.

Warp takes any file with the right name for a compiled kernel. So a seal is kept beside each folder: the SHA-256 of each
file in it, written last. A folder without its seal was left by a process that ended in between.
"""

from __future__ import annotations

import atexit
import contextlib
import fcntl
import hashlib
import io
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from hazard_ms.spec.progress import say
from hazard_ms.spec.storage.cache import home
from hazard_ms.spec.storage.files import write

READ_AT_ONCE = 1 << 20  # [bytes]


def cache() -> str:
    """The folder of compiled kernels; one for this process alone if the usual one cannot be written."""
    place = home() / "kernels"
    with contextlib.suppress(OSError):
        place.mkdir(parents=True, exist_ok=True)
    if os.access(place, os.W_OK):
        return str(place)
    own = tempfile.mkdtemp(prefix="hazard_ms_kernels_")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return own


@contextlib.contextmanager
def writable(folder: str) -> Iterator[None]:
    """Raises ValueError for an OSError in the block, with the `folder` of compiled kernels and a remedy."""
    try:
        yield
    except OSError as error:
        raise ValueError(
            f"compiled kernels must be kept in a writable folder, got {folder}: {error.strerror or error}; free some "
            "space, or set HAZARD_MS_HOME (or WARP_CACHE_PATH, if it is set) to another folder"
        ) from None


@contextlib.contextmanager
def verified(folder: Path) -> Iterator[None]:
    """Let Warp load or compile a module in `folder` in the block; what is damaged there is deleted before.

    One process at a time does so. Raises ValueError where damaged files cannot be deleted.
    """
    with _locked(folder.parent):
        seal = folder.with_name(f"{folder.name}.sha256")
        if folder.is_dir() and not _whole(folder, seal):
            say(f"compiled kernels in {folder} are damaged or unfinished; compiling them again")
            try:
                shutil.rmtree(folder)
            except OSError as error:
                raise ValueError(
                    f"the damaged kernels in {folder} could not be deleted: {error.strerror}; delete this folder"
                ) from None
        yield
        if not _whole(folder, seal):
            with contextlib.suppress(ValueError):  # without a seal, the next process compiles again
                write(seal, _sealed(folder))


def _whole(folder: Path, seal: Path) -> bool:
    """Whether the files in `folder` are those that were sealed."""
    if not seal.exists():
        return not os.access(folder.parent, os.W_OK)  # who set up a read-only folder answers for it
    wanted = _sealed(folder)
    try:
        with seal.open("rb") if seal.is_file() else contextlib.nullcontext(io.BytesIO()) as file:
            return file.read(len(wanted) + 1) == wanted
    except OSError:
        return False


def _sealed(folder: Path) -> bytes:
    """The content of the seal of `folder`: the SHA-256 of each file in it, by name; none where there is no folder."""
    files = sorted(folder.iterdir()) if folder.is_dir() else []
    return json.dumps({file.name: _digest(file) for file in files if file.is_file()}).encode()


def _digest(path: Path) -> str:
    found = hashlib.sha256()
    with path.open("rb") as file:
        while part := file.read(READ_AT_ONCE):
            found.update(part)
    return found.hexdigest()


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Keep other processes from loading or compiling meanwhile, where `folder` can be locked."""
    lock = -1
    with contextlib.suppress(OSError):
        lock = os.open(folder / ".lock", os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, 0o666)
        fcntl.flock(lock, fcntl.LOCK_EX)
    try:
        yield
    finally:
        if lock >= 0:
            os.close(lock)
