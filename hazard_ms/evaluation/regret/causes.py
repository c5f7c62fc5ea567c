"""The cause of each decision's regret, by the definitions of docs/regret.md, and the record of a whole episode.

All values are shares of that of all targets. They add up: what the best plan could have rescued from the start on, less
what was rescued, is the sum of all parts of `EpisodeRegret.lost`. In homes what is not lost when time is up counts in
place of what is rescued, and plans have measures about the hazard, too (`averts`).
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

from hazard_ms.evaluation.result import LARGEST, LIMITS, REGRET, Frame
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.files import printable, sha256_of
from hazard_ms.spec.foreign.plain import Within
from hazard_ms.spec.storage.files import write

FORMAT = 2  # goes up when a field changes its meaning
LEAST = 0.02  # share of the value of all targets, beyond which a decision's regret has a cause
EXPLAINED = 0.5  # at most this share of a regret may be left without its cause [ours]

PERCEPTION, MEMORY, BY_FORMAT, LATENCY, PLANNING = "perception", "memory", "format", "latency", "planning"
MITIGATION = "mitigation"
UNSEEN, SMALL, EXECUTION, ENDED = "unseen", "small", "execution", "ended"
CAUSES = (PERCEPTION, MEMORY, BY_FORMAT, LATENCY, MITIGATION, PLANNING)  # of a decision, the first that fits
PARTS = (*CAUSES, UNSEEN, SMALL, EXECUTION, ENDED)
Share = Annotated[float, Within(-1000, 1000)]  # of the value of all targets; what was lost or gained by it [ours]


@dataclass(frozen=True)
class Without:
    """The regret that a choice would have without one thing that went wrong, and that thing in words."""

    regret: float
    what: str


@dataclass(frozen=True)
class Appraisal:
    """One decision as it is seen afterwards."""

    frame: int  # at which the agent saw what it decided on
    verb: str
    target: str | None
    best: float  # value that the best plan reached from there
    regret: float  # how much less the best course reaches that begins with the choice
    seen: float  # the same among the targets that had been seen: no agent could have known of the others
    without: Mapping[str, Without] = field(default_factory=dict)  # by cause
    instead: str = ""  # what the best plan began with, in words
    mistaken: str = ""  # what it was done to, in words, where that is no target and was taken for one


@dataclass(frozen=True)
class DecisionRegret:
    """The regret of one decision, and what its skill lost afterwards.

    `regret` is `best` less what the choice leaves; `unseen` is the part of it that no agent could have known of;
    `execution` is negative where the skill went better than usual.
    """

    frame: Frame
    verb: str
    target: str | None
    best: Share
    regret: Share
    unseen: Share
    execution: Share
    cause: str = ""  # one of CAUSES, or UNSEEN; empty where the regret is small
    evidence: str = ""  # a sentence


@dataclass(frozen=True)
class EpisodeRegret:
    """The regret of the decisions of one episode, and what was lost by each of PARTS."""

    result: str  # SHA-256 of the result's file
    agent: str
    seed: int
    scene: str
    start: Share  # value that the best plan reached from the start
    value: Share  # that was rescued
    lost: dict[str, Share]
    decisions: Annotated[tuple[DecisionRegret, ...], Within(0, 20_000)]
    averts: bool = False  # whether what is not lost counts, and not what is rescued
    format: int = FORMAT

    def write(self, path: Path) -> None:
        """Write it as JSON, whole or not at all. Raises ValueError where the file cannot be written."""
        write(path, json.dumps(dataclasses.asdict(self), indent=1, allow_nan=False) + "\n")

    @classmethod
    def read(cls, path: Path) -> EpisodeRegret:
        """The regret that `write` wrote. Raises ValueError that names the file for any other content."""
        try:
            row = plain.read(path, LARGEST)
            if row.get("format") != FORMAT:
                raise ValueError(f"format {row.get('format')!r:.100} instead of {FORMAT}")
            found: EpisodeRegret = plain.made(cls, row, "regret", LIMITS)
            for part in PARTS:
                one_of(part, found.lost, "a part of what was lost")
            for decision in found.decisions:
                one_of(decision.cause, (*CAUSES, UNSEEN, ""), "cause of a regret")
        except ValueError as error:
            raise ValueError(
                f"{printable(str(path))} must hold what `hazard-ms regret` wrote: {error}; delete it"
            ) from None
        return found


def place_of(result: Path) -> Path:
    """The file for the regret of the episode whose result is in the file `result`."""
    return result.with_suffix(REGRET)


def digest(result: Path) -> str:
    """The SHA-256 of a result's file. Raises ValueError where it cannot be read."""
    try:
        return sha256_of(result, LARGEST)
    except ValueError as error:
        raise ValueError(f"{printable(str(result))} must hold the result of an episode: {error}") from None


