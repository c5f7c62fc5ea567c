"""Recorded episodes that nobody played, and writers of them that are killed on the way."""

from __future__ import annotations

import dataclasses
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations import claims, store
from hazard_ms.demonstrations.layout import DECISIONS, FRAMES, PRIVILEGED, TRUTH, Entry
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult
from tests.worlds.results import result_of

RECIPE: dict[str, Any] = {"env_id": "HazardFire-v1", "agent": "oracle", "settings": {}, "obs": "none"}
RECIPE |= {"every": 0, "keep": 0.8}
# Functions of os at which a writer can be killed
SYSTEM_CALLS = ("mkdir", "open", "write", "pwrite", "fsync", "replace", "close")


def stored(
    dataset: Path,
    seed: int,
    reason: str = "",
    recipe: dict[str, Any] = RECIPE,
    saved: bool = True,
    played: EpisodeResult | None = None,
    film: bytes = b"",
    decisions: dict[str, NDArray[Any]] | None = None,
) -> Path:
    """Store an episode of three frames and two decisions as a recording does; its folder.

    `played`: its result, another one than that with two targets; `film`: the film of the head camera, if there is one;
    `decisions`: other arrays for them.
    """
    dataset.mkdir(parents=True, exist_ok=True)
    options = EpisodeOptions(agent="oracle", seed=seed)
    result = dataclasses.replace(played or result_of(options, saved), wall_seconds=float(os.getpid()), frames=3)
    with claims.claimed(dataset, seed) as mine:
        assert mine
        part = store.begin(dataset, seed)
        rng = np.random.default_rng(seed)
        store.put_arrays(part / DECISIONS, decisions or {"frame": np.array([0, 2], np.int32)})
        store.put_arrays(part / FRAMES, {"action": rng.random((3, 2), np.float32)})
        store.put_arrays(part / PRIVILEGED / TRUTH, {"best": np.ones(2, np.float32)})
        if film:
            (part / "head.mp4").write_bytes(film)
        meta = {"recipe": recipe, "reason": reason, "reach": 1.0, "control_mode": "pd_joint_pos", "privileged": True}
        store.describe(part, result, meta)
        entry = dataclasses.replace(store.entry_of(part), verified=True, seconds={"physics": float(os.getpid())})
        return store.publish(part, dataset, entry)


def content(entries: list[Entry]) -> dict[str, str]:
    """The hash of each episode by its name."""
    return {entry.name: entry.content for entry in sorted(entries, key=lambda e: e.name)}


def killed_at(call: int, work: Callable[[], object]) -> bool:
    """Do `work` in a copy of this process that is killed at its system call number `call`, from 0.

    Returns whether it was: False if it was done before. Every other `write` writes only a part before the end.
    """
    child = os.fork()
    if child == 0:
        try:
            _die_at(call)
            work()
            os._exit(0)
        except BaseException as error:
            os.write(2, f"{type(error).__name__}: {error}\n".encode())
            os._exit(1)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status) or os.WEXITSTATUS(status) == 0
    return os.WIFSIGNALED(status)


def _die_at(call: int) -> None:
    """Let this process be killed at its system call number `call`; a write is then half done."""
    left = [call]

    def wrapped(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*arguments: Any, **keywords: Any) -> Any:
            if left[0] == 0:
                if name == "write":
                    real(arguments[0], arguments[1][: len(arguments[1]) // 2])
                os.kill(os.getpid(), signal.SIGKILL)
            left[0] -= 1
            return real(*arguments, **keywords)

        return counted

    for name in SYSTEM_CALLS:
        setattr(os, name, wrapped(name, getattr(os, name)))
