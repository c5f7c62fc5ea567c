"""The commands `hazard-ms demos ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.demonstrations.export.options import ExportOptions
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.evaluation.choices import flag

Folder = tyro.conf.Positional[Path]


def record(options: Annotated[tyro.conf.OmitArgPrefixes[RecordOptions], tyro.conf.arg(name="")]) -> int:
    """Record episodes as demonstrations, frame by frame, with labels of skills and options.

    Resumes an interrupted run; several processes and machines can record into the same folder at once. Exits with 1 if
    an episode could not be recorded.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.demonstrations.recording import record as run

    user_path()
    return run(options)


def verify(folder: Folder, replay: bool = False, workers: int = 0, load: tuple[str, ...] = ()) -> int:
    """Compare all files of the datasets in a folder with their manifests. Exits with 1 if anything differs.

    Args:
        folder: A dataset, or a folder of datasets.
        replay: Simulate every episode again, and compare all hashes.
        workers: Processes for --replay; 0: one for each core.
        load: Modules, or files NAME.py, that register what the episodes need.
    """
    from hazard_ms.demonstrations.verify import verify as run

    return run(folder, replay, workers, load)


def repair(folder: Folder) -> int:
    """Put the datasets in a folder in order: enter whole episodes, move damaged ones aside, delete unfinished ones.

    Args:
        folder: A dataset, or a folder of datasets.
    """
    from hazard_ms.demonstrations.repair import broken_datasets
    from hazard_ms.demonstrations.repair import repair as run

    for dataset in broken_datasets(folder):
        found = run(dataset)
        print(f"{dataset}: {', '.join(f'{count} {kind}' for kind, count in sorted(found.items()) if count)}")
    return 0


def merge(folders: tyro.conf.Positional[tuple[Path, ...]], output: Annotated[Path, flag("-o")]) -> int:
    """Copy the episodes of several datasets into one for each task and agent; equal episodes are copied once.

    Args:
        folders: Datasets, or folders of datasets.
        output: Folder for the new datasets.
    """
    from hazard_ms.demonstrations.merging import merge as run

    for dataset, count in run(folders, output).items():
        print(f"{dataset}: {count} episodes added")
    return 0


def stats(folder: Folder) -> int:
    """Print statistics of the datasets in a folder: episodes, frames, value, reasons for failures, sizes and times.

    Args:
        folder: A dataset, or a folder of datasets.
    """
    from hazard_ms.demonstrations.layout import datasets
    from hazard_ms.demonstrations.stats import stats as text

    for dataset in datasets(folder):
        print(text(dataset))
    return 0


def show(folder: Folder, output: Annotated[Path, flag("-o")] = Path("demos.html"), films: int = 20) -> int:
    """Write a page about the datasets in a folder: numbers, curves, and episodes with their films and timelines.

    Args:
        folder: A dataset, or a folder of datasets.
        output: Page to write, NAME.html. Keep it where it is if it links to films: those are not copied.
        films: Number of episodes per dataset shown with film and timeline; the table and the curves hold all.

    Raises:
        ValueError: for a folder without episodes, and for a page that cannot be written.
    """
    from hazard_ms.demonstrations.show import page
    from hazard_ms.evaluation.options import MOST
    from hazard_ms.spec.checks import whole
    from hazard_ms.spec.storage.files import make_folder, write

    whole(films, 0, MOST, "films")
    if output.suffix != ".html":
        raise ValueError(f"output must end in .html, got {output.name!r}")
    text = page(folder, output, films)
    make_folder(output.parent)
    write(output, text)
    print(f"page: {output.resolve()}")
    return 0


def export(options: Annotated[tyro.conf.OmitArgPrefixes[ExportOptions], tyro.conf.arg(name="")]) -> int:
    """Write a dataset in the format of other tools: ManiSkill, LeRobot, Minari, chats, tar files."""
    from hazard_ms.agents.base import user_path
    from hazard_ms.demonstrations.export.export import export as run

    user_path()
    return run(options)


DemosCommand = (
    Annotated[int, tyro.conf.subcommand(name="record", constructor=record)]
    | Annotated[int, tyro.conf.subcommand(name="verify", constructor=verify)]
    | Annotated[int, tyro.conf.subcommand(name="repair", constructor=repair)]
    | Annotated[int, tyro.conf.subcommand(name="merge", constructor=merge)]
    | Annotated[int, tyro.conf.subcommand(name="stats", constructor=stats)]
    | Annotated[int, tyro.conf.subcommand(name="show", constructor=show)]
    | Annotated[int, tyro.conf.subcommand(name="export", constructor=export)]
)
