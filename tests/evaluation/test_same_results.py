"""`hazard-ms evaluate` gives the same results however the episodes are spread, and replays of them are exact."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.result import EpisodeResult

pytestmark = [pytest.mark.long, pytest.mark.render]  # each process takes seconds to start
ROOT = Path(__file__).parents[2]
PATIENCE = 1500  # time after which something hangs, also on a machine with much to do [s]
AGENT = """
from hazard_ms import Action
from hazard_ms.agents.random import Random

class Hasty(Random):
    \"\"\"Stops after a few moves.\"\"\"

    def reset(self, brief):
        super().reset(brief)
        self.left = 4

    def act(self, decision):
        self.left -= 1
        return super().act(decision) if self.left else Action("stop")
"""
WORDS = ("--agents", "own.py:Hasty", "--episodes", "4")


def start(folder: Path, *words: str) -> subprocess.Popen[str]:
    (folder / "own.py").write_text(AGENT)
    variables = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "hazard_ms.cli", *words]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, cwd=folder, env=variables, stdout=pipe, stderr=pipe, text=True)


def done(folder: Path, *words: str) -> str:
    running = start(folder, *words)
    out, error = running.communicate(timeout=PATIENCE)
    assert running.returncode == 0, out[-2000:] + error[-2000:]
    return out


def results(folder: Path) -> dict[str, dict[str, Any]]:
    """By file: all that must not depend on the run."""
    rows = {path.name: EpisodeResult.read(path).to_dict() for path in folder.glob("*.json")}
    return {name: {k: v for k, v in row.items() if not k.endswith("_seconds")} for name, row in rows.items()}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Holds the results of one worker in `one`."""
    made = tmp_path_factory.mktemp("same")
    done(made, "evaluate", *WORDS, "--workers", "1", "-o", "one")
    assert len(results(made / "one")) == 4
    return made


@pytest.mark.parametrize(
    "spread",
    [
        [("--backend", "serial")],
        [("--workers", "4")],
        [("--workers", "1", "--shard", f"{part}/3") for part in (3, 1, 2)],
        pytest.param(
            [("--backend", "ray", "--workers", "2")],
            marks=pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="ray is not installed"),
        ),
    ],
    ids=["serial", "four workers", "three shards", "ray"],
)
def test_results_do_not_depend_on_how_episodes_are_spread(spread: list[tuple[str, ...]], folder: Path) -> None:
    name = spread[0][-1].replace("/", "-")
    for words in spread:
        done(folder, "evaluate", *WORDS, *words, "-o", name)
    assert results(folder / name) == results(folder / "one")


def test_results_survive_the_death_of_a_worker_and_of_the_parent(folder: Path) -> None:
    """Both are killed when the first result is there; a second run plays what is missing."""
    running = start(folder, "evaluate", *WORDS, "--workers", "2", "-o", "killed")
    try:
        for seen in (1, 2):
            deadline = time.monotonic() + PATIENCE
            while len(list((folder / "killed").glob("*.json"))) < seen and time.monotonic() < deadline:
                time.sleep(0.2)
            if seen == 1:
                os.kill(children(running.pid)[0], signal.SIGKILL)
    finally:
        running.send_signal(signal.SIGKILL)
        running.communicate(timeout=PATIENCE)
    before = results(folder / "killed")
    assert 2 <= len(before) and all(results(folder / "one")[name] == row for name, row in before.items())
    done(folder, "evaluate", *WORDS, "--workers", "1", "-o", "killed")
    assert results(folder / "killed") == results(folder / "one")


def test_replays_are_exact(folder: Path) -> None:
    assert done(folder, "replay", "one").splitlines()[-1] == "4 exact"


def children(parent: int) -> list[int]:
    """Processes that play episodes: those that `parent` started by spawning."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            words = (place / "cmdline").read_bytes()
            if int((place / "stat").read_text().rpartition(")")[2].split()[1]) == parent and b"spawn_main" in words:
                found.append(int(place.name))
        except OSError:
            continue
    return sorted(found)
