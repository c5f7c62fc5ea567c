"""`hazard-ms evaluate` with agents that raise, quit or kill their process, and with a parent that is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hazard_ms.evaluation.options import SweepOptions
from tests.worlds.results import result_of

pytestmark = pytest.mark.long  # each process takes seconds to start
ROOT = Path(__file__).parents[2]
PATIENCE = 300  # time after which something hangs, also on a machine with much to do [s]
AGENTS = """
import os, sys, time
from hazard_ms import Action, Agent

class Fine(Agent):
    def reset(self, brief):
        pass

    def act(self, decision):
        return Action("stop")

class Quits(Fine):
    def __init__(self):
        sys.exit(0)

class Raises(Fine):
    def __init__(self):
        raise KeyError("no such plan")

class Dies(Fine):
    def __init__(self):
        os._exit(0)

class Sleeps(Fine):
    def __init__(self):
        open(f"{os.getpid()}.worker", "w").close()
        time.sleep(1000)
"""


def evaluate(folder: Path, *words: str) -> subprocess.Popen[str]:
    (folder / "own.py").write_text(AGENTS)
    command = [sys.executable, "-m", "hazard_ms.cli", "evaluate", "--workers", "2", "-o", "results", *words]
    return subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
    )


def test_an_agent_that_fails_costs_its_episodes_alone(tmp_path: Path) -> None:
    """The table holds the episode that another agent has finished."""
    names = ("Fine", "Quits", "Raises", "Dies")
    options = SweepOptions(agents=tuple(f"own.py:{name}" for name in names), episodes=1, output=tmp_path / "results")
    finished = options.episode_options()[0]
    (tmp_path / "results").mkdir()
    result_of(finished, saved=True).write(options.place(finished))
    running = evaluate(tmp_path, "--episodes", "1", "--agents", *options.agents)
    out, error = running.communicate(timeout=PATIENCE)
    assert running.returncode == 1, error[-3000:]
    lines = out.splitlines()
    assert any(line.startswith("own.py:Fine ") and "50.0 [50.0, 50.0]" in line and "1/2" in line for line in lines), out
    assert "own.py:Fine: ended by 1 time; failures: none" in lines
    for name, told in (
        ("Quits", "the agent own.py:Quits must return or raise an error, got sys.exit(0) (own.py, line 14)"),
        ("Raises", "KeyError: 'no such plan' (own.py, line 18)"),
        ("Dies", "its process ended, killed or by os._exit"),
    ):
        (said,) = (line for line in lines if line.startswith(f"no result: own.py:{name}, seed 0: "))
        assert told in said and "to see it again: hazard-ms play -e HazardFire-v1" in said
        assert f"--agent own.py:{name} -s 0" in said
        assert f"own.py:{name}: ended by 1 error; failures: none" in lines
    assert list((tmp_path / "results").iterdir()) == [options.place(finished)]


def test_workers_end_with_a_parent_that_was_killed(tmp_path: Path) -> None:
    running = evaluate(tmp_path, "--episodes", "2", "--agents", "own.py:Sleeps")
    try:
        deadline = time.monotonic() + PATIENCE
        while len(list(tmp_path.glob("*.worker"))) < 2 and running.poll() is None and time.monotonic() < deadline:
            time.sleep(0.2)
        workers = [int(path.stem) for path in tmp_path.glob("*.worker")]
        assert len(workers) == 2 and all(map(alive, workers))
    finally:
        running.send_signal(signal.SIGKILL)
    deadline = time.monotonic() + 60
    while any(map(alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not any(map(alive, workers)) and not list((tmp_path / "results").iterdir())
    running.communicate(timeout=60)


def alive(process: int) -> bool:
    """Whether a process runs; one that has ended, and that nobody has asked for yet, does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
