"""Reads recorded episodes: `for demonstration in demonstrations(Path("demos/HazardFire-v1/oracle")): ...`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.layout import (
    DECISIONS,
    EPISODE,
    FRAMES,
    MANIFEST,
    PRIVILEGED,
    TRUTH,
    VIDEO,
    DamagedDatasetError,
    Entry,
    hashes_of,
)
from hazard_ms.evaluation.result import EpisodeResult


@dataclass(frozen=True)
class Demonstration:
    """One recorded episode of T frames and N decisions; docs/demonstrations.md describes `meta` and all arrays."""

    folder: Path
    result: EpisodeResult
    meta: dict[str, Any]
    decisions: dict[str, NDArray[Any]]  # [N, ...] each
    frames: dict[str, NDArray[Any]]  # [T, ...] or [T + 1, ...] each

    @property
    def video(self) -> Path | None:
        """The film of the head camera, None where no pictures were recorded."""
        path = self.folder / VIDEO
        return path if path.exists() else None

    def privileged(self) -> dict[str, NDArray[Any]]:
        """The arrays [N, ...] that only a privileged teacher knows, with positions in [m]."""
        return arrays(self.folder / PRIVILEGED / TRUTH)


def demonstrations(folder: Path) -> Iterator[Demonstration]:
    """The episodes of a dataset in the order of its manifest, each compared with its hashes before it is read.

    Raises ValueError for a folder without a dataset, and a DamagedDatasetError for an episode that is not as it was
    written.
    """
    for entry in entries(folder):
        episode = folder / entry.name
        faults = differences(episode, entry)
        if faults:
            raise DamagedDatasetError(
                f"{episode} must be as its manifest says, got {', '.join(faults)}; "
                f"`hazard-ms demos repair {folder}` moves it aside"
            )
        read = read_episode(episode)
        known = replace(read.result, versions=entry.versions, machine=entry.machine, phase_seconds=entry.seconds)
        yield replace(read, result=known)


def entries(folder: Path) -> list[Entry]:
    """The lines of a dataset's manifest, without those that are torn; the last one of each name counts.

    Raises ValueError for a folder without a dataset, and for a dataset of another format.
    """
    path = folder / MANIFEST
    try:
        lines = path.read_bytes().splitlines()
    except OSError as error:
        raise ValueError(f"folder must be a dataset with a {MANIFEST}, got {folder}: {error.strerror}") from None
    found = (Entry.of_line(line) for line in lines)
    return list({entry.name: entry for entry in found if entry is not None}.values())


def differences(folder: Path, entry: Entry) -> list[str]:
    """The differences between the files of an episode and its manifest, in words; empty if there are none."""
    try:
        now = hashes_of(folder)
    except OSError as error:
        return [f"{error.filename}: {error.strerror}"]
    if not now:
        return [f"no folder {entry.name}"]
    made = [f"no {name}" for name in entry.files.keys() - now.keys()]
    made += [f"an unknown file {name}" for name in now.keys() - entry.files.keys()]
    made += [f"other bytes in {name}" for name, digest in entry.files.items() if now.get(name, digest) != digest]
    return sorted(made)


def read_episode(folder: Path) -> Demonstration:
    """The episode in a folder, whatever a manifest says. Raises DamagedDatasetError for files that cannot be read."""
    path = folder / EPISODE
    try:
        meta = json.loads(path.read_bytes())
        result = EpisodeResult.from_dict(meta.pop("result"))
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedDatasetError(
            f"{path} must describe an episode, got {type(error).__name__}: {error}; see `hazard-ms demos repair`"
        ) from None
    return Demonstration(folder, result, meta, arrays(folder / DECISIONS), arrays(folder / FRAMES))


def arrays(path: Path) -> dict[str, NDArray[Any]]:
    """All arrays of a file, [...] each, in units [SI] that docs/demonstrations.md lists.

    Raises DamagedDatasetError where they cannot be read.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            return dict(file)
    except Exception as error:  # numpy and zipfile raise many kinds
        raise DamagedDatasetError(
            f"{path} must hold arrays, got {type(error).__name__}: {error}; see `hazard-ms demos repair`"
        ) from None
