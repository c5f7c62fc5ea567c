"""Nobody waits for an environment whose process is gone or hangs, and no process stays behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from gymnasium.error import ClosedEnvironmentError

from hazard_ms.learning.vector import LostEnvironmentError, make
from tests.worlds.naughty_env import DIE, NAP, SLEEP, SPIN, WALK
from tests.worlds.naughty_vector import NAME, SOON, naughty, pids

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("action", [DIE, SLEEP])
def test_who_dies_or_hangs_in_a_step_is_named_soon(action: int) -> None:
    before = pids()
    with naughty(5, patience=20.0) as envs:
        envs.reset(seed=0)
        start = time.monotonic()
        with pytest.raises(LostEnvironmentError, match="environment 3 is lost, and with it 2, 4: its process") as lost:
            envs.step([WALK, WALK, WALK, action, WALK])
        assert time.monotonic() - start < SOON
        assert lost.value.numbers == (3, 2, 4)
        assert ("ended by itself with code 7" if action == DIE else "hangs") in str(lost.value)
        assert pids() == before
        with pytest.raises(ClosedEnvironmentError):
            envs.step([WALK] * 5)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_whose_process_is_killed_or_stopped_is_named_soon(how: signal.Signals) -> None:
    """The one that goes on computes for ever, so that it is not its answer that ends the wait."""
    before = pids()
    with naughty(2, patience=20.0) as envs:
        envs.reset(seed=0)
        victim = max(pids() - before)  # started last
        threading.Timer(0.5, os.kill, (victim, how)).start()
        start = time.monotonic()
        with pytest.raises(LostEnvironmentError, match=f"environment 1 is lost: its process {victim}") as lost:
            envs.step([SPIN, SPIN])
        assert 0.5 < time.monotonic() - start < 0.5 + SOON
        assert ("was ended by SIGKILL" if how == signal.SIGKILL else "hangs") in str(lost.value)


def test_who_computes_for_longer_than_it_may_is_named() -> None:
    with naughty(2, patience=1.0) as envs:
        envs.reset(seed=0)
        with pytest.raises(LostEnvironmentError, match="environment 0 is lost: its process .* took longer than 1 s"):
            envs.step([SPIN, WALK])


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C interrupts, also where the tests were started in the background, which ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_closing_ends_those_that_are_in_a_step() -> None:
    """Ctrl-C breaks the wait off; what was asked then is never taken for the answer to something else."""
    before, envs = pids(), make(NAME, 2, processes=2)
    envs.reset(seed=0)
    threading.Timer(0.5, signal.raise_signal, (signal.SIGINT,)).start()
    with pytest.raises(KeyboardInterrupt):
        envs.step([WALK, SPIN])
    with pytest.raises(ValueError, match="call reset first"):
        envs.step([WALK, WALK])
    start = time.monotonic()
    envs.close()
    assert time.monotonic() - start < SOON and pids() == before


@pytest.mark.usefixtures("interruptible")
def test_answers_to_what_was_broken_off_are_left_out() -> None:
    with naughty(2) as envs:
        envs.reset(seed=0)
        threading.Timer(0.5, signal.raise_signal, (signal.SIGINT,)).start()
        with pytest.raises(KeyboardInterrupt):
            envs.step([WALK, NAP])  # ends in a second
        _, info = envs.reset(seed=0)
        assert info["length"].shape == (2,)
        assert envs.call("mood_of", "it") == ("it is fine",) * 2


def test_processes_end_with_a_program_that_is_killed() -> None:
    code = (
        "import os, signal, multiprocessing\n"
        "from hazard_ms.learning.vector import make\n"
        f"envs = make({NAME!r}, 2, processes=2)\n"
        "print(*[p.pid for p in multiprocessing.active_children()], flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, cwd=ROOT)
    started = [Path("/proc", word) for word in out.stdout.split()]
    assert len(started) == 2, out.stderr[-2000:]
    deadline = time.monotonic() + SOON
    while any(one.exists() for one in started) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(one.exists() for one in started)


def test_programs_without_a_guard_are_told_what_is_missing(tmp_path: Path) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(f"from hazard_ms.learning.vector import make\nmake({NAME!r}, 1)\n")
    environ = {**os.environ, "PYTHONPATH": str(ROOT)}
    out = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60, env=environ)
    assert out.returncode == 1 and "LostEnvironmentError" in out.stderr and "__main__" in out.stderr
