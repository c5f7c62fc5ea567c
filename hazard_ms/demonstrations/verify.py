"""`hazard-ms demos verify`: compares datasets with their manifests and, if asked, with new simulations."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from hazard_ms.demonstrations.layout import DAMAGED, FAILURES, MANIFEST, DamagedDatasetError, Entry, datasets
from hazard_ms.demonstrations.reading import differences, entries, numbered, read_episode
from hazard_ms.demonstrations.store import entry_of, parts
from hazard_ms.evaluation.replay import EXACT, apart, compare, job_of
from hazard_ms.evaluation.spread import spread


def verify(folder: Path, replay: bool = False, workers: int = 0, load: tuple[str, ...] = ()) -> int:
    """Print what is wrong with the datasets in `folder`. Returns 1 if anything is, else 0.

    With `replay`, all episodes are simulated again by `workers` processes (0: one for each core), which `load` modules
    that they need. Raises ValueError for a folder without datasets.
    """
    count = wrong = 0
    whole: dict[Path, Entry] = {}
    for shelf in datasets(folder, failures=True):
        for name, fault in faults(shelf):
            wrong += 1
            print(f"{shelf / name}: {fault}", flush=True)
        for entry in entries(shelf):
            count += 1
            whole |= {} if differences(shelf / entry.name, entry) else {shelf / entry.name: entry}
    if replay:
        wrong += _replayed(whole, workers, load)
    told = f", {wrong} faults; `hazard-ms demos repair {folder}` puts files in order" if wrong else ", no faults"
    print(f"{count} episodes{told}")
    return int(wrong > 0)


def faults(shelf: Path) -> Iterator[tuple[str, str]]:
    """The faults of a dataset, or of its failures: the name of a file or folder, and what is wrong with it."""
    for number, read in numbered(shelf):
        if read is None:
            yield MANIFEST, f"line {number} is torn, damaged or impossible"
    listed = {entry.name: entry for entry in entries(shelf)}
    for name, entry in listed.items():
        found = differences(shelf / name, entry)
        if found:
            yield name, ", ".join(found)
        elif unlike := _unlike(shelf / name, entry):
            yield name, unlike
    for path in sorted(shelf.iterdir()):
        if path.name in (FAILURES, DAMAGED) and path.is_symlink():
            yield path.name, "it must be a folder, got a link"
        elif path.is_dir() and not path.name.startswith(".") and path.name not in (FAILURES, DAMAGED, *listed):
            yield path.name, f"it is not in {MANIFEST}"
    for path in parts(shelf):
        yield path.name, "an unfinished episode, or one that is being recorded"


def _unlike(folder: Path, entry: Entry) -> str:
    """How the line of a manifest differs from what its files say; empty if it does not."""
    try:
        told = entry_of(folder)
    except DamagedDatasetError as error:
        return str(error)
    names = ("name", "seed", "scene", "frames", "decisions", "value", "recipe", "reason", "size")
    other = [name for name in names if getattr(told, name) != getattr(entry, name)]
    return f"its line in {MANIFEST} has another {', '.join(other)}" if other else ""


def _replayed(whole: dict[Path, Entry], workers: int, load: tuple[str, ...]) -> int:
    """Simulate episodes again, and print how each compares with its record. Returns how many are not exact."""
    records = {folder: read_episode(folder).result for folder in whole}
    jobs = {id(job): (folder, job) for folder, record in records.items() for job in [job_of(record, load)]}
    wrong = 0
    with spread([job for _, job in jobs.values()], workers) as outcomes:
        for job, outcome in outcomes:
            folder, _ = jobs[id(job)]
            verdict, why = compare(records[folder], outcome.result, outcome.error)
            wrong += verdict != EXACT
            print(f"{folder}: {verdict}{why}{apart(whole[folder].versions)}", flush=True)
    return wrong
