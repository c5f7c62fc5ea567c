"""Writes episodes so that nothing can leave one half written.

An episode is first a folder `.s000012.part-PID`. Its files are brought to the disk, the folder gets its name, and only
then one line is appended to the manifest. A process that is killed leaves a part, which the next one deletes, or a
whole folder without a line, which `hazard-ms demos repair` and every further recording enter.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.claims import publishing, tag
from hazard_ms.demonstrations.layout import (
    EPISODE,
    FAILURES,
    FORMAT,
    MANIFEST,
    DamagedDatasetError,
    Entry,
    content_of,
    files_of,
    hashes_of,
    name_of,
)
from hazard_ms.demonstrations.reading import read_episode
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec.storage.files import flush

CHECKSUM = "checksum"  # key of episode.json: the hash of everything else in it


def begin(dataset: Path, seed: int) -> Path:
    """A new, empty folder for the files of an episode, which this process has claimed; earlier parts are deleted."""
    for left in parts(dataset, seed):
        shutil.rmtree(left)
    part = dataset / f"{tag(seed)}.part-{os.getpid()}"
    part.mkdir()
    return part


def parts(dataset: Path, seed: int | None = None) -> Iterator[Path]:
    """Folders of episodes that are not finished: of one `seed`, or of all. Links are none."""
    found = sorted(dataset.glob(f"{'.s*' if seed is None else tag(seed)}.part-*"))
    yield from (path for path in found if path.is_dir() and not path.is_symlink())


def put_arrays(path: Path, arrays: dict[str, NDArray[Any]]) -> None:
    """Write arrays, [...] each, in any unit [SI], as a compressed .npz file; its bytes depend on nothing else."""
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # type: ignore[arg-type]  # numpy's own flag has a name that arrays have not
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(packed.getvalue())


def describe(part: Path, result: EpisodeResult, meta: dict[str, Any]) -> None:
    """Write episode.json, the last file of an episode: `result` without times and machines, `meta`, and hashes."""
    plain = replace(result, wall_seconds=0.0, phase_seconds={}, versions={}, machine={})
    row = {"format": FORMAT, **meta, "result": plain.to_dict(), "hashes": hashes_of(part)}
    row[CHECKSUM] = _checksum(row)
    (part / EPISODE).write_text(json.dumps(row, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def entry_of(folder: Path) -> Entry:
    """The line of a manifest that an episode's own files support.

    Raises DamagedDatasetError for files that are not as they were written.
    """
    read = read_episode(folder)
    row = {"result": read.result.to_dict(), **read.meta}
    found, hashes = row.pop(CHECKSUM, ""), hashes_of(folder)
    others = {name: digest for name, digest in hashes.items() if name != EPISODE}
    if found != _checksum(row) or others != read.meta.get("hashes") or row.get("format") != FORMAT:
        raise DamagedDatasetError(f"{folder} must match its {EPISODE}, got other files or other content")
    result = read.result
    return Entry(
        name=name_of(result.scene, result.seed),
        seed=result.seed,
        scene=result.scene,
        frames=result.frames,
        decisions=len(result.decisions),
        value=result.tally.value,
        content=content_of(hashes),
        files=hashes,
        recipe=read.meta["recipe"],
        reason=read.meta["reason"],
        size=sum(path.stat().st_size for path in files_of(folder).values()),
    )


def publish(part: Path, dataset: Path, entry: Entry) -> Path:
    """Give the episode in `part` its name, among the failures if it has a `reason`, and enter it into the manifest.

    Returns its folder. Raises OSError where it cannot be written, and where there is a folder of that name.
    """
    shelf = dataset / FAILURES if entry.reason else dataset
    shelf.mkdir(exist_ok=True)
    if shelf != dataset and shelf.is_symlink():
        raise OSError(f"{shelf} must be a folder, got a link")
    for path in [*files_of(part).values(), *(p for p in part.rglob("*") if p.is_dir()), part]:
        flush(path)
    with publishing(dataset):
        place = shelf / entry.name
        os.replace(part, place)
        flush(shelf)
        append(shelf, entry)
    return place


def append(shelf: Path, entry: Entry) -> None:
    """Add a line to the manifest of `shelf` with one write, after the end of a line that was torn.

    Raises OSError where it cannot be written whole.
    """
    opened = os.open(shelf / MANIFEST, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW, 0o666)
    try:
        size = os.fstat(opened).st_size
        torn = size > 0 and os.pread(opened, 1, size - 1) != b"\n"
        line = ("\n" * torn + entry.line()).encode()
        if os.write(opened, line) != len(line):
            raise OSError(f"the manifest of {shelf} could not be written whole; free some space")
        os.fsync(opened)
    finally:
        os.close(opened)
    flush(shelf)


def _checksum(row: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(row, sort_keys=True).encode()).hexdigest()
