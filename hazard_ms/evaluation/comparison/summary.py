"""The numbers of a comparison of agents: as plain data, which JSON can hold, and as text for a terminal."""

from __future__ import annotations

import dataclasses
import itertools
from collections import Counter
from collections.abc import Sequence
from typing import Any

from hazard_ms.evaluation.averted.loss import averted_of_all, mean_loads, mean_score
from hazard_ms.evaluation.comparison.curves import skill_frames
from hazard_ms.evaluation.comparison.folders import Group
from hazard_ms.evaluation.comparison.losses import losses
from hazard_ms.evaluation.comparison.losses import table as loss_table
from hazard_ms.evaluation.comparison.pairing import difference, regret
from hazard_ms.evaluation.metrics import Score, scores
from hazard_ms.evaluation.result import EpisodeResult

ORACLE = "oracle"  # the agent against which regret counts
UNDEFINED = dict.fromkeys(("mean", "low", "high"))


def summary(group: Group) -> dict[str, Any]:
    """Scores of each agent, differences of each two, and how the episodes went; shares are 0 to 1.

    An interval is {"mean", "low", "high"}, of 95 %, None where it is undefined.
    """
    return {
        "settings": group.title,
        "episodes": len(group.episodes),
        "agents": {agent: _agent(group, agent) for agent in group.agents},
        "differences": [
            {
                "agent": one,
                "other": other,
                "episodes": len(set(group.agents[one]) & set(group.agents[other])),
                "value": dataclasses.asdict(difference(group.values(one), group.values(other))),
                "averted": dataclasses.asdict(difference(group.averted(one), group.averted(other))),
            }
            for one, other in itertools.permutations(group.agents, 2)
        ],
    }


def _agent(group: Group, agent: str) -> dict[str, Any]:
    results = [kept.result for kept in group.agents[agent].values()]
    tallies = [result.tally for result in results]
    found = scores(tallies, [result.scene for result in results])
    made: dict[str, Any] = {name: dataclasses.asdict(score) for name, score in found.items()}
    if ORACLE in group.agents:
        made["regret"] = dataclasses.asdict(regret(group.values(agent), group.values(ORACLE)))
    if any(result.lost is not None for result in results):
        made |= _averted(results)
    lost = losses(group.agents[agent].values())
    if lost is not None:
        made["lost"] = lost
    skills = {
        verb: {outcome: {"tries": tries, "frames": frames} for outcome, (tries, frames) in outcomes.items()}
        for verb, outcomes in skill_frames(results).items()
    }
    failures = Counter(f"{d.verb} {d.reason}" for r in results for d in r.decisions if not d.ok)
    return made | {
        "episodes": len(results),
        "rescued": sum(tally.rescued for tally in tallies),
        "targets": sum(len(result.targets) for result in results),
        "ended": dict(Counter(result.ended for result in results).most_common()),
        "not_done": dict(failures.most_common()),
        "skills": skills,
        "seconds_per_episode": _seconds(results),
    }


def _averted(results: Sequence[EpisodeResult]) -> dict[str, Any]:
    """What was averted, of targets and of all things, in how many episodes that is undefined, and the mean loads."""
    told = [result for result in results if result.lost is not None]
    scenes = [result.scene for result in told]
    shares = [result.averted for result in told]
    every = [averted_of_all(result.lost, result.lost_alone) for result in told]
    return {
        "averted": dataclasses.asdict(mean_score(shares, scenes)),
        "averted_of_all": dataclasses.asdict(mean_score(every, scenes)),
        "averted_undefined": shares.count(None),
        "loads": mean_loads([result.loads for result in told]),
    }


def _seconds(results: Sequence[EpisodeResult]) -> dict[str, float]:
    """Mean wall time of an episode by phase [s]; "rest" is what belongs to none."""
    phases = list(dict.fromkeys(phase for result in results for phase in result.phase_seconds))
    made = {phase: sum(r.phase_seconds.get(phase, 0.0) for r in results) / len(results) for phase in phases}
    whole = sum(result.wall_seconds for result in results) / len(results)
    return {**made, "rest": max(whole - sum(made.values()), 0.0)}


def table(group: dict[str, Any]) -> str:
    """The scores of a group, as `summary` gives it, as lines of text: shares in per cent, Step in frames."""
    with_regret = any("regret" in row for row in group["agents"].values())
    with_averted = any("averted" in row for row in group["agents"].values())
    names = ["value", "step", "damage"] + ["averted"] * with_averted + ["regret"] * with_regret
    lines = [
        group["settings"],
        f"{'agent':16s} " + " ".join(f"{name.capitalize():>22s}" for name in names) + "  episodes",
    ]
    for agent, row in group["agents"].items():
        found = {name: row.get(name, UNDEFINED) for name in names}
        shown = " ".join(f"{interval(found[name], 1 if name == 'step' else 100):>22s}" for name in names)
        lines.append(f"{agent:16s} {shown}  {row['episodes']:8d}")
    return "\n".join([*lines, *loss_table(group["agents"])])


def interval(score: dict[str, float | None], factor: float = 100.0, sign: str = "") -> str:
    """A score with its interval in words, "81.0 [75.2, 86.9]"; "–" where it is undefined.

    `factor`: that of the unit in which it is shown; `sign`: "+" shows a plus, too.
    """
    made = Score(**score)
    if made.mean is None or made.low is None or made.high is None:
        return "–"
    return " ".join(
        (f"{factor * made.mean:{sign}.1f}", f"[{factor * made.low:{sign}.1f}, {factor * made.high:{sign}.1f}]")
    )
