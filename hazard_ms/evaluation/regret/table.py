"""The loss of each agent by parts, as plain data and as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.evaluation.regret.causes import MITIGATION, PARTS, EpisodeRegret


def shares(found: Sequence[EpisodeRegret]) -> dict[str, float]:
    """The means over episodes of what was lost by each of PARTS, and of "start" and "value", as shares of all value.

    Raises ValueError for no episodes.
    """
    if not found:
        raise ValueError("episodes must hold at least one, got none")
    made = {"start": _mean([one.start for one in found]), "value": _mean([one.value for one in found])}
    return made | {part: _mean([one.lost[part] for one in found]) for part in PARTS}


def table(found: Sequence[EpisodeRegret]) -> str:
    """The parts of each agent's loss in per cent of the value of all targets, one line for each agent.

    `mitigation` is among them in tasks with `averted` alone.
    """
    agents = list(dict.fromkeys(one.agent for one in found))
    averts = any(one.averts for one in found)
    names = ("start", "value", *(part for part in PARTS if averts or part != MITIGATION))
    lines = [f"{'lost, % of value':16s} " + " ".join(f"{name:>10s}" for name in names) + "  episodes"]
    for agent in agents:
        own = [one for one in found if one.agent == agent]
        row = shares(own)
        lines.append(f"{agent:16s} " + " ".join(f"{100 * row[name]:10.1f}" for name in names) + f"  {len(own):8d}")
    return "\n".join(lines)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)
