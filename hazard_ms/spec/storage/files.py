"""Files appear whole or not at all, whatever interrupts their writing: the one way in which the package writes them.

A file is first a draft beside its place, under a name that nobody can predict. It is brought to the disk and only then
given its name, so that readers see the older file or the new one. A draft is locked while it is written: what a killed
process left is known by the missing lock, and the next run deletes it.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import secrets
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

MARK = ".part"  # in the names of drafts
LONGEST = 32  # characters of a file's name that the name of its draft begins with [ours]
ANOTHER_FOLDER = "name a folder that you may write to"
REMEDIES = {
    errno.ENOSPC: "free some space, or name a folder on another disk",
    errno.EDQUOT: "free some space, or name a folder on another disk",
    errno.EFBIG: "raise the limit on the size of files, which ulimit -f shows",
    errno.EACCES: ANOTHER_FOLDER,
    errno.EPERM: ANOTHER_FOLDER,
    errno.EROFS: ANOTHER_FOLDER,
    errno.ENOENT: "make its folder first",
    errno.ENOTDIR: "make its folder first",
    errno.EISDIR: "name a file",
    errno.ENAMETOOLONG: "choose a shorter name",
}


class Draft:
    """A file that is being written at `path` and will be called `target`; both are full paths."""

    def __init__(self, target: Path) -> None:
        """Begin a draft beside `target`. Raises OSError where no file can be written."""
        self.target = Path(os.path.realpath(target))
        if self.target.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not target.is_file():
            raise OSError(errno.EINVAL, "it is a device or a pipe")
        _clear(self.target)
        self.path, self._lock = _begun(self.target)

    def write(self, content: str | bytes) -> None:
        """Make `content` the whole content; text is UTF-8, and what UTF-8 cannot hold is written as an escape.

        Raises ValueError where it cannot be written.
        """
        with _refusing(self.target):
            self.path.write_bytes(content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content)

    def flush(self) -> None:
        """Flush the draft to the disk."""
        with _refusing(self.target), self.path.open("rb") as file:
            os.fsync(file.fileno())

    def publish(self) -> None:
        """Give the draft its name."""
        os.replace(self.path, self.target)

    def discard(self) -> None:
        """Delete the draft, unless it has been published, and unlock it."""
        with contextlib.suppress(OSError):
            self.path.unlink(missing_ok=True)
        os.close(self._lock)


@contextlib.contextmanager
def drafts(*targets: Path) -> Iterator[tuple[Draft, ...]]:
    """Begin a draft of each of `targets`; all get their names when the block ends, and none when it raises.

    The names are given one right after the other: only a process that is killed between two of these calls leaves some
    files older than others, each of them whole. Raises ValueError that names the file which cannot be written; files
    that were there are then as before.
    """
    made: list[Draft] = []
    try:
        for target in targets:
            with _refusing(target):
                made.append(Draft(target))
        yield tuple(made)
        for draft in made:
            draft.flush()
        _publish(made)
    finally:
        for draft in made:
            draft.discard()


def write(path: Path, content: str | bytes) -> None:
    """Write a file whole. Raises ValueError where it cannot be written; a file that existed is left unchanged."""
    with drafts(path) as (draft,):
        draft.write(content)


def write_together(contents: Mapping[Path, str | bytes]) -> None:
    """Write several files, all or none, as `drafts` does. Raises ValueError where one cannot be written."""
    with drafts(*contents) as made:
        for draft, content in zip(made, contents.values(), strict=True):
            draft.write(content)


def make_folder(path: Path) -> None:
    """Make a folder and those above it, where they do not exist. Raises ValueError where it cannot be made."""
    with _refusing(path, "folder"):
        path.mkdir(parents=True, exist_ok=True)


def flush(path: Path) -> None:
    """Bring a file, or the names in a folder, to the disk. Raises OSError where that fails."""
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    finally:
        os.close(opened)


def _publish(made: list[Draft]) -> None:
    """Give all drafts their names; where one cannot have its name, give all names back to the older files."""
    older: dict[Path, Path | None] = {}
    published = 0
    with contextlib.ExitStack() as locks:
        for folder in sorted({draft.target.parent for draft in made}):
            locks.enter_context(_locked(folder))
        try:
            for draft in made if len(made) > 1 else ():
                with _refusing(draft.target):
                    older[draft.target] = _kept(draft)
            for draft in made:
                with _refusing(draft.target):
                    draft.publish()
                published += 1
        except BaseException:
            for draft in made[:published] if older else ():
                before = older[draft.target]
                with contextlib.suppress(OSError):
                    os.replace(before, draft.target) if before else draft.target.unlink()
            raise
        finally:
            for spare in filter(None, older.values()):
                with contextlib.suppress(OSError):
                    spare.unlink()


def _kept(draft: Draft) -> Path | None:
    """A second name of the file that `draft` replaces, None if there is none."""
    second = draft.path.with_suffix(f".older{MARK}")
    try:
        os.link(draft.target, second)
    except FileNotFoundError:
        return None
    except OSError:  # a file system without links
        shutil.copy2(draft.target, second)
    return second


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Let nobody else publish in `folder` meanwhile, and flush its new names to the disk, where it can."""
    opened = -1
    with contextlib.suppress(OSError):
        opened = os.open(folder, os.O_RDONLY)
        fcntl.flock(opened, fcntl.LOCK_EX)
    try:
        yield
        with contextlib.suppress(OSError):
            os.fsync(opened)
    finally:
        if opened >= 0:
            os.close(opened)


def _begun(target: Path) -> tuple[Path, int]:
    """A new, empty and locked draft of `target`: its path, and the descriptor that holds the lock."""
    while True:
        path = target.with_name(f"{_start(target)}{secrets.token_hex(8)}{MARK}{target.suffix}")
        lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666)
        with contextlib.suppress(OSError):  # where files cannot be locked, drafts that are left stay
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if path.exists():  # else another process took it for one that was left
            break
        os.close(lock)
    with contextlib.suppress(OSError):  # a new file has the usual mode
        os.fchmod(lock, target.stat().st_mode & 0o777)
    return path, lock


def _start(target: Path) -> str:
    return f".{target.stem[:LONGEST]}."


def _clear(target: Path) -> None:
    """Delete drafts of `target` that nobody writes any more."""
    with contextlib.suppress(OSError):
        for left in target.parent.iterdir():
            if left.name.startswith(_start(target)) and MARK in left.name:
                _delete_unlocked(left)


def _delete_unlocked(left: Path) -> None:
    with contextlib.suppress(OSError):
        opened = os.open(left, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            left.unlink()
        finally:
            os.close(opened)


@contextlib.contextmanager
def _refusing(target: Path, kind: str = "file") -> Iterator[None]:
    """Turn an OSError into a ValueError that names `target`, the reason and a remedy."""
    try:
        yield
    except OSError as error:
        remedy = REMEDIES.get(error.errno or 0, "name another place")
        raise ValueError(f"output must be a writable {kind}, got {target}: {error.strerror}; {remedy}") from None
