"""Reads other people's files up to a size limit, and shows their text without codes that a terminal would act on."""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

LONGEST_NAME = 255  # of a file or folder [bytes]: what Linux's file systems allow
HASHED_AT_ONCE = 1 << 20  # [bytes]
LARGEST_HASHED = 100_000_000_000  # unless another limit is given [bytes] [ours]


def read_foreign(path: Path, most: int, name: str = "") -> bytes:
    """The content of a regular file of at most `most` bytes, which errors call `name`; empty: its path.

    It never waits, as a pipe would make it. Raises ValueError for files that are absent, of another kind, too large or
    unreadable.
    """
    shown = printable(name or str(path))
    with _opened(path, shown) as file:
        size = os.fstat(file.fileno()).st_size
        if size > most:
            raise ValueError(f"{shown} must have at most {most} bytes, got {size}")
        data = file.read(size + 1)  # no more: so much memory is taken first
        if len(data) > size:  # it grew, or does not say how large it is
            data += file.read(most + 1 - len(data))
    if len(data) > most:
        raise ValueError(f"{shown} must have at most {most} bytes, got more")
    return data


def read_text(path: Path, most: int, name: str = "") -> str:
    """The text of a file in UTF-8, read as `read_foreign` does. Raises ValueError for the same, and for other text."""
    try:
        return read_foreign(path, most, name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{printable(name or str(path))} must be text in UTF-8, got {error.reason}") from None


def sha256_of(path: Path, most: int = LARGEST_HASHED) -> str:
    """The SHA-256 of a regular file of at most `most` bytes. Raises ValueError for others, and what cannot be read."""
    found = hashlib.sha256()
    shown = printable(str(path))
    with _opened(path, shown) as file:
        left = os.fstat(file.fileno()).st_size  # not further, should it grow without end
        if left > most:
            raise ValueError(f"{shown} must have at most {most} bytes, got {left}")
        while left > 0 and (part := file.read(min(left, HASHED_AT_ONCE))):
            found.update(part)
            left -= len(part)
    return found.hexdigest()


def inside(folder: Path, name: Any, what: str) -> Path:
    """The path of `name`, which a file gives as `what`, in `folder`.

    Raises ValueError for a name that is no relative path, that climbs, and whose links lead out of `folder`.
    """
    parts = name.split("/") if isinstance(name, str) else []
    if not parts or any(part in ("", ".", "..") or not _possible(part) for part in parts):
        raise ValueError(f"{what} must be a path inside its folder, got {printable(repr(name))[:100]}")
    path = folder.joinpath(*parts)
    top = os.path.realpath(folder)
    if os.path.commonpath((top, os.path.realpath(path))) != top:
        raise ValueError(f"{what} must be a path inside its folder, got a link out of it: {printable(name)[:100]}")
    return path


def folder_name(name: Any, what: str) -> str:
    """`name` if it can be that of one visible file or folder, for `what` a file names.

    Raises ValueError for anything else, paths among them.
    """
    if not isinstance(name, str) or "/" in name or name.startswith(".") or not _possible(name):
        raise ValueError(f"{what} must be the name of a folder, got {printable(repr(name))[:100]}")
    return name


def printable(text: str) -> str:
    r"""The text with control characters, and others that change how a terminal shows it, written as \x1b and the like.

    Line breaks are written so, too.
    """
    return text if text.isprintable() else "".join(c if c.isprintable() else _escape(c) for c in text)


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()


def _possible(part: str) -> bool:
    """Whether a part of a path can be the name of a file and holds nothing that a terminal would act on."""
    return bool(part) and part.isprintable() and len(os.fsencode(part)) <= LONGEST_NAME and "\\" not in part


@contextmanager
def _opened(path: Path, shown: str) -> Iterator[BinaryIO]:
    """A regular file, opened without waiting. Raises ValueError that calls it `shown` for what cannot be read."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
    except (FileNotFoundError, NotADirectoryError):
        raise ValueError(f"there is no file {shown}") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise ValueError(f"{shown} cannot be read: {getattr(error, 'strerror', error)}") from None
    try:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise ValueError(f"{shown} must be a regular file, got a folder, a pipe or a device")
        with os.fdopen(handle, "rb", closefd=False) as file:
            yield file
    except OSError as error:
        raise ValueError(f"{shown} cannot be read: {error.strerror}") from None
    finally:
        os.close(handle)
