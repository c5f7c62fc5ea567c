"""Kills a recording of demonstrations again and again, and looks at what is left each time.

`./run python results/killed_recordings.py DATASET -o FOLDER [--episodes 20] [--kills 50] [--longest 30]` records
the first episodes of DATASET, which `hazard-ms demos record` has made undisturbed, once more in FOLDER. Meanwhile it
kills, with SIGKILL and at random times, the command and all its processes, or the command alone, or one of its
processes. It prints how many episodes could not be read, how many were lost after the command had told of them, and how
many differ from DATASET in the end; and ends with 1 if any of these is not zero.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from hazard_ms.demonstrations.layout import FAILURES, MANIFEST, Entry
from hazard_ms.demonstrations.reading import differences, entries
from results.tables import COMMAND

TOLD = re.compile(r"([\w.-]+-s\d{6}): [\d.]+ % of the value")  # how the command tells of an episode that is stored
WHAT = ("all", "command", "process")  # that is killed


def shelves(dataset: Path) -> Iterator[tuple[Path, Entry]]:
    """The episodes of a dataset and of its failures: the folder of each, and its line in the manifest."""
    for shelf in (dataset, dataset / FAILURES):
        if (shelf / MANIFEST).exists():
            yield from ((shelf / entry.name, entry) for entry in entries(shelf))


@dataclass
class Ordeal:
    """A recording that is killed: its command, and what has been found so far."""

    command: list[str]
    dataset: Path
    log: Path
    kills: int
    chance: random.Random
    longest: float = 30.0  # from one kill to the next: a start takes a third of it, an episode half [s]
    killed: Counter[str] = field(default_factory=Counter)
    unreadable: set[str] = field(default_factory=set)
    lost: set[str] = field(default_factory=set)

    def run(self) -> int:
        """Kill the recording `kills` times, then let it end; the code that it ends with."""
        while True:
            before = self.killed.total()
            with self.log.open("a", encoding="utf-8") as log:
                process = subprocess.Popen(self.command, stdout=log, stderr=log, start_new_session=True)
                while process.poll() is None and self.killed.total() < self.kills:
                    self._kill(process)
            ended = process.wait()
            _end_of_all(process.pid)
            self.look()
            if ended == 0 or (ended > 0 and self.killed.total() == before):
                return ended  # it is done, or fails by itself

    def _kill(self, process: subprocess.Popen[bytes]) -> None:
        """Wait for a random time, then kill some of what runs."""
        until = time.monotonic() + self.chance.uniform(0.0, self.longest)
        while time.monotonic() < until and process.poll() is None:
            time.sleep(0.02)
        what = self.chance.choice(WHAT)
        if process.poll() is not None:
            return
        if what == "all":
            os.killpg(process.pid, signal.SIGKILL)
        elif what == "command":
            process.kill()
        elif children := _children(process.pid):
            os.kill(self.chance.choice(children), signal.SIGKILL)
        else:
            return  # the command has not started any yet
        self.killed[what] += 1
        print(f"kill {self.killed.total()} of {self.kills}: {what}", file=sys.stderr, flush=True)

    def look(self) -> None:
        """Look at what is there, before anything is put in order."""
        there = dict(shelves(self.dataset)) if self.dataset.exists() else {}
        self.unreadable |= {entry.name for folder, entry in there.items() if differences(folder, entry)}
        told = set(TOLD.findall(self.log.read_text(encoding="utf-8")))
        self.lost |= told - {entry.name for entry in there.values()}


def _children(pid: int) -> list[int]:
    """The processes that a process has started and that have not ended."""
    return [int(each) for each in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def _end_of_all(group: int) -> None:
    """Wait until no process of a group is left: those of a killed command end by themselves."""
    until = time.monotonic() + 60.0
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise RuntimeError(f"processes of a killed command must end by themselves within a minute, got group {group}")


def ordeal(
    undisturbed: Path, output: Path, episodes: int, kills: int, longest: float, workers: int
) -> tuple[bool, str]:
    """Record episodes of a dataset again while killing the recording; whether all is well, and a sentence."""
    there = sorted((entry for _, entry in shelves(undisturbed)), key=lambda entry: entry.seed)[:episodes]
    wanted, seeds = {entry.name: entry.content for entry in there}, [entry.seed for entry in there]
    recipe = there[0].recipe
    words = ["-e", recipe["env_id"], "-a", recipe["agent"], "--obs", recipe["obs"], "--keep", str(recipe["keep"])]
    words += ["-s", str(seeds[0]), "-n", str(len(seeds)), "--workers", str(workers), "-o", str(output)]
    dataset = output / undisturbed.parent.name / undisturbed.name
    output.mkdir(parents=True, exist_ok=True)
    tried = Ordeal([*COMMAND, "demos", "record", *words], dataset, output / "log.txt", kills, random.Random(0), longest)
    start = time.monotonic()
    ended = tried.run()
    found = {entry.name: entry.content for _, entry in shelves(dataset)}
    other = {name for name in wanted.keys() | found.keys() if wanted.get(name) != found.get(name)}
    struck = ", ".join(f"{count} times {what}" for what, count in sorted(tried.killed.items()))
    text = (
        f"{len(wanted)} episodes of {recipe['env_id']}, recorded while {tried.killed.total()} random `kill -9` struck "
        f"({struck}), in {(time.monotonic() - start) / 60:.0f} minutes: {len(tried.unreadable)} episodes could not be "
        f"read, {len(tried.lost)} were lost after they had been told of, {len(other)} differ from an undisturbed "
        f"recording; the last command ended with {ended}."
    )
    return not (tried.unreadable or tried.lost or other or ended or tried.killed.total() < kills), text


def main() -> int:
    """Run the command; the code that it ends with."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--longest", type=float, default=30.0, help="from one kill to the next [s]")
    parser.add_argument("--workers", type=int, default=2)
    wanted = parser.parse_args()
    well, text = ordeal(wanted.dataset, wanted.output, wanted.episodes, wanted.kills, wanted.longest, wanted.workers)
    print(text)
    return int(not well)


if __name__ == "__main__":
    sys.exit(main())