def beside(result: Path) -> EpisodeRegret | None:
    """The regret beside the result in a file, None where there is none, or one of another result.

    Raises ValueError for a damaged file.
    """
    place = place_of(result)
    found = EpisodeRegret.read(place) if place.exists() else None
    return found if found is not None and found.result == digest(result) else None


def cause_of(appraisal: Appraisal, fallback: bool) -> tuple[str, str]:
    """The cause of a decision's regret, one of CAUSES or UNSEEN, and a sentence that says why; both empty if small.

    `fallback`: whether the choice stood in for an answer that could not be read.
    """
    if appraisal.regret <= LEAST:
        return "", ""
    if appraisal.mistaken:
        return PERCEPTION, appraisal.mistaken
    if appraisal.seen <= LEAST:
        return UNSEEN, f"{_percent(appraisal.regret)} lies in targets that had not been seen yet"
    for cause in (PERCEPTION, MEMORY):
        found = _explained(appraisal, cause)
        if found:
            return cause, found
    if fallback:
        return BY_FORMAT, "the agent's answer could not be read, and something else was done in its place"
    for cause in (LATENCY, MITIGATION):
        found = _explained(appraisal, cause)
        if found:
            return cause, found
    return PLANNING, f"{appraisal.instead or 'another choice'} was worth {_percent(appraisal.seen)} more"


def _explained(appraisal: Appraisal, cause: str) -> str:
    """A sentence that says how `cause` explains the regret among the targets that were seen; empty if it does not."""
    other = appraisal.without.get(cause)
    if other is None or other.regret > EXPLAINED * appraisal.seen:
        return ""
    lost = f"{100.0 * other.regret:.1f} instead of {_percent(appraisal.seen)}"
    return f"{other.what}; without that the choice loses {lost}"


def decisions_of(
    appraisals: Sequence[Appraisal],
    fallbacks: Sequence[bool],
    landings: Sequence[float],
    frames: Sequence[int] | None = None,
) -> tuple[DecisionRegret, ...]:
    """The regrets of all decisions of an episode.

    `landings`: the values that the best plan reached after each decision, or that was rescued if it was the last;
    `frames` that passed with each, None where all took time: what failed at once has lost nothing.
    """
    made, frames = [], [1] * len(appraisals) if frames is None else frames
    for one, fallback, landing, passed in zip(appraisals, fallbacks, landings, frames, strict=True):
        if not passed:
            lost = max(one.best - landing, 0.0)
            one = replace(one, regret=min(one.regret, lost), seen=min(one.seen, lost))
        if one.mistaken:  # all that it lost in the end was lost by the choice
            lost = max(one.regret, one.best - landing)
            one = replace(one, regret=lost, seen=lost)
        cause, evidence = cause_of(one, fallback)
        unseen = one.regret - min(one.seen, one.regret) if cause else 0.0
        execution = one.best - one.regret - landing
        row = DecisionRegret(one.frame, one.verb, one.target, one.best, one.regret, unseen, execution, cause, evidence)
        made.append(row)
    return tuple(made)


def lost_by(decisions: Sequence[DecisionRegret], ended: float) -> dict[str, float]:
    """The loss by each of PARTS; `ended`: what could still be rescued when an agent failed or died."""
    lost = dict.fromkeys(PARTS, 0.0)
    lost[ENDED] = ended
    for row in decisions:
        lost[UNSEEN] += row.unseen
        lost[EXECUTION] += row.execution
        lost[SMALL if row.cause in ("", UNSEEN) else row.cause] += row.regret - row.unseen
    return lost


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} % of the value"
