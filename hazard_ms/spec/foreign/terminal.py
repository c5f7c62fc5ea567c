"""The terminal: whatever a command prints, and whoever wrote it, nothing that a terminal would act on reaches it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterable, Iterator
from typing import Any, TextIO

from hazard_ms.spec.foreign.files import printable

LAYOUT = "\n\t"  # what the layout of a text is made of


class Plain:
    """A text stream that writes control characters, and others that change how text is shown, as escapes.

    Line breaks and tabs stay, and what goes back to the start of a line where it `overwrites`, as bars of progress do.
    """

    def __init__(self, stream: TextIO, overwrites: bool = False) -> None:
        self._stream, self._overwrites = stream, overwrites

    def write(self, text: str) -> int:
        """Write `text` as `plain` gives it. Returns the number of its characters."""
        self._stream.write(plain(text, LAYOUT + "\r" * self._overwrites))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def isatty(self) -> bool:
        """Whether it is a terminal on which lines may be written over; others are sent no colours either."""
        return self._overwrites and self._stream.isatty()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def plain(text: str, kept: str = LAYOUT) -> str:
    """The text as `printable` gives it, but for the characters `kept`."""
    if text.isprintable():
        return text
    return "".join(c if c in kept or c.isprintable() else printable(c) for c in text)


@contextlib.contextmanager
def plain_output() -> Iterator[None]:
    """Make the standard output and the standard error streams of `Plain` text in the block, where they are open."""
    kept = sys.stdout, sys.stderr
    output, errors = (None if stream is None else Plain(stream, stream is sys.stderr) for stream in kept)
    sys.stdout, sys.stderr = output, errors
    try:
        yield
    finally:
        sys.stdout, sys.stderr = kept
