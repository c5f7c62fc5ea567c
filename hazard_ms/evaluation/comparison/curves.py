"""The course of an agent's episodes: value and fates of targets over frames, and the frames that each skill takes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from hazard_ms.skills.failures import UNFINISHED

POINTS = 121  # of a curve [ours]
FATES = ("rescued whole", "rescued damaged", "whole", "damaged")
OUTCOMES = ("done", "unfinished", "failed")


def times(max_frames: int) -> NDArray[np.float64]:
    """The frames at which curves are known, [POINTS], from 0 to `max_frames`."""
    return np.linspace(0.0, max_frames, POINTS)


def value_curve(results: Sequence[EpisodeResult], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean share of the value that is rescued by each of `frames`: [POINTS]."""
    curves = []
    for result in results:
        curve = np.zeros_like(frames)
        for fate in result.targets:
            curve += fate.worth * (frames >= _or_never(fate.frame))
        curves.append(curve / result.tally.value_total)
    return np.mean(curves, axis=0)


def fate_curves(results: Sequence[EpisodeResult], frames: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Share of all targets that has met each of FATES by each of `frames`: [POINTS] each; they add up to 1."""
    counts = {name: np.zeros_like(frames) for name in FATES}
    targets = [(fate, result.frames) for result in results for fate in result.targets]
    for fate, end in targets:
        rescued = frames >= _or_never(fate.frame)
        struck = frames >= _or_never(_damaged_at(fate, end))
        counts["rescued whole"] += rescued & (not fate.damaged)
        counts["rescued damaged"] += rescued & fate.damaged
        counts["whole"] += ~rescued & ~struck
        counts["damaged"] += ~rescued & struck
    return {name: count / len(targets) for name, count in counts.items()}


def skill_frames(results: Sequence[EpisodeResult]) -> dict[str, dict[str, tuple[int, int]]]:
    """The tries of each verb that came to each of OUTCOMES, and the frames that they took, in all episodes."""
    found: dict[str, dict[str, tuple[int, int]]] = defaultdict(lambda: dict.fromkeys(OUTCOMES, (0, 0)))
    for result in results:
        for decision in result.decisions:
            tries, frames = found[decision.verb][outcome(decision)]
            found[decision.verb][outcome(decision)] = (tries + 1, frames + decision.frames)
    return dict(sorted(found.items()))


def outcome(decision: DecisionRecord) -> str:
    """The one of OUTCOMES that a decision came to: what was still under way, such as a long walk, is unfinished."""
    if decision.ok:
        return "done"
    return "unfinished" if decision.reason in UNFINISHED else "failed"


def _or_never(frame: int | None) -> float:
    return np.inf if frame is None else float(frame)


def _damaged_at(fate: Fate, end: int) -> int | None:
    """The frame of the first damage; where it was not recorded, the last frame at which it can have come."""
    if not fate.damaged:
        return None
    return next(frame for frame in (fate.damaged_frame, fate.frame, end) if frame is not None)
