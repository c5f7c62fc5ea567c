"""Puts a dataset in order: `hazard-ms demos repair`, and the start of every recording."""

from __future__ import annotations

import os
import re
import shutil
from collections import Counter
from dataclasses import replace
from pathlib import Path

from hazard_ms.demonstrations.claims import claimed, repairing
from hazard_ms.demonstrations.layout import (
    CARD,
    DAMAGED,
    EPISODE,
    FAILURES,
    MANIFEST,
    MOST_LINES,
    DamagedDatasetError,
    Entry,
)
from hazard_ms.demonstrations.reading import differences, entries
from hazard_ms.demonstrations.store import entry_of, parts
from hazard_ms.spec.foreign.files import read_foreign
from hazard_ms.spec.storage.files import write

KEPT, ENTERED, MOVED, MISSING, REMOVED = "whole", "entered", "moved aside", "missing", "unfinished"
CLAIM = re.compile(r"\.s(\d+)\.(lock|part-\d+)")  # names of what an unfinished episode leaves


def repair(dataset: Path) -> Counter[str]:
    """Make manifests and folders of a dataset agree; nobody else's unfinished episodes are touched.

    Whole folders without a line are entered, damaged ones moved to damaged/, lines without a folder dropped, what
    killed processes left is deleted. Returns how many there were of each kind. Raises ValueError for a link in place of
    one of the dataset's own folders, files or locks.
    """
    for name in (FAILURES, DAMAGED):
        if (dataset / name).is_symlink():
            raise ValueError(f"{dataset / name} must be a folder, got a link; delete it")
    for path in (dataset / MANIFEST, dataset / FAILURES / MANIFEST, dataset / CARD):
        if path.is_symlink():
            raise ValueError(f"{path} must be a file, got a link; delete it")
    found: Counter[str] = Counter()
    with repairing(dataset):
        for shelf in (dataset, dataset / FAILURES):
            if shelf.is_dir():
                found += _repaired(shelf, dataset / DAMAGED)
        for seed in sorted({int(m[1]) for path in dataset.iterdir() if (m := CLAIM.fullmatch(path.name))}):
            with claimed(dataset, seed) as mine:
                for part in parts(dataset, seed) if mine else ():
                    shutil.rmtree(part)
                    found[REMOVED] += 1
    return found


def broken_datasets(folder: Path) -> list[Path]:
    """The datasets in `folder`, also those without a manifest. Raises ValueError where there are none."""
    walked = [(Path(path), files) for path, _, files in os.walk(folder)]  # which follows no links
    found = {path for path, files in walked if MANIFEST in files}
    found |= {path.parent for path, files in walked if EPISODE in files and path != folder}
    made = sorted(path for path in found if path.name not in (FAILURES, DAMAGED))
    if not made:
        raise ValueError(f"folder must hold a dataset of `hazard-ms demos record`, got {folder}")
    return made


def _repaired(shelf: Path, aside: Path) -> Counter[str]:
    """Put the manifest of one folder of episodes in order; what is damaged goes into `aside`."""
    found: Counter[str] = Counter()
    path = shelf / MANIFEST
    before = read_foreign(path, MOST_LINES) if path.exists() else b""
    listed = {entry.name: entry for entry in entries(shelf)} if before else {}
    kept: dict[str, Entry] = {}
    for name, entry in listed.items():
        if not differences(shelf / name, entry):
            kept[name] = entry
        found[KEPT] += name in kept
        found[MISSING] += not (shelf / name).is_dir()
    for folder in sorted(shelf.iterdir()):
        if not folder.is_dir() or folder.name.startswith(".") or folder.name in (FAILURES, DAMAGED, *kept):
            continue
        if (folder / MANIFEST).exists() and not folder.is_symlink():
            continue  # a dataset of its own
        try:
            if folder.name in listed:
                raise DamagedDatasetError
            entry = replace(entry_of(folder), name=folder.name)
            if Entry.of_line(entry.line()) != entry:
                raise DamagedDatasetError  # it could not be read again
            kept[folder.name] = entry
            found[ENTERED] += 1
        except DamagedDatasetError:
            _move(folder, aside)
            found[MOVED] += 1
    after = "".join(entry.line() for entry in kept.values()).encode()
    if after != before:
        write(path, after)
    return found


def _move(folder: Path, aside: Path) -> None:
    """Move a folder into `aside`, under a name that is free there."""
    aside.mkdir(exist_ok=True)
    number = 1
    while (place := aside / (folder.name if number == 1 else f"{folder.name}-{number}")).exists():
        number += 1
    os.replace(folder, place)
