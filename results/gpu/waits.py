"""Counts where the host waits for the GPU within a step.

Torch warns of them itself (`torch.cuda.set_sync_debug_mode`). Waits inside PhysX, the renderer and Warp are not seen.
"""

from __future__ import annotations

import contextlib
import sys
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torch

import hazard_ms
from hazard_ms.cli.costs.tables import table
from results.gpu.rates import STATE, WARM_UP, batch, motions

WARNING = "called a synchronizing CUDA operation"  # torch's words
PACKAGE = Path(hazard_ms.__file__).parent
FRAMES = 30  # frames to count in: the hazards' rarer updates take part [ours]


def waits(env_id: str, num_envs: int, simulator: str, frames: int = FRAMES, seed: int = 0) -> dict[str, Any]:
    """Waits per frame by place, most first, and in how many `frames` they were counted."""
    env = batch(env_id, num_envs, STATE, simulator)
    try:
        env.reset()
        actions = motions(env, WARM_UP + frames, seed)
        for action in actions[:WARM_UP]:
            env.step(action)
        with counted() as places:
            for action in actions[WARM_UP:]:
                env.step(action)
    finally:
        env.close()
    return {"frames": frames, "places": {place: count / frames for place, count in places.most_common()}}


@contextlib.contextmanager
def counted() -> Iterator[Counter[str]]:
    """Count the waits within the block by place."""
    places: Counter[str] = Counter()
    with warnings.catch_warnings():
        shown = warnings.showwarning

        def hear(message: Any, category: Any, filename: str, lineno: int, *rest: Any) -> None:
            if WARNING in str(message):
                places[place(filename, lineno)] += 1
            else:
                shown(message, category, filename, lineno, *rest)

        warnings.filterwarnings("always", message=WARNING)
        warnings.showwarning = hear  # type: ignore[assignment]
        with _torch_warns():
            yield places


@contextlib.contextmanager
def _torch_warns() -> Iterator[None]:
    if not torch.cuda.is_available():
        yield
        return
    before = torch.cuda.get_sync_debug_mode()
    torch.cuda.set_sync_debug_mode("warn")
    try:
        yield
    finally:
        torch.cuda.set_sync_debug_mode(before)


def place(filename: str, lineno: int) -> str:
    """A line of a file, and the line of this package that led to it where that is another one."""
    here = f"{short(filename)}:{lineno}"
    for frame in reversed(traceback.extract_stack()):
        if PACKAGE in Path(frame.filename).parents:
            ours = f"{short(frame.filename)}:{frame.lineno}"
            return ours if ours == here else f"{here}, from {ours}"
    return here


def short(filename: str) -> str:
    """The part of a path that does not tell whose machine it is on."""
    path = Path(filename)
    for root in (PACKAGE.parent, *map(Path, sys.path)):
        if path.is_absolute() and root.is_absolute() and root in path.parents:
            return str(path.relative_to(root))
    return path.name


def waits_table(found: dict[str, float]) -> str:
    """A row for each place."""
    return table(["place", "a frame"], [[place, f"{count:.2f}"] for place, count in found.items()])
