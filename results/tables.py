"""What the commands in this folder share: the tasks, the command that plays, and scores as they are written."""

from __future__ import annotations

import csv
import os
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from hazard_ms.evaluation.metrics import Score, scores
from hazard_ms.evaluation.result import ALONE, REGRET, EpisodeResult
from hazard_ms.spec.checks import one_of

HERE = Path(__file__).parent
TASKS = {"fire": "HazardFire-v1", "flood": "HazardFlood-v1", "wind": "HazardWind-v1"}
CODE = ("hazard_ms", "examples", ":(glob)results/*.py")
COMMAND = [sys.executable, "-m", "hazard_ms.cli"]


def evaluate(task: str, folder: Path, *words: str, check: bool = True) -> None:
    """Play what is missing of a sweep of a task, by its name in TASKS or its own.

    `check`: whether to raise CalledProcessError where it fails.
    """
    told = ["-e", TASKS.get(task, task), "-o", str(folder), *words]
    subprocess.run([*COMMAND, "evaluate", *told], cwd=HERE.parent, check=check)


def asked(told: Sequence[str], agents: Sequence[str], scenes: int) -> tuple[list[tuple[str, str]], int]:
    """What the words `told` to a command ask for: pairs of task and agent, and scenes of each, `scenes` by default.

    All pairs without words; none for `tables` alone. Raises ValueError for unknown names.
    """
    if list(told) == ["tables"]:
        return [], scenes
    pairs = {f"{task}-{agent}": (task, agent) for task in TASKS for agent in agents}
    *names, last = told or [""]
    number = int(last) if last.isdecimal() else scenes
    names += [] if last.isdecimal() or not last else [last]
    return [pairs[one_of(name, list(pairs), "an agent of a task")] for name in names] or list(pairs.values()), number


def write_rows(file: Path, columns: Sequence[str], rows: Sequence[Mapping[str, str]]) -> None:
    """Write `rows`, each with all `columns`, to a CSV file."""
    with file.open("w", newline="", encoding="utf-8") as open_file:
        writer = csv.DictWriter(open_file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def results_in(folder: Path) -> list[EpisodeResult]:
    """The results in a folder, in the order of their files' names; what lies beside them is left out."""
    paths = [path for path in sorted(folder.glob("Hazard*.json")) if not path.name.endswith((ALONE, REGRET))]
    return [EpisodeResult.read(path) for path in paths]


def value_of(results: Sequence[EpisodeResult]) -> Score:
    """The score Value of `results`, 0 to 1."""
    return scores([result.tally for result in results], [result.scene for result in results])["value"]


def percent(score: Score) -> tuple[float, float, float]:
    """A score and the ends of its interval [%]."""
    mean, low, high = (100.0 * (end or 0.0) for end in (score.mean, score.low, score.high))
    return mean, low, high


def words(score: Score) -> str:
    """A score in percent with its interval; without one for a single episode."""
    mean, low, high = percent(score)
    return f"{mean:.1f}" if low == high else f"{mean:.1f} [{low:.1f}, {high:.1f}]"


def machine() -> str:
    """The commit and the machine; `-dirty` if code differs from the commit, whatever tables do."""
    git = ["git", "-C", str(HERE.parent)]
    commit = subprocess.run([*git, "rev-parse", "--short=7", "HEAD"], capture_output=True, text=True).stdout.strip()
    if subprocess.run([*git, "diff", "--quiet", "HEAD", "--", *CODE], capture_output=True).returncode:
        commit += "-dirty"
    version = subprocess.run([*COMMAND, "version"], capture_output=True, text=True, check=True).stdout.strip()
    return f"commit {commit}; {version.splitlines()[0]}; {platform.machine()}, {os.cpu_count()} cores"
