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
from hazard_ms.evaluation.result import EpisodeResult
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

class Looks(Fine):
    def reset(self, brief):
        self.looked = False

    def act(self, decision):
        if not self.looked:
            self.looked = True
            return Action("explore")
        return self.fail()

class Junk(Looks):
    def fail(self):
        return "pick up everything"

class Late(Looks):
    def fail(self):
        time.sleep(1000)

class Shot(Looks):
    def fail(self):
        os.kill(os.getpid(), 9)

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


def test_an_agent_that_fails_costs_its_episodes_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table holds the episode that another agent has finished."""
    (tmp_path / "own.py").write_text(AGENTS, encoding="utf-8")
    monkeypatch.chdir(tmp_path)  # where the agent's file is hashed, so that its episode is not played again
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
        ("Dies", "worker died: killed or by os._exit"),
    ):
        (said,) = (line for line in lines if line.startswith(f"no result: own.py:{name}, seed 0: "))
        assert told in said and "to see it again: hazard-ms play -e HazardFire-v1" in said
        assert f"--agent own.py:{name} -s 0" in said
        assert f"own.py:{name}: ended by 1 error; failures: none" in lines
    assert list((tmp_path / "results").iterdir()) == [options.place(finished)]


def test_an_agent_that_fails_later_is_scored_by_what_it_had_done(tmp_path: Path) -> None:
    """All looked around for 60 frames; the process of one was lost twice. The next run plays them again."""
    names = ("Junk", "Late", "Shot")
    options = SweepOptions(agents=tuple(f"own.py:{name}" for name in names), output=tmp_path / "results")
    running = evaluate(tmp_path, "--episodes", "1", "--timeout", "5", "--agents", *options.agents)
    out, error = running.communicate(timeout=PATIENCE)
    assert running.returncode == 1, error[-3000:]
    for name, ended, told in (
        ("Junk", "error", "ValueError: an action must be an Action(verb, target), got 'pick up everything'"),
        ("Late", "too slow", "too slow: a decision took longer than 5 s"),
        ("Shot", "worker died", "worker died: killed or by os._exit"),
    ):
        (path,) = (tmp_path / "results").glob(f"*{name}*.json")
        result = EpisodeResult.read(path)
        assert result.ended == ended and result.error.startswith(told), result.error
        assert [d.verb for d in result.decisions] == ["explore"] and result.frames == result.decisions[0].frames > 50
        assert result.links[-1].frame == result.frames
        assert f"own.py:{name}: ended by 1 {ended}; failures: none" in out.splitlines()
        assert f"not finished: own.py:{name}, seed 0: {told}" in out
    assert "workers died in 1 episodes, which were played a second time" in out


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
