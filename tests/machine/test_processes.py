"""Processes that work for another one end with it, however it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

PARENT = """
import multiprocessing, os, sys, time
from concurrent.futures import ProcessPoolExecutor
from hazard_ms.machine.processes import end_with_parent

if __name__ == "__main__":
    pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), initializer=end_with_parent)
    print(pool.submit(os.getpid).result(), flush=True)
    for _ in range(3):
        pool.submit(time.sleep, 600)
    time.sleep(600)
"""


def test_a_killed_process_leaves_none_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "parent.py").write_text(PARENT)
    with subprocess.Popen([sys.executable, tmp_path / "parent.py"], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        os.kill(child, 0)  # raises an error where there is no such process
        time.sleep(0.5)  # until it has something to do
        parent.send_signal(signal.SIGKILL)
    until = time.monotonic() + 20.0
    while Path(f"/proc/{child}").exists() and "Z" not in state(child) and time.monotonic() < until:
        time.sleep(0.1)
    assert not Path(f"/proc/{child}").exists() or "Z" in state(child)


FORKS = """
import multiprocessing, os, time
from hazard_ms.machine.processes import end_with_parent

def work():
    end_with_parent()
    if copy := os.fork():
        print(copy, flush=True)  # not the copy: it may end before it gets to that
    else:
        time.sleep(600)

if __name__ == "__main__":
    worker = multiprocessing.get_context("spawn").Process(target=work)
    worker.start()
    worker.join()
"""


def test_a_copy_that_a_process_made_of_itself_ends_with_it(tmp_path: Path) -> None:
    (tmp_path / "parent.py").write_text(FORKS)
    with subprocess.Popen([sys.executable, tmp_path / "parent.py"], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        copy = int(parent.stdout.readline())
        parent.wait()
    until = time.monotonic() + 20.0
    while state(copy) != "Z" and time.monotonic() < until:
        time.sleep(0.1)
    assert state(copy) == "Z"


def state(process: int) -> str:
    """The letter that says what a process does: Z for one that has ended, but was not yet asked for its result."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"
