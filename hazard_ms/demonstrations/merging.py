"""`hazard-ms demos merge`: several datasets of the same recipe as one."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from hazard_ms.demonstrations import claims, store
from hazard_ms.demonstrations.card import write_card
from hazard_ms.demonstrations.layout import FAILURES, MANIFEST, Entry, datasets, plain
from hazard_ms.demonstrations.reading import differences, entries
from hazard_ms.machine.files import make_folder


def merge(folders: Sequence[Path], output: Path) -> dict[Path, int]:
    """Copy all episodes of the datasets in `folders` into datasets in `output`, also those that were not kept.

    What is there already is not copied again. Returns how many were copied into each dataset. Raises ValueError for
    datasets of another format, for those of one task and agent that were made by different recipes, for two different
    episodes of one name, and for episodes that are not as they were written; nothing is copied then.
    """
    sources = [(shelf, entry) for folder in folders for shelf in _shelves(folder) for entry in entries(shelf)]
    places = {output / str(e.recipe["env_id"]) / plain(str(e.recipe["agent"])) for _, e in sources}
    known = {place: {e.name: e for shelf in _inside(place) for e in entries(shelf)} for place in places}
    new: list[tuple[Path, Path, Entry]] = []
    for shelf, entry in sources:
        place = output / str(entry.recipe["env_id"]) / plain(str(entry.recipe["agent"]))
        if faults := differences(shelf / entry.name, entry):
            raise ValueError(
                f"{shelf / entry.name} must be as its manifest says, got {', '.join(faults)}; "
                f"see `hazard-ms demos repair`"
            )
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


def _inside(dataset: Path) -> list[Path]:
    return [shelf for shelf in (dataset, dataset / FAILURES) if (shelf / MANIFEST).exists()]


def _check(place: Path, known: dict[str, Entry], shelf: Path, entry: Entry) -> None:
    """Raise ValueError unless an episode of `shelf` can stand in the dataset at `place` beside those `known`."""
    same = known.get(entry.name)
    if same is not None and same.content != entry.content:
        raise ValueError(f"an episode {entry.name} must be the same in all datasets, got another one in {shelf}")
    other = next(iter(known.values()), entry)
    if other.recipe != entry.recipe:
        differing = [key for key in other.recipe if other.recipe[key] != entry.recipe.get(key)]
        raise ValueError(
            f"the recipe of {place} must be that of all its episodes, got another {', '.join(differing)} in {shelf}; "
            "merge it into another folder"
        )


def _copy(source: Path, place: Path, entry: Entry) -> None:
    make_folder(place)
    with claims.claimed(place, entry.seed) as mine:
        if not mine:
            raise ValueError(f"{place} must not be written by another process meanwhile, got {entry.name}")
        part = store.begin(place, entry.seed)
        shutil.copytree(source, part, dirs_exist_ok=True)
        store.publish(part, place, entry)
