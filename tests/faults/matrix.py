"""Every fault against every command: what is left, and what is said. `python -m tests.faults.matrix [NAME...]`.

Prints one row for each command and one column for each fault: "whole" where it did its job, "refused" where it said
what is wrong and changed nothing, and what is wrong otherwise. Ends with 1 unless all are well.
"""

from __future__ import annotations

import platform
import random
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from hazard_ms import __version__
from tests.faults.commands import COMMANDS, Command, half_written
from tests.faults.starting import Ended, killed, mounted, run, run_two, start_without_reader

MOMENTS = 20  # at which a command is killed
SEED = 20261122  # of the moments
WELL = ("whole", "refused")


def whole(ended: Ended, folder: Path) -> str:
    """ "whole", or what is wrong."""
    if ended.code != 0:
        return f"FAILED with {ended.code}: {ended.last}"
    return "; ".join(half_written(folder)) or "whole"


def refused(ended: Ended, folder: Path, older: dict[str, bytes] | None = None) -> str:
    """ "refused" where a failure names the path and a remedy, and leaves what was there; else what is wrong."""
    if ended.code == 0:
        return "; ".join(half_written(folder)) or "whole"
    if "Traceback" in ended.error:
        return f"TRACEBACK: {ended.last}"
    if str(folder) not in ended.error and folder.name not in ended.error:
        return f"NO PATH in: {ended.last}"
    changed = older is not None and older != contents(folder)
    return "; ".join(half_written(folder)) or ("CHANGED what was there" if changed else "refused")


def contents(folder: Path) -> dict[str, bytes]:
    """All files of `folder` that are no drafts, by name."""
    files = (
        p
        for p in folder.rglob("*")
        if p.is_file() and not any(part.startswith(".") for part in p.relative_to(folder).parts)
    )
    return {str(p.relative_to(folder)): p.read_bytes() for p in files}


@contextmanager
def place(command: Command) -> Iterator[Path]:
    """An empty folder for the output of `command`."""
    with tempfile.TemporaryDirectory(prefix="hazard_ms_faults_", ignore_cleanup_errors=True) as outer:
        folder = Path(outer) / f"out-{command.name.split()[0].strip('./')}"
        folder.mkdir()
        yield folder


def kill(command: Command) -> str:
    """Killed at random moments, half of them over an older result; then it runs once more."""
    chance = random.Random(f"{SEED} {command.name}")
    with place(command) as folder:
        began = time.monotonic()
        first = run(command, folder, 0)
        took = time.monotonic() - began
        if first.code != 0:
            return f"FAILED with {first.code}: {first.last}"
        for k in range(MOMENTS):
            if command.once or k % 2:
                emptied(folder)
            killed(command, folder, 1, chance.uniform(0.1, 1.02) * took)
            if faults := "; ".join(half_written(folder)):
                return f"after kill {k}: {faults}"
        if command.name == "assets add":  # what was added in time is refused a second time
            emptied(folder)
        last = whole(run(command, folder, 1), folder)
        drafts = [p.name for p in folder.rglob("*.part*")]
        return f"DRAFTS LEFT: {drafts}" if drafts and last == "whole" else last


def emptied(folder: Path) -> None:
    """Delete all that is in `folder`."""
    shutil.rmtree(folder)
    folder.mkdir()


def full_disk(command: Command) -> str:
    with place(command) as folder, mounted(folder, free=3000):
        return refused(run(command, folder, 1), folder, contents(folder))


def read_only(command: Command) -> str:
    with place(command) as folder, mounted(folder, read_only=True):
        return refused(run(command, folder, 1), folder, contents(folder))


def no_temporary_folder(command: Command) -> str:
    with place(command) as folder:
        return whole(run(command, folder, 0, TMPDIR="/nowhere", TMP="/nowhere", TEMP="/nowhere"), folder)


def no_home(command: Command) -> str:
    changes = {"HOME": "/proc/none", "XDG_CACHE_HOME": None}
    if command.name != "./run":
        changes["HAZARD_MS_HOME"] = None
    with place(command) as folder:
        return whole(run(command, folder, 0, **changes), folder)


def ascii_locale(command: Command) -> str:
    changes = {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}
    with place(command) as folder:
        ended = run(command, folder, 0, **changes)
        return "TRACEBACK" if "Traceback" in ended.error else whole(ended, folder)


def broken_pipe(command: Command) -> str:
    with place(command) as folder:
        ended = start_without_reader(command, folder, 0)
        if "Traceback" in ended.error or "Exception ignored" in ended.error:
            return f"TRACEBACK: {ended.last}"
        return "; ".join(half_written(folder)) or "whole"


def two_at_once(command: Command) -> str:
    with place(command) as folder:
        ends = run_two(command, folder)
        bad = [e for e in ends if e.code != 0]
        if len(bad) > command.refuses_two or any("Traceback" in e.error for e in bad):
            return f"FAILED: {bad[0].last}"
        return "; ".join(half_written(folder)) or "whole"


Fault = Callable[[Command], str]
FAULTS: tuple[Fault, ...] = (
    kill,
    full_disk,
    read_only,
    no_temporary_folder,
    no_home,
    ascii_locale,
    broken_pipe,
    two_at_once,
)


def main(names: list[str]) -> int:
    """Run the commands `names`, all without any, and print the matrix."""
    print(f"hazard_ms {__version__}, Python {platform.python_version()}, {platform.platform()}, {MOMENTS} kills each")
    bad = 0
    chosen = [c for c in COMMANDS if not names or c.name in names]
    with ThreadPoolExecutor(2) as pool:
        cells = [(c, f, pool.submit(f, c)) for c in chosen for f in FAULTS]
        for command, fault, cell in cells:
            said = cell.result()
            well = said in WELL
            bad += not well
            name = fault.__name__.replace("_", " ")
            print(f"{'ok ' if well else 'BAD'} {command.name:14s} {name:20s} {said}", flush=True)
    print(f"{len(cells) - bad} of {len(cells)} are well")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
