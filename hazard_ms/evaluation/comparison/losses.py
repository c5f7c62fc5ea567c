"""The loss of each agent by cause, where `hazard-ms regret` has judged it: numbers, bars, worst decisions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from hazard_ms.evaluation.comparison.folders import Kept
from hazard_ms.evaluation.regret.causes import (
    BY_FORMAT,
    CAUSES,
    ENDED,
    EXECUTION,
    LATENCY,
    MEMORY,
    MITIGATION,
    PARTS,
    PERCEPTION,
    PLANNING,
    SMALL,
    UNSEEN,
    EpisodeRegret,
)
from hazard_ms.evaluation.regret.table import shares

WORST = 5  # decisions of an agent that are shown [ours]
COLOURS = {
    PERCEPTION: "#d98cff",
    MEMORY: "#5cadff",
    BY_FORMAT: "#ff9ecb",
    LATENCY: "#ffcd56",
    MITIGATION: "#b9855a",
    PLANNING: "#ef5f54",
    UNSEEN: "#56cc82",
    SMALL: "#6d7686",
    EXECUTION: "#ff8a3d",
    ENDED: "#b0b8c6",
}
WORDS = {
    UNSEEN: "targets not seen yet",
    SMALL: "small regrets",
    EXECUTION: "execution of skills",
    ENDED: "the agent failed",
}

Piece = tuple[str, float, str, float]  # words, length, colour, opacity


def losses(episodes: Iterable[Kept]) -> dict[str, Any] | None:
    """The loss of an agent: "episodes" that were judged, "shares" of all value by part, and its "worst" decisions.

    None where no episode was judged since its result was written.
    """
    found = [(kept, kept.regret) for kept in episodes if kept.regret is not None]
    if not found:
        return None
    return {
        "episodes": len(found),
        "shares": shares([regret for _, regret in found]),
        "worst": _worst(found),
    }


def _worst(found: Sequence[tuple[Kept, EpisodeRegret]]) -> list[dict[str, Any]]:
    """The decisions with a cause that lost most, the worst first."""
    made: list[dict[str, Any]] = [
        {
            "seed": regret.seed,
            "scene": regret.scene,
            "file": kept.path.name,
            "frame": row.frame,
            "action": row.verb if row.target is None else f"{row.verb} {row.target}",
            "lost": row.regret - row.unseen,
            "cause": row.cause,
            "evidence": row.evidence,
        }
        for kept, regret in found
        for row in regret.decisions
        if row.cause in CAUSES
    ]
    return sorted(made, key=lambda row: (-row["lost"], row["seed"], row["frame"]))[:WORST]


def pieces(lost: Mapping[str, Any]) -> list[Piece]:
    """The parts of an agent's loss that are above 0, in per cent of all value, as the pieces of a bar."""
    percent = {part: 100.0 * lost["shares"][part] for part in PARTS}
    return [(f"{named(part)}: {size:.1f} %", size, COLOURS[part], 1.0) for part, size in percent.items() if size > 0.0]


def named(part: str) -> str:
    """A part of the loss in words."""
    return WORDS.get(part, part)


def table(agents: Mapping[str, dict[str, Any]]) -> list[str]:
    """Lines of text with the parts of each agent's loss in per cent; none where nothing was judged.

    `mitigation` is among them where any was lost by it: in homes alone.
    """
    judged = {agent: row["lost"] for agent, row in agents.items() if "lost" in row}
    if not judged:
        return []
    mitigates = any(lost["shares"][MITIGATION] for lost in judged.values())
    parts = [part for part in PARTS if mitigates or part != MITIGATION]
    lines = [f"{'lost, % of value':16s} " + " ".join(f"{part:>10s}" for part in parts) + "  episodes"]
    for agent, lost in judged.items():
        row = " ".join(f"{100 * lost['shares'][part]:10.1f}" for part in parts)
        lines.append(f"{agent:16s} {row}  {lost['episodes']:8d}")
    return lines
