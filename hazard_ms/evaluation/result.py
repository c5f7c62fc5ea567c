"""The result of one episode as JSON: what happened, with which versions and machine, and how to play it again.

`FORMAT` goes up whenever a field changes its meaning or goes away; `EpisodeResult.read` refuses other formats.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import importlib.metadata
import json
import os
import platform
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, get_type_hints

from hazard_ms.agents.thinking import OFF
from hazard_ms.evaluation.metrics import Fate, Tally, damage, step, value
from hazard_ms.machine.files import write
from hazard_ms.registry.detectors import TRUTH
from hazard_ms.registry.version import __version__

FORMAT = 2  # goes up when a field changes its meaning
BROKEN = "simulation error"  # how an episode ends if its simulation breaks
STUCK = "too many decisions"  # how it ends after 100 in a row that took no time
ERROR, TOO_SLOW, DIED = "error", "too slow", "worker died"
FAILED = (ERROR, TOO_SLOW, DIED)  # how an episode ends that its agent, or the process playing it, did not finish
PACKAGES = ("sapien", "mani-skill", "gymnasium", "torch", "warp-lang", "numpy")  # whose versions can change an episode

# fields that hold more data
PLAIN = ("settings", "targets", "decisions", "links", "phase_seconds", "counters", "versions", "machine", "files")


class DamagedResultError(ValueError):
    """Raised for a file that does not hold the whole result of an episode."""


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
    waited: int = 0  # frames that passed while the agent chose
    fallback: bool = False  # whether it stands in for an answer that could not be read
    thought: float = 0.0  # time that the agent took to choose, by the clock of the episode [s]; 0 without one


REGRET = ".regret.json"  # end of the names of the files that `hazard-ms regret` writes beside results


@dataclass(frozen=True)
class Link:
    """One link of the chain of hashes: the state of everything at `frame`, and all links before it."""

    frame: int
    sha256: str


@dataclass(frozen=True)
class Played:
    """The course of an episode: why it `ended`, as `EpisodeResult` describes it, every decision, and where time went.

    `phase_seconds` are wall times: to "build" the environment and the scene, of "looks" through the camera, of the
    "agent", and of the "physics" of hazards and robot, with everything else that passes in a frame.
    """

    ended: str
    decisions: tuple[DecisionRecord, ...]
    links: tuple[Link, ...]
    phase_seconds: dict[str, float]
    counters: dict[str, float] = field(default_factory=dict)  # the agent's own


@dataclass(frozen=True)
class EpisodeResult:
    """Everything about one episode that is worth keeping; it is written with the scores of the episode under "score".

    `ended` is one of: what the task's goal says when it is achieved ("all rescued"); "failed", when it never can be;
    "stopped", by the agent, or the word that it has for that ("budget"); "time", when the last frame has passed;
    "simulation error"; "too many decisions", when 100 in a row took no time; "frame reached", for a run that
    was asked to end at a frame; "error", when the agent raised an error or chose what is not an action; "too slow",
    when a decision took it longer than allowed; "worker died", when the process that played it died twice. After the
    last three all is as it was at the last decision, and scored as it was then.
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
    links: tuple[Link, ...] = ()  # by which a replay is known to be the same episode
    error: str = ""  # the agent's, or why there was no answer
    wall_seconds: float = 0.0
    phase_seconds: dict[str, float] = field(default_factory=dict)  # wall time by phase, as in `Played` [s]
    clock: str = OFF  # by which hazards went on while the agent thought
    perception: str = TRUTH  # what told the agent of things
    counters: dict[str, Any] = field(default_factory=dict)  # the agent's own counts, such as calls of a model
    files: dict[str, str] = field(default_factory=dict)  # SHA-256 of those that agent and perception name, by path
    versions: dict[str, str] = field(default_factory=lambda: versions())
    machine: dict[str, Any] = field(default_factory=lambda: machine())
    format: int = FORMAT

    @property
    def tally(self) -> Tally:
        """The part of the episode in the scores."""
        return Tally.of(self.targets)

    @property
    def latency(self) -> float | None:
        """Mean time that the agent took to choose, by the clock [s]: Respond Latency; None without decisions."""
        return sum(d.thought for d in self.decisions) / len(self.decisions) if self.decisions else None

    @property
    def latency_share(self) -> float | None:
        """Share of the frames of all decisions in which the agent was thinking: LAR; None where none passed."""
        waited = sum(d.waited for d in self.decisions)
        return waited / frames if (frames := waited + sum(d.frames for d in self.decisions)) else None

    def to_dict(self) -> dict[str, Any]:
        """Plain data, with the scores of this one episode."""
        tallies = [self.tally]
        score = {"value": value(tallies), "step": step(tallies), "damage": damage(tallies)}
        if self.clock != OFF:
            score |= {"latency": self.latency, "latency_share": self.latency_share}
        return {"score": score, **dataclasses.asdict(self)}

    def to_json(self) -> str:
        """The result as JSON, with the scores of this episode."""
        return json.dumps(self.to_dict(), indent=1, allow_nan=False) + "\n"

    def write(self, path: Path) -> None:
        """Write it as JSON, whole or not at all. Raises ValueError where the file cannot be written."""
        write(path, self.to_json())

    @classmethod
    def read(cls, path: Path) -> EpisodeResult:
        """The result that `write` wrote.

        Raises ValueError for a file of another format, and a DamagedResultError for one that holds no whole result.
        """
        try:
            content = path.read_bytes()
            if not content.strip(b"\0 \n"):  # what a power failure leaves
                raise ValueError("an empty file")
            row = json.loads(content)
            number = row["format"]
            if number == FORMAT:
                return cls.from_dict(row)
        except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
            raise DamagedResultError(
                f"{path} must hold the result of an episode, got {type(error).__name__}: {error}"
            ) from None
        raise ValueError(
            f"the format of {path} must be {FORMAT}, got {number!r:.100}; play its episode again, in another folder"
        )

    @classmethod
    def from_dict(cls, row: dict[str, Any]) -> EpisodeResult:
        """The result that `to_dict` gave. Raises LookupError, TypeError, AttributeError or ValueError for all else."""
        row = {name: entry for name, entry in row.items() if name != "score"}
        row["targets"] = tuple(_made(Fate, t) for t in row["targets"])
        row["decisions"] = tuple(_made(DecisionRecord, d) for d in row["decisions"])
        row["links"] = tuple(_made(Link, each) for each in row["links"])
        found: EpisodeResult = _made(cls, row)
        found.to_dict()
        return found


