"""Episodes as timelines: decisions with their skills, notes and regret, rescues and damage, as plain data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hazard_ms.cli.web.compare.numbers import is_person
from hazard_ms.cli.web.compare.shelf import Book, film_of
from hazard_ms.evaluation.comparison.curves import outcome
from hazard_ms.evaluation.regret.causes import DecisionRegret, EpisodeRegret
from hazard_ms.evaluation.result import DecisionRecord

MOST_TIMELINES = 12  # that are shown over one another [ours]
MOST_BARS = 2_000  # decisions of an episode that are drawn [ours]


def timelines(books: Mapping[str, Book], keys: Sequence[str]) -> list[dict[str, Any]]:
    """The episodes with these keys. Raises ValueError for keys of no result, and for too many."""
    if not 1 <= len(keys) <= MOST_TIMELINES:
        raise ValueError(f"the number of episodes must be 1 to {MOST_TIMELINES}, got {len(keys)}")
    for key in keys:
        if key not in books:
            raise ValueError(f"episode must be one of those on the page, got {key!r:.100}")
    return [timeline(books[key]) for key in dict.fromkeys(keys)]


def timeline(book: Book) -> dict[str, Any]:
    """One episode: frames are those of the episode, shares are of the value of all targets."""
    result, regret = book.kept.result, book.kept.regret
    judged = {} if regret is None else {(row.frame, row.verb, row.target): row for row in regret.decisions}
    return {
        "key": book.key,
        "agent": result.agent,
        "person": is_person(result.agent),
        "seed": result.seed,
        "scene": result.scene,
        "ended": result.ended,
        "frames": result.frames,
        "max_frames": result.max_frames,
        "value": result.tally.value,
        "film": film_of(book.kept) is not None,
        "targets": [
            {
                "name": fate.name,
                "value": fate.value,
                "rescued": fate.frame,
                "damaged": fate.damaged_frame,
                "whole": not fate.damaged,
            }
            for fate in result.targets
        ],
        "decisions": [
            _decision(row, judged.get((row.frame, row.verb, row.target))) for row in result.decisions[:MOST_BARS]
        ],
        "left_out": max(0, len(result.decisions) - MOST_BARS),
        "lost": None if regret is None else _lost(regret),
    }


def _decision(row: DecisionRecord, judged: DecisionRegret | None) -> dict[str, Any]:
    """One decision; its skill begins after the agent has thought for `waited` frames."""
    return {
        "frame": row.frame,
        "waited": row.waited,
        "frames": row.frames,
        "verb": row.verb,
        "target": row.target,
        "held": row.held,
        "outcome": outcome(row),
        "reason": row.reason,
        "note": row.note,
        "value": row.value,
        "regret": None
        if judged is None
        else {
            "best": judged.best,
            "lost": judged.regret,
            "unseen": judged.unseen,
            "execution": judged.execution,
            "cause": judged.cause,
            "evidence": judged.evidence,
        },
    }


def _lost(regret: EpisodeRegret) -> dict[str, Any]:
    """What the best plan reached from the start, what was rescued, and what was lost by each part."""
    return {"start": regret.start, "value": regret.value, "parts": regret.lost}
