"""`hazard-ms demos merge`: several datasets of the same recipe as one."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from hazard_ms.demonstrations import claims, store
from hazard_ms.demonstrations.card import write_card
from hazard_ms.demonstrations.layout import MANIFEST, Entry, datasets, files_of, plain, shelves
from hazard_ms.demonstrations.reading import described, differences, entries, whole_entries
from hazard_ms.spec.foreign.files import folder_name
from hazard_ms.spec.storage.files import make_folder


def merge(folders: Sequence[Path], output: Path) -> dict[Path, int]:
    """Copy all episodes of the datasets in `folders` into datasets in `output`, also those that were not kept.

    What is there already is not copied again. Returns how many were copied into each dataset. Raises ValueError for
    datasets of another format, for those of one task and agent that were made by different recipes, for two different
    episodes of one name, for names that lead elsewhere, and for manifests and episodes that are not as they were
    written; nothing is copied then.
    """
    sources = [(shelf, entry) for folder in folders for shelf in _shelves(folder) for entry in whole_entries(shelf)]
    places = {_place(output, shelf, entry) for shelf, entry in sources}
    known = {place: {e.name: e for shelf in shelves(place) for e in entries(shelf)} for place in places}
    new: list[tuple[Path, Path, Entry]] = []
    for shelf, entry in sources:
        place = _place(output, shelf, entry)
        if faults := differences(shelf / entry.name, entry):
            raise ValueError(
                f"{shelf / entry.name} must match its manifest, got {', '.join(faults)}; see `hazard-ms demos repair`"
            )
        described(shelf / entry.name)
        _check(place, known[place], shelf, entry)
        if entry.name not in known[place]:
            known[place][entry.name] = entry
            new.append((place, shelf, entry))
    for place, shelf, entry in new:
        _copy(shelf / entry.name, place, entry)
    for place in places:
        write_card(place)
    return {place: sum(p == place for p, _, _ in new) for place in sorted(places)}


def _shelves(folder: Path) -> list[Path]:
    return list(datasets(folder, failures=True))


def _place(output: Path, shelf: Path, entry: Entry) -> Path:
    """The dataset in `output` for an episode of `shelf`. Raises ValueError for names that no folder can have."""
    names = [entry.recipe.get(key) for key in ("env_id", "agent")]
    if not all(isinstance(name, str) for name in names):
        raise ValueError(
            f"the recipe of {entry.name} must name env_id and agent as strings, got other values in {shelf / MANIFEST}"
        )
    task, agent = str(names[0]), plain(str(names[1]))
    return output / folder_name(task, f"env_id in {shelf / MANIFEST}") / folder_name(agent, f"agent in {shelf}")


def _check(place: Path, known: dict[str, Entry], shelf: Path, entry: Entry) -> None:
    """Raise ValueError unless an episode of `shelf` can stand in the dataset at `place` beside those `known`."""
    same = known.get(entry.name)
    if same is not None and same.content != entry.content:
        raise ValueError(f"episode {entry.name} must be the same in all datasets, got a different one in {shelf}")
    other = next(iter(known.values()), entry)
    if other.recipe != entry.recipe:
        differing = [key for key in other.recipe if other.recipe[key] != entry.recipe.get(key)]
        raise ValueError(
            f"all episodes in {place} must have one recipe, got a different {', '.join(differing)} in {shelf}; merge "
            "it into another folder"
        )


def _copy(source: Path, place: Path, entry: Entry) -> None:
    make_folder(place)
    with claims.claimed(place, entry.seed) as mine:
        if not mine:
            raise ValueError(f"{place} must not be written by another process during the merge, got {entry.name}")
        part = store.begin(place, entry.seed)
        for name, path in files_of(source).items():
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, part / name, follow_symlinks=False)
        store.publish(part, place, entry)
