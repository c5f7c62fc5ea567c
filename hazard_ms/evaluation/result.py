"""The result of one episode as JSON: what happened, with which versions and machine, and how to play it again.

`FORMAT` goes up whenever a field changes its meaning, goes away or is new; `EpisodeResult.read` reads those `READABLE`.
"""

from __future__ import annotations

import dataclasses
import json
import os
import platform
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from hazard_ms.agents.latency import OFF
from hazard_ms.evaluation.averted.loss import Loads, Loss, averted, averted_of_all
from hazard_ms.evaluation.metrics import Fate, Tally, damage, step, value
from hazard_ms.evaluation.teams.fields import TEAM_FORMAT, check, told
from hazard_ms.machine.diagnosis import installed_version
from hazard_ms.sensing.detection.eyes import EYES
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.files import printable, read_foreign, sha256_of
from hazard_ms.spec.foreign.plain import Within
from hazard_ms.spec.registry.detectors import TRUTH
from hazard_ms.spec.registry.version import __version__
from hazard_ms.spec.storage.files import write

FORMAT = 3  # of results of one robot; goes up when a field changes its meaning, or is new
READABLE = (2, FORMAT, TEAM_FORMAT)  # formats that are read: files of format 2 tell nothing of what was lost
BROKEN = "simulation error"  # how an episode ends if its simulation breaks
STUCK = "too many decisions"  # how it ends after 100 in a row that took no time
ERROR, TOO_SLOW, DIED = "error", "too slow", "worker died"
FAILED = (ERROR, TOO_SLOW, DIED)  # how an episode ends that its agent, or the process playing it, did not finish
REGRET = ".regret.json"  # end of the names of the files that `hazard-ms regret` writes beside results
ALONE = ".alone.json"  # end of those that tell what is lost if nobody acts
PACKAGES = ("sapien", "mani-skill", "gymnasium", "torch", "warp-lang", "numpy")  # whose versions can change an episode

LARGEST = 64_000_000  # of a result's file [bytes]; one of a long episode has 200,000 [ours]
LONGEST_SETTINGS = 4_000  # [characters] [ours]
LIMITS = plain.Limits(longest_text=100_000)  # characters of a note [ours]
Frame = Annotated[int, Within(0, 10_000_000)]  # [ours]
Seconds = Annotated[float, Within(0, 1e9)]  # [s] [ours]
Share = Annotated[float, Within(0, 1 + 1e-9)]  # of the value of all targets
Name = Annotated[str, Within(0, 1_000)]  # [characters] [ours]


class DamagedResultError(ValueError):
    """Raised for a file that does not hold the whole result of an episode."""


@dataclass(frozen=True)
class DecisionRecord:
    """One decision: what was chosen when, why, and how it went."""

    frame: Frame  # at which it was taken
    verb: Name
    target: Annotated[str | None, Within(0, 1_000)]
    ok: bool
    reason: Name  # of a failure
    frames: Frame  # that the action took
    note: str = ""  # the agent's own words
    held: Annotated[str | None, Within(0, 1_000)] = None  # at the decision
    value: Share = 0.0  # rescued by then, as a share of all
    waited: Frame = 0  # frames that passed while the agent chose
    fallback: bool = False  # whether it stands in for an answer that could not be read
    thought: Seconds = 0.0  # time that the agent took to choose, by the clock of the episode [s]; 0 without one
    robot: Name = ""  # of a team, which did it; empty for a single robot


