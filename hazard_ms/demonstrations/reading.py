"""Reads recorded episodes: `for demonstration in demonstrations(Path("demos/HazardFire-v1/oracle")): ...`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from hazard_ms.demonstrations.layout import (
    DECISIONS,
    EPISODE,
    FILM,
    FRAMES,
    HEAD,
    MANIFEST,
    MOST_LINES,
    PRIVILEGED,
    TRUTH,
    DamagedDatasetError,
    Entry,
    files_of,
    hashes_of,
)
from hazard_ms.demonstrations.sound import (
    TRUTH_ARRAYS,
    Named,
    check_arrays,
    check_meta,
    check_shapes,
)
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec.foreign.arrays import read_arrays
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.plain import read

LARGEST_EPISODE = 32_000_000  # of episode.json [bytes]; a prompt has 2 to 5 thousand [ours]
MOST_UNPACKED = 200_000_000  # of each file of arrays [bytes]; all frames of a long episode have 20 million [ours]


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
        return self.films.get(HEAD)

    @property
    def films(self) -> dict[str, Path]:
        """The film of each camera by its name, that of the head first."""
        return films_in(self.folder)

    def privileged(self) -> dict[str, NDArray[Any]]:
        """The arrays [N, ...] that only a privileged teacher knows, with positions in [m].

        Raises DamagedDatasetError where they cannot be read, or do not fit the decisions.
        """
        path = self.folder / PRIVILEGED / TRUTH
        found, mask = arrays(path), self.decisions.get("mask")
        try:
            check_shapes(found, TRUTH_ARRAYS, TRUTH, {} if mask is None else dict(zip("NO", mask.shape, strict=False)))
        except ValueError as error:
            raise _damaged(path, "fit its decisions", error) from None
        return found


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
                f"{episode} must match its manifest, got {', '.join(faults)}; `hazard-ms demos repair {folder}` moves "
                "it aside"
            )
        read = read_episode(episode)
        known = replace(read.result, versions=entry.versions, machine=entry.machine, phase_seconds=entry.seconds)
        yield replace(read, result=known)


def entries(folder: Path) -> list[Entry]:
    """The lines of a dataset's manifest, without those that are torn; the last one of each name counts.

    Raises ValueError for a folder without a dataset, and for a dataset of another format.
    """
    found = (entry for _, entry in numbered(folder))
    return list({entry.name: entry for entry in found if entry is not None}.values())


def numbered(folder: Path) -> Iterator[tuple[int, Entry | None]]:
    """The lines of a dataset's manifest that are not empty, with their numbers from 1; None for those that are damaged.

    Raises ValueError as `entries` does.
    """
    path = folder / MANIFEST
    try:
        lines = read_foreign(path, MOST_LINES).splitlines()
    except ValueError as error:
        raise ValueError(f"folder must be a dataset with a {MANIFEST}, got {folder}: {error}") from None
    yield from ((number, Entry.of_line(line)) for number, line in enumerate(lines, 1) if line)


def whole_entries(folder: Path) -> list[Entry]:
    """The lines of a dataset's manifest, as `entries` gives them. Raises DamagedDatasetError if one is damaged, too."""
    for number, entry in numbered(folder):
        if entry is None:
            raise DamagedDatasetError(
                f"{folder / MANIFEST} must be whole, got a damaged line {number}; `hazard-ms demos repair {folder}` "
                "puts it in order"
            )
    return entries(folder)


def differences(folder: Path, entry: Entry) -> list[str]:
    """The differences between the files of an episode and its manifest, in words; empty if there are none."""
    try:
        now = hashes_of(folder)
    except DamagedDatasetError as error:
        return [str(error)]
    if not now:
        return [f"no folder {entry.name}"]
    made = [f"no {name}" for name in entry.files.keys() - now.keys()]
    made += [f"an unknown file {name}" for name in now.keys() - entry.files.keys()]
    made += [f"other bytes in {name}" for name, digest in entry.files.items() if now.get(name, digest) != digest]
    return sorted(made)


def read_episode(folder: Path) -> Demonstration:
    """The episode in a folder, whatever a manifest says. Raises DamagedDatasetError for files that cannot be read."""
    result, meta = described(folder)
    decisions, frames = arrays(folder / DECISIONS), arrays(folder / FRAMES)
    try:
        check_arrays(meta, decisions, frames)
    except ValueError as error:
        raise _damaged(folder, "hold arrays that fit each other", error) from None
    return Demonstration(folder, result, meta, decisions, frames)


def described(folder: Path) -> tuple[EpisodeResult, dict[str, Any]]:
    """The result in episode.json of a folder, and all else. Raises DamagedDatasetError as `read_episode`."""
    files_of(folder)
    path = folder / EPISODE
    try:
        meta = read(path, LARGEST_EPISODE)
    except ValueError as error:
        raise DamagedDatasetError(f"{error}; see `hazard-ms demos repair`") from None
    try:
        result = EpisodeResult.from_dict(meta.pop("result"))
        check_meta(meta)
    except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise _damaged(path, "describe an episode", error) from None
    return result, Named(str(path), meta)


def films_in(folder: Path) -> dict[str, Path]:
    """The films of cameras in the folder of an episode by the camera, that of the head first; no links."""
    named = (path for path in folder.glob("*" + FILM) if path.stem.isidentifier())
    found = [path for path in named if path.is_file() and not path.is_symlink()]
    return {path.stem: path for path in sorted(found, key=lambda path: (path.stem != HEAD, path.stem))}


def arrays(path: Path) -> dict[str, NDArray[Any]]:
    """All arrays of a file, [...] each, in units [SI] that docs/demonstrations.md lists.

    Raises DamagedDatasetError where they cannot be read; asking for one that the file lacks raises it, too.
    """
    try:
        return Named(str(path), read_arrays(path, MOST_UNPACKED))
    except ValueError as error:
        raise DamagedDatasetError(f"{error}; see `hazard-ms demos repair`") from None


def _damaged(path: Path, must: str, error: Exception) -> DamagedDatasetError:
    told = printable(f"{type(error).__name__}: {error}")
    return DamagedDatasetError(f"{path} must {must}, got {told:.300}; see `hazard-ms demos repair`")
