"""Reads other people's files up to a size limit, and shows their text without codes that a terminal would act on."""

from __future__ import annotations

import os
import stat
from pathlib import Path


def read_foreign(path: Path, most: int, name: str = "") -> bytes:
    """The content of a regular file of at most `most` bytes, which errors call `name`; empty: its path.

    It never waits, as a pipe would make it. Raises ValueError for files that are absent, of another kind, too large or
    unreadable.
    """
    shown = printable(name or str(path))
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (FileNotFoundError, NotADirectoryError):
        raise ValueError(f"there is no file {shown}") from None
    except OSError as error:
        raise ValueError(f"{shown} cannot be read: {error.strerror}") from None
    try:
        found = os.fstat(handle)
        if not stat.S_ISREG(found.st_mode):
            raise ValueError(f"{shown} must be a regular file, got a folder, a pipe or a device")
        if found.st_size > most:
            raise ValueError(f"{shown} must have at most {most} bytes, got {found.st_size}")
        with os.fdopen(handle, "rb", closefd=False) as file:
            data = file.read(most + 1)
    except OSError as error:
        raise ValueError(f"{shown} cannot be read: {error.strerror}") from None
    finally:
        os.close(handle)
    if len(data) > most:  # it grew, or does not say how large it is
        raise ValueError(f"{shown} must have at most {most} bytes, got more")
    return data


def printable(text: str) -> str:
    r"""The text with control characters, and others that change how a terminal shows it, written as \x1b and the like.

    Line breaks are written so, too.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
