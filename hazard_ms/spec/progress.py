"""One line on the standard error for what takes more than a moment. `HAZARD_MS_QUIET=1` silences it."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from collections.abc import Iterator

PATIENCE = 2.0  # after which a user wants to know what is going on [s] [ours]


def say(what: str) -> None:
    """Write a line that says `what` is going on."""
    if os.environ.get("HAZARD_MS_QUIET", "0") in ("", "0") and sys.stderr is not None:
        print(f"hazard_ms: {what} ...", file=sys.stderr, flush=True)


@contextlib.contextmanager
def slow(what: str) -> Iterator[None]:
    """Say `what` is going on if the block takes longer than PATIENCE."""
    timer = threading.Timer(PATIENCE, say, [what])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
