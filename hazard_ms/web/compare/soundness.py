"""Results out of files that anybody may have written: what their numbers and texts must be like to be shown."""

from __future__ import annotations

from pathlib import Path

from hazard_ms.evaluation.comparison.folders import title
from hazard_ms.evaluation.regret.causes import CAUSES, PARTS, UNSEEN, DecisionRegret, EpisodeRegret, beside
from hazard_ms.evaluation.result import EpisodeResult

MOST_FRAMES = 10_000_000  # of an episode [ours]
MOST_TARGETS = 1_000  # of an episode [ours]
MOST_DECISIONS = 20_000  # of an episode [ours]
MOST_PHASES = 100  # of the wall time of an episode [ours]
MOST_SECONDS = 1e9  # of the wall time of an episode [s] [ours]
MOST_VALUE = 1e6  # of a target [ours]
LARGEST_SEED = 2**53  # beyond which browsers round whole numbers
LONGEST_NAME = 1_000  # characters of a name or a title [ours]
LONGEST_TEXT = 100_000  # characters of a note [ours]
LARGEST_SHARE = 1_000.0  # of all value, up to which regrets are shown [ours]


def checked(result: EpisodeResult) -> EpisodeResult:
    """The `result`, if everything about it can be shown. Raises ValueError that names the first thing that cannot."""
    _name("title", title(result))
    for name in ("env_id", "agent", "scene", "ended"):
        _name(name, getattr(result, name))
    _within("seed", result.seed, 0, LARGEST_SEED)
    _within("max_frames", result.max_frames, 1, MOST_FRAMES)
    _within("frames", result.frames, 0, result.max_frames)
    _within("wall_seconds", result.wall_seconds, 0, MOST_SECONDS)
    _within("the number of phases", len(result.phase_seconds), 0, MOST_PHASES)
    for seconds in result.phase_seconds.values():
        _within("phase_seconds", seconds, 0, MOST_SECONDS)
    _targets(result)
    _decisions(result)
    return result


def judged(path: Path) -> EpisodeRegret | None:
    """The regret beside the result in the file `path`, None where there is none that fits it.

    Raises ValueError for one that is damaged, or whose numbers cannot be shown.
    """
    found = beside(path)
    if found is None:
        return None
    for part in PARTS:
        _share(f"lost by {part}", found.lost.get(part) if isinstance(found.lost, dict) else None)
    _share("start", found.start)
    _share("value", found.value)
    _within("the number of decisions", len(found.decisions), 0, MOST_DECISIONS)
    for row in found.decisions:
        _decision_regret(row)
    return found


def _targets(result: EpisodeResult) -> None:
    _within("the number of targets", len(result.targets), 1, MOST_TARGETS)
    for fate in result.targets:
        _name("name of a target", fate.name)
        _name("category of a target", fate.category)
        _within("value of a target", fate.value, 1 / MOST_VALUE, MOST_VALUE)
        for frame in (fate.frame, fate.damaged_frame):
            if frame is not None:
                _within("frame of a target", frame, 0, MOST_FRAMES)


def _decisions(result: EpisodeResult) -> None:
    _within("the number of decisions", len(result.decisions), 0, MOST_DECISIONS)
    for row in result.decisions:
        for text in (row.verb, row.target, row.reason, row.held):
            _name("text of a decision", text or "")
        _name("note of a decision", row.note, LONGEST_TEXT)
        for frame in (row.frame, row.frames, row.waited):
            _within("frames of a decision", frame, 0, MOST_FRAMES)
        _within("value at a decision", row.value, 0, 1 + 1e-9)


def _decision_regret(row: DecisionRegret) -> None:
    _within("frame of a regret", row.frame, 0, MOST_FRAMES)
    for share in (row.best, row.regret, row.unseen, row.execution):
        _share("regret of a decision", share)
    if row.cause not in (*CAUSES, UNSEEN, ""):
        raise ValueError(f"cause of a regret must be one of {', '.join(CAUSES)}, {UNSEEN}, got {row.cause!r:.100}")
    for text in (row.verb, row.target or "", row.evidence):
        _name("text of a regret", text, LONGEST_TEXT)


def _share(name: str, value: object) -> None:
    _within(name, value, -LARGEST_SHARE, LARGEST_SHARE)


def _within(name: str, value: object, low: float, high: float) -> None:
    """Whether it is a number from `low` to `high`, which NaN is not. Raises ValueError otherwise."""
    if not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError(f"{name} must be a number from {low:g} to {high:g}, got {value!r:.100}")


def _name(name: str, value: object, longest: int = LONGEST_NAME) -> None:
    if not isinstance(value, str) or len(value) > longest:
        size = f"{len(value)} characters" if isinstance(value, str) else f"{value!r:.100}"
        raise ValueError(f"{name} must be a text of at most {longest} characters, got {size}")
    if not value.isascii():
        try:
            value.encode()
        except UnicodeEncodeError:
            raise ValueError(f"{name} must be valid Unicode, got {value!a:.100}") from None
