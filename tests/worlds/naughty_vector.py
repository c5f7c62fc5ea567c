"""Vector environments of `naughty_env`, which must leave no process behind."""

from __future__ import annotations

import contextlib
import multiprocessing
import time
from collections.abc import Iterator
from typing import Any

from hazard_ms.learning.vector import make
from hazard_ms.learning.vector.processes import ProcessVectorEnv

NAME = "tests.worlds.naughty_env:Naughty-v0"
SOON = 5.0  # in which whoever waits is told that nothing will come [s]


@contextlib.contextmanager
def naughty(num_envs: int, **keywords: Any) -> Iterator[ProcessVectorEnv]:
    before = pids()
    envs = make(NAME, num_envs, **{"processes": 2, **keywords})
    assert isinstance(envs, ProcessVectorEnv)
    try:
        yield envs
    finally:
        start = time.monotonic()
        envs.close()
        assert time.monotonic() - start < SOON
        assert pids() == before


def pids() -> set[int]:
    """The processes that there are."""
    return {child.pid for child in multiprocessing.active_children() if child.pid}
