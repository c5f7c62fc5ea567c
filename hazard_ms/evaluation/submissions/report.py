"""The report of a verification: what was simulated, how each episode compares, and every fault by its name."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.replay import EXACT
from hazard_ms.evaluation.submissions.card import Card
from hazard_ms.evaluation.submissions.faults import Fault
from hazard_ms.evaluation.submissions.packing import MOST_EPISODES, Hash, Short
from hazard_ms.evaluation.submissions.tracks import Place
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.files import printable
from hazard_ms.spec.foreign.plain import Within

FORMAT = 1  # goes up when a field changes its meaning, goes away or is new
LARGEST = 4_000_000  # of a report [bytes]; one of 75 episodes has 60,000 [ours]
SUFFIX = ".report.json"
Amount = Annotated[float, Within(0, 1e12)]


@dataclass(frozen=True)
class Seen:
    """One episode as it was simulated.

    `decisions`: the SHA-256 of what was decided and waited; `course`: the last hash of the simulation, which decisions
    that change nothing do not change. Scores are those of the simulation.
    """

    env_id: Short
    seed: Annotated[int, Within(0, 2**32 - 1)]
    scene: Short
    verdict: Short  # exact, same score or different
    tally: Tally
    frames: Annotated[int, Within(0, 10_000_000)]
    decisions: Hash
    course: Hash
    averted: Annotated[float | None, Within(-1e9, 1 + 1e-9)] = (
        None  # None where the track does not ask or it is undefined
    )

    @property
    def place(self) -> Place:
        """Task and seed."""
        return self.env_id, self.seed


@dataclass(frozen=True)
class Claim:
    """The cost that a submission claims, which nobody can verify: means of an episode.

    `counters`: the agent's own, such as tokens; `agent_seconds`: wall time in which it chose [s]; `thought_seconds`:
    time by the clock of the track [s].
    """

    counters: Annotated[dict[str, float], Within(0, 100)]
    agent_seconds: Amount
    thought_seconds: Amount


@dataclass(frozen=True)
class Sample:
    """The episodes that were drawn for a quick look: how many, and by which seed."""

    episodes: Annotated[int, Within(1, MOST_EPISODES)]
    seed: Annotated[int, Within(0, 2**32 - 1)]


@dataclass(frozen=True)
class Report:
    """A verification: the submission by its SHA-256, what was simulated, with which versions and machine, and when."""

    submission: Hash
    track: Short
    episodes: Annotated[int, Within(0, MOST_EPISODES)]  # that the track asks for
    agent: Annotated[str, Within(0, 1_000)]
    card: Card | None  # None where it could not be read
    seen: Annotated[tuple[Seen, ...], Within(0, MOST_EPISODES)]
    faults: Annotated[tuple[Fault, ...], Within(0, 1_000)]
    date: Annotated[str, Within(20, 20)]  # of the verification, "2027-01-31T12:00:00Z"
    played_with: dict[str, Short] = field(default_factory=dict)  # versions, as the submission says
    played_on: dict[str, Any] = field(default_factory=dict)  # machine, as the submission says
    versions: dict[str, Short] = field(default_factory=dict)  # here
    machine: dict[str, Any] = field(default_factory=dict)  # here
    claim: Claim | None = None
    sample: Sample | None = None  # None where all episodes were simulated
    format: int = FORMAT

    @property
    def verified(self) -> bool:
        """Whether every episode of the track was simulated and found as the submission tells."""
        exact = all(one.verdict == EXACT for one in self.seen)
        return exact and not self.faults and self.sample is None and len(self.seen) == self.episodes > 0

    @property
    def verdict(self) -> str:
        """The verdict in words."""
        if self.faults:
            return "not verified: " + ", ".join(dict.fromkeys(fault.kind for fault in self.faults))
        if self.verified:
            return f"verified: all {self.episodes} episodes"
        return f"no fault in {len(self.seen)} of {self.episodes} episodes: the rest was not simulated"

    def to_json(self) -> str:
        """The report as JSON, with its verdict in words."""
        return json.dumps({"verdict": self.verdict, **dataclasses.asdict(self)}, indent=1, allow_nan=False) + "\n"


def read_report(path: Path) -> Report:
    """The report in a file. Raises ValueError for anything else, and for a verdict that its parts do not give."""
    shown = printable(path.name)
    row = plain.read(path, LARGEST, shown)
    if row.get("format") != FORMAT:
        raise ValueError(f"format of {shown} must be {FORMAT}, got {row.get('format')!r:.100}")
    told = row.pop("verdict", None)
    found: Report = plain.made(Report, row, f"report {shown}")
    if told != found.verdict:
        raise ValueError(f"verdict of {shown} must be {found.verdict!r}, got {told!r:.200}")
    if len({one.place for one in found.seen}) != len(found.seen):
        raise ValueError(f"report {shown} must hold each episode once")
    return found
