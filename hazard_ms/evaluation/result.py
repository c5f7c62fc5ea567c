"""The result of one episode as JSON: what happened, with which versions and machine, and how to play it again.

`FORMAT` goes up whenever a field changes its meaning or goes away; `EpisodeResult.read` refuses other formats.
"""

from __future__ import annotations

import dataclasses
import importlib.metadata
import json
import os
import platform
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hazard_ms import __version__
from hazard_ms.evaluation.metrics import Fate, Tally, damage, step, value

FORMAT = 1  # goes up when a field changes its meaning
PACKAGES = ("sapien", "mani-skill", "gymnasium", "torch", "warp-lang", "numpy")  # whose versions can change an episode


@dataclass(frozen=True)
class DecisionRecord:
    """One decision: what was chosen when, why, and how it went."""

    frame: int  # at which it was taken
    verb: str
    target: str | None
    ok: bool
    reason: str  # of a failure
    frames: int  # that the action took
    note: str = ""  # the agent's own words
    held: str | None = None  # at the decision
    value: float = 0.0  # rescued by then, as a share of all


@dataclass(frozen=True)
class EpisodeResult:
    """All about one episode that is worth keeping; it is written with the scores of the episode under "score".

    `ended` is one of: what the task's goal says when it is achieved ("all rescued"); "failed", when it never can be;
    "stopped", by the agent; "time", when the last frame has passed; "simulation error"; "too many decisions", for an
    agent whose actions take no time; "frame reached", for a run that was asked to end at a frame.
    """

    env_id: str
    agent: str
    seed: int
    scene: str
    settings: dict[str, Any]  # keywords of gym.make; lighting and effects only where they are not the usual ones
    frames: int
    max_frames: int
    ended: str  # why
    targets: tuple[Fate, ...]
    decisions: tuple[DecisionRecord, ...]
    command: str  # that plays it again
    wall_seconds: float = 0.0
    versions: dict[str, str] = field(default_factory=lambda: versions())
    machine: dict[str, Any] = field(default_factory=lambda: machine())
    format: int = FORMAT

    @property
    def tally(self) -> Tally:
        """The part of the episode in the scores."""
        return Tally.of(self.targets)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, with the scores of this one episode."""
        tallies = [self.tally]
        score = {"value": value(tallies), "step": step(tallies), "damage": damage(tallies)}
        return {"score": score, **dataclasses.asdict(self)}

    def write(self, path: Path) -> None:
        """Write it as JSON, with the scores of this episode."""
        path.write_text(json.dumps(self.to_dict(), indent=1, allow_nan=False) + "\n")

    @classmethod
    def read(cls, path: Path) -> EpisodeResult:
        """The result that `write` wrote. Raises ValueError for a file of another format."""
        row = json.loads(path.read_text())
        if row.get("format") != FORMAT:
            raise ValueError(f"the format of {path.name} must be {FORMAT}, got {row.get('format')}")
        row.pop("score")
        row["targets"] = tuple(Fate(**t) for t in row["targets"])
        row["decisions"] = tuple(DecisionRecord(**d) for d in row["decisions"])
        return cls(**row)


def versions() -> dict[str, str]:
    """Versions of this package and of those that can change an episode; "absent" where one is not installed."""
    found = {"hazard-ms": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "absent"
    return found


def machine() -> dict[str, Any]:
    """The kind of this machine: system, cores and GPU, but not whose it is."""
    import torch

    gpu = torch.cuda.get_device_name(0) if torch.cuda.is_available() else None
    return {"system": f"{platform.system()} {platform.machine()}", "cores": os.cpu_count(), "gpu": gpu}
