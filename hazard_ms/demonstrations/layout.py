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

from hazard_ms.spec.foreign import plain as foreign
from hazard_ms.spec.foreign.files import folder_name, printable, sha256_of

FORMAT = 1  # goes up when a file or an array changes its meaning

MANIFEST, CARD = "manifest.jsonl", "README.md"
FAILURES, DAMAGED = "failures", "damaged"  # folders of a dataset
EPISODE, DECISIONS, FRAMES = "episode.json", "decisions.npz", "frames.npz"  # files of an episode
FILM, HEAD = ".mp4", "head"  # how films of cameras end, after the name of the camera, and that of the head
DEPTH, LABELS, PRIVILEGED = "depth", "labels", "privileged"  # folders of an episode
TRUTH = "truth.npz"  # in PRIVILEGED
RESERVED = (MANIFEST, CARD, FAILURES, DAMAGED)  # that no episode is called

STATE_EVERY = 10  # frames from one restorable state to the next [ours]
NO_LABEL = 65535  # of a pixel without a surface, in labels/
MOST_LINES = 256_000_000  # of a manifest [bytes]; a line has 2 to 100 thousand [ours]
LONGEST_LINE, MOST_VALUES = 4_000_000, 100_000  # of it [bytes], [-] [ours]
MOST_FILES, MOST_BYTES = 20_000, 2_000_000_000  # of an episode, pictures of depth among them [-], [bytes] [ours]
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
        """The entry that `line` wrote; None for a line that is torn, damaged or impossible.

        Raises ValueError for an entry of another format.
        """
        row = _row(line)
        if row is None:
            return None
        if row["format"] != FORMAT:
            raise ValueError(
                f"the format of a dataset must be {FORMAT}, got {printable(repr(row['format']))[:100]}; record it again"
            )
        if any(f.name not in row for f in fields(cls)):
            return None
        try:
            made: Entry = foreign.made(cls, {f.name: row[f.name] for f in fields(cls)}, "a line")
            folder_name(made.name, "name")
        except ValueError:
            return None
        return made if made.name not in RESERVED and made.content == content_of(made.files) else None


def _row(line: str | bytes) -> dict[str, Any] | None:
    """The object with a format that a line of a manifest holds; None for one that is torn or absurd."""
    comma: Any = "," if isinstance(line, str) else b","
    if len(line) > LONGEST_LINE or line.count(comma) > MOST_VALUES:
        return None
    try:
        row = foreign.parse(line, "a line")
    except ValueError:
        return None
    return row if isinstance(row, dict) and "format" in row else None


def content_of(hashes: dict[str, str]) -> str:
    """The hash of a folder from the hashes of its files, by their paths."""
    return hashlib.sha256("".join(f"{name} {hashes[name]}\n" for name in sorted(hashes)).encode()).hexdigest()


def files_of(folder: Path) -> dict[str, Path]:
    """All files of an episode's folder by their paths in it, as in an `Entry`; none where there is no folder.

    Links are not followed. Raises DamagedDatasetError for a folder that is one, for anything in it but folders and
    regular files, for MOST_FILES and MOST_BYTES, and for what cannot be read.
    """
    if folder.is_symlink():
        raise DamagedDatasetError(f"{folder} must be a folder, got a link")
    found: dict[str, Path] = {}
    size, waiting = 0, [folder] if folder.is_dir() else []
    try:
        while waiting:
            for each in os.scandir(waiting.pop()):
                path = Path(each.path)
                if each.is_dir(follow_symlinks=False):
                    waiting.append(path)
                    continue
                if not each.is_file(follow_symlinks=False):
                    raise DamagedDatasetError(f"{path} must be a regular file, got a link, a pipe or a device")
                found[path.relative_to(folder).as_posix()] = path
                size += each.stat(follow_symlinks=False).st_size
                if len(found) > MOST_FILES or size > MOST_BYTES:
                    raise DamagedDatasetError(
                        f"{folder} must have at most {MOST_FILES} files and {MOST_BYTES} bytes in all, got more"
                    )
    except OSError as error:
        raise DamagedDatasetError(f"{error.filename} cannot be read: {error.strerror}") from None
    return dict(sorted(found.items(), key=lambda entry: entry[1]))


def hashes_of(folder: Path) -> dict[str, str]:
    """The SHA-256 of each file of an episode's folder. Raises DamagedDatasetError as `files_of` does."""
    try:
        return {name: sha256_of(path) for name, path in files_of(folder).items()}
    except DamagedDatasetError:
        raise
    except ValueError as error:
        raise DamagedDatasetError(str(error)) from None


def shelves(dataset: Path) -> list[Path]:
    """The folders of a dataset that have a manifest: its own, and that of what was not kept. Links count for none."""
    found = [dataset, dataset / FAILURES]
    return [shelf for shelf in found if (shelf / MANIFEST).exists() and (shelf == dataset or not shelf.is_symlink())]


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