@dataclass(frozen=True)
class Link:
    """One link of the chain of hashes: the state of everything at `frame`, and all links before it."""

    frame: Frame
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
    "simulation error"; "too many decisions", when 100 in a row took no time; "frame reached" and "end of record", for
    runs that were to end there; "error", when the agent raised an error or chose what is not an action; "too slow",
    when a decision took it longer than allowed; "worker died", when the process that played it died twice. After the
    last three all is as it was at the last decision, and scored as it was then.
    """

    env_id: Name
    agent: Name
    seed: Annotated[int, Within(0, 2**32 - 1)]
    scene: Name
    settings: dict[str, Any]  # keywords of gym.make; light, effects and perturbation only where not the usual ones
    frames: Frame
    max_frames: Annotated[int, Within(1, 10_000_000)]
    ended: Name  # why
    targets: Annotated[tuple[Fate, ...], Within(1, 1_000)]
    decisions: Annotated[tuple[DecisionRecord, ...], Within(0, 20_000)]  # of all robots, as they were taken
    command: str  # that plays it again
    links: tuple[Link, ...] = ()  # by which a replay is known to be the same episode
    error: str = ""  # the agent's, or why there was no answer
    wall_seconds: Seconds = 0.0
    phase_seconds: dict[str, Seconds] = field(default_factory=dict)  # wall time by phase, as in `Played` [s]
    clock: str = OFF  # by which hazards went on while the agent thought
    perception: str = TRUTH  # what told the agent of things
    eyes: Annotated[str, Within(0, 100)] = EYES  # with which it looked: see `hazard_ms.sensing.detection.eyes`
    counters: dict[str, float] = field(default_factory=dict)  # the agent's own counts, such as calls of a model
    files: dict[str, str] = field(default_factory=dict)  # SHA-256 of those that agent and perception name, by path
    lost: Loss | None = None  # when the task's time was up; None where nobody asked
    lost_alone: Loss | None = None  # the same if nobody acts
    loads: Loads | None = None  # on a single robot; None where nobody asked
    robot_loads: dict[str, Loads] | None = None  # on each robot of a team, by its name
    robot_collisions: Frame | None = None  # of robots of a team with one another; None for a single robot
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

    @property
    def averted(self) -> float | None:
        """The share of the targets' value lost if nobody acts that is saved; None where it is undefined or unknown."""
        return averted(self.lost, self.lost_alone)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, with the scores of this one episode."""
        tallies = [self.tally]
        score = {"value": value(tallies), "step": step(tallies), "damage": damage(tallies)}
        if self.clock != OFF:
            score |= {"latency": self.latency, "latency_share": self.latency_share}
        if self.lost is not None:
            score |= {"averted": self.averted, "averted_of_all": averted_of_all(self.lost, self.lost_alone)}
        return {"score": score, **told(dataclasses.asdict(self))}

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
        shown = printable(str(path))
        try:
            content = read_foreign(path, LARGEST)
            if not content.strip(b"\0 \n"):  # what a power failure leaves
                raise ValueError("it is empty")
            row = plain.parse(content, "it")
            if not isinstance(row, dict) or "format" not in row:
                raise ValueError("it is not an object with a format")
            number = row["format"]
            if number in READABLE:
                return cls.from_dict(row)
        except ValueError as error:
            raise DamagedResultError(f"{shown} must hold the result of an episode: {error}") from None
        raise ValueError(
            f"the format of {shown} must be one of {', '.join(map(str, READABLE))}, got {number!r:.100}; "
            "play its episode again, in another folder"
        )

    @classmethod
    def from_dict(cls, row: Any) -> EpisodeResult:
        """The result that `to_dict` gave. Raises ValueError that names the first value that no episode has."""
        if not isinstance(row, dict):
            raise ValueError(f"a result must be an object, got {type(row).__name__}")
        own = {name: entry for name, entry in row.items() if name != "score"}
        found: EpisodeResult = plain.made(cls, own, "result", LIMITS)
        if len(repr(found.settings)) > LONGEST_SETTINGS:
            raise ValueError(f"settings must have at most {LONGEST_SETTINGS} characters, got more")
        if found.frames > found.max_frames:
            raise ValueError(f"frames must be at most max_frames, {found.max_frames}, got {found.frames}")
        robots = (*(d.robot for d in found.decisions), *(found.robot_loads or ()))
        check(found.settings, found.format, robots, found.robot_collisions)
        return found


def versions() -> dict[str, str]:
    """Versions of this package and of those that can change an episode; "absent" where one is not installed."""
    found = {"hazard-ms": __version__, "python": platform.python_version()}
    for name in PACKAGES:
        found[name] = installed_version(name) or "absent"
    return found


def machine() -> dict[str, Any]:
    """The kind of this machine: system, cores and GPU, but not whose it is."""
    import torch

    gpu = torch.cuda.get_device_name(0) if torch.cuda.is_available() else None
    return {"system": f"{platform.system()} {platform.machine()}", "cores": os.cpu_count(), "gpu": gpu}


def file_hashes(*texts: str) -> dict[str, str]:
    """SHA-256 of the files that the texts of an agent and a perception name, such as weights, by path."""
    named = {part for text in texts for part in re.split("[:,=]", text)}
    return {part: sha256_of(Path(part)) for part in sorted(named) if Path(part).is_file()}


def result_files(folders: Sequence[Path]) -> list[Path]:
    """The files in `folders` and the folders in them that may hold results, in order; not those that belong to these.

    Raises ValueError for a folder that does not exist.
    """
    for folder in folders:
        if not folder.is_dir():
            raise ValueError(f"folder must be one that `hazard-ms evaluate -o FOLDER` wrote, got {folder}")
    found = {path.resolve() for folder in folders for path in folder.rglob("*.json")}
    return sorted(path for path in found if not path.name.endswith((REGRET, ALONE)))
