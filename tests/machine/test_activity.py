"""Processes that compute and that sleep are told apart, and none is blamed for a time in which nobody looked."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from hazard_ms.machine.activity import GAP, Activity, processor_seconds

CODES = {"computes": "while True: pass", "sleeps": "import time; time.sleep(60)"}


@pytest.fixture
def child(request: pytest.FixtureRequest) -> Iterator[subprocess.Popen[bytes]]:
    made = subprocess.Popen([sys.executable, "-S", "-c", CODES[request.param]])
    time.sleep(0.5)  # it has begun
    yield made
    made.kill()
    made.wait()


def looks(activity: Activity, seconds: float) -> float:
    """Look often for some time: the last answer."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        time.sleep(0.05)
        idle = activity.idle_seconds()
    return idle


@pytest.mark.parametrize("child", ["computes"], indirect=True)
def test_who_computes_is_never_idle(child: subprocess.Popen[bytes]) -> None:
    activity, before = Activity(child.pid), processor_seconds(child.pid)
    assert looks(activity, 1.0) == 0.0
    assert processor_seconds(child.pid) > before


@pytest.mark.parametrize("child", ["sleeps"], indirect=True)
def test_who_sleeps_is_idle_while_somebody_looks(child: subprocess.Popen[bytes]) -> None:
    activity = Activity(child.pid)
    assert looks(activity, 1.0) == pytest.approx(1.0, abs=0.5)
    before = activity.idle_seconds()
    time.sleep(GAP + 2.0)  # as after Ctrl-Z, which stops all of a program
    assert activity.idle_seconds() - before == pytest.approx(GAP)


def test_what_cannot_be_seen_seems_to_work() -> None:
    activity = Activity(2**30)
    time.sleep(0.1)
    assert activity.idle_seconds() == 0.0 and processor_seconds(2**30) == 0.0
