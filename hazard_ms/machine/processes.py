"""Processes that work for another one."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import threading
import time
from collections.abc import Iterator, Mapping, Sequence

KEYS = ("HAZARD_MS_LLM_KEY", "HAZARD_MS_LLM_KEY_FILE")  # a key for models, and where it is
ASK_EVERY = 1.0  # time from one look at the parent of a copy to the next [s] [ours]


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment for a process that needs no key for models: `variables`, or ours, without it."""
    given = os.environ if variables is None else variables
    return {name: value for name, value in given.items() if name not in KEYS}


def needs_key(agent: str, load: Sequence[str] = ()) -> bool:
    """Whether an agent may ask a model: `llm`, one of a module or a file, and any that `load` may have registered."""
    name = agent.removeprefix("independent:").partition(":")[0]  # of a team, that of each robot
    return name == "llm" or "." in name or bool(load)


@contextlib.contextmanager
def without_keys(needed: bool = False) -> Iterator[None]:
    """Let processes of `multiprocessing` that are started meanwhile, which get our environment, have no key.

    Where it is `needed` they keep it.
    """
    kept = {} if needed else {name: os.environ.pop(name) for name in KEYS if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(kept)


def end_with_parent() -> None:
    """Let this process end when the one that started it does, even if that was killed.

    It would stay for ever otherwise, and go on with what it was given. For processes of `multiprocessing`; a copy of
    this process that somebody's code makes by os.fork ends with it likewise.
    """
    threading.Thread(target=_watch, daemon=True).start()
    os.register_at_fork(after_in_child=_end_with_original)


def _watch() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _end_with_original() -> None:
    """Threads do not live on in a copy, so it gets one of its own, which asks whether its parent is another one now."""
    threading.Thread(target=_watch_original, args=(os.getppid(),), daemon=True).start()


def _watch_original(process: int) -> None:
    while os.getppid() == process:
        time.sleep(ASK_EVERY)
    os._exit(1)


@contextlib.contextmanager
def few_threads(drawing: int) -> Iterator[None]:
    """Let processes that are started meanwhile compute with one thread, and draw on the processor with some.

    Processes with more threads than cores get in each other's way. A choice of the user's own for drawing stays.
    """
    kept = {name: os.environ.get(name) for name in ("OMP_NUM_THREADS", "LP_NUM_THREADS")}
    os.environ["OMP_NUM_THREADS"] = "1"
    os.environ.setdefault("LP_NUM_THREADS", str(drawing))  # of Mesa's lavapipe
    try:
        yield
    finally:
        for name, value in kept.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value
