"""Names and forms of the files of a dataset; docs/demonstrations.md describes every file and array.

OUT/HazardFire-v1/oracle/       a dataset: the episodes of one agent
  README.md                     what it holds
  manifest.jsonl                one line for each finished episode, appended last
  kitchen_a-07-s000012/         one episode
  failures/                     episodes that were not kept, with a manifest of their own
  damaged/                      what `hazard-ms demos repair` moved aside
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

FORMAT = 1  # goes up when a file or an array changes its meaning

MANIFEST, CARD = "manifest.jsonl", "README.md"
FAILURES, DAMAGED = "failures", "damaged"  # folders of a dataset
EPISODE, DECISIONS, FRAMES, VIDEO = "episode.json", "decisions.npz", "frames.npz", "head.mp4"  # files of an episode
DEPTH, LABELS, PRIVILEGED = "depth", "labels", "privileged"  # folders of an episode
TRUTH = "truth.npz"  # in PRIVILEGED
WHOLE = (EPISODE, DECISIONS, FRAMES)  # files that every episode has

STATE_EVERY = 10  # frames from one restorable state to the next [ours]
NO_LABEL = 65535  # of a pixel without a surface, in labels/
LABEL_SHIFT = 2  # pixels of labels/ hold the label of `sensing.camera` plus this: robot 0, structure 1, thing b b + 2


class DamagedDatasetError(ValueError):
    """Raised for a file of a dataset that is not as it was written."""


@dataclass(frozen=True)
class Entry:
    """One line of a manifest. Only `seconds`, `versions` and `machine` differ if the same episode is recorded again."""

    name: str  # of the folder
    seed: int
    scene: str
    frames: int
    decisions: int
    value: float  # rescued, as a share of all
    content: str  # SHA-256 of the names and the bytes of all files
    files: dict[str, str]  # SHA-256 of each file, by its path in the folder
    recipe: dict[str, Any]  # what the episodes of a dataset have in common, as `Recipe` in options.py makes it
    reason: str = ""  # why the episode was not kept; empty if it was
    verified: bool = False  # whether it was simulated again, and was the same
    size: int = 0  # of all files [bytes]
    seconds: dict[str, float] = field(default_factory=dict)  # wall times by phase [s]; empty if not known
    versions: dict[str, str] = field(default_factory=dict)  # of packages; empty if not known
    machine: dict[str, Any] = field(default_factory=dict)  # system, cores, GPU; empty if not known
    format: int = FORMAT

    def line(self) -> str:
        """The entry as one line of JSON, with its end."""
        return json.dumps(asdict(self), allow_nan=False, sort_keys=True) + "\n"

    @classmethod
    def of_line(cls, line: str | bytes) -> Entry | None:
        """The entry that `line` wrote; None for a line that is torn or damaged.

        Raises ValueError for an entry of another format.
        """
        try:
            row = json.loads(line)
            number = row["format"]
            if number == FORMAT:
                made = cls(**{f.name: row[f.name] for f in fields(cls)})
                return made if made.content == content_of(made.files) else None
        except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
            return None
        raise ValueError(f"the format of a dataset must be {FORMAT}, got {number!r:.100}; record it again")


def content_of(hashes: dict[str, str]) -> str:
    """The hash of a folder from the hashes of its files, by their paths."""
    return hashlib.sha256("".join(f"{name} {hashes[name]}\n" for name in sorted(hashes)).encode()).hexdigest()


def files_of(folder: Path) -> dict[str, Path]:
    """All files of an episode's folder by their paths in it, as in an `Entry`."""
    return {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}


def hashes_of(folder: Path) -> dict[str, str]:
    """The SHA-256 of each file of an episode's folder. Raises OSError for files that cannot be read."""
    return {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in files_of(folder).items()}


def name_of(scene: str, seed: int) -> str:
    """The name of an episode's folder."""
    return f"{plain(scene)}-s{seed:06d}"


def plain(name: str) -> str:
    """A name of a scene or an agent as the name of a folder."""
    return re.sub(r"[^\w.]+", "-", name).strip("-.") or "unnamed"


def datasets(folder: Path, failures: bool = False) -> Iterator[Path]:
    """The datasets in `folder` and the folders in it, those of failures only if asked for.

    They may be recorded meanwhile: folders of episodes may come and go. Raises ValueError where there are none.
    """
    found = sorted(Path(path) for path, _, files in os.walk(folder) if MANIFEST in files)
    kept = [path for path in found if failures or path.name != FAILURES or path == folder]
    if not kept:
        raise ValueError(f"folder must hold a dataset of `hazard-ms demos record`, got {folder}")
    yield from kept