def _made(kind: Any, row: dict[str, Any]) -> Any:
    """A dataclass from its fields. Raises TypeError or ValueError for fields and types that it does not have."""
    for name, hint in _hints(kind).items():
        plain = (dict, tuple) if name in PLAIN else None
        if name in row and not isinstance(row[name], plain or (int | float if hint is float else hint)):
            raise ValueError(f"{name} = {row[name]!r:.100}")
    return kind(**row)


_hints = functools.cache(get_type_hints)  # which takes longer than all else about reading a result


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


def file_hashes(*texts: str) -> dict[str, str]:
    """SHA-256 of the files that the texts of an agent and a perception name, such as weights, by path."""
    named = {part for text in texts for part in re.split("[:,=]", text)}
    return {part: hashlib.sha256(Path(part).read_bytes()).hexdigest() for part in sorted(named) if Path(part).is_file()}


def result_files(folders: Sequence[Path]) -> list[Path]:
    """The files in `folders` and the folders in them that may hold results, in order; not those of their regrets.

    Raises ValueError for a folder that does not exist.
    """
    for folder in folders:
        if not folder.is_dir():
            raise ValueError(f"folder must be one that `hazard-ms evaluate -o FOLDER` wrote, got {folder}")
    found = {path.resolve() for folder in folders for path in folder.rglob("*.json")}
    return sorted(path for path in found if not path.name.endswith(REGRET))
