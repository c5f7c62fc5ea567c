"""Tests that need a process of their own.

ManiSkill changes the pixel format of SAPIEN's stock packs for a whole process.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

MARK = "HAZARD_MS_TEST_ALONE"


def alone(test: Callable[..., None]) -> Callable[..., None]:
    """Run `test` in a new process, whatever ran in this one before."""

    @functools.wraps(test)
    def run(**arguments: Any) -> None:
        if os.environ.get(MARK):
            test(**arguments)
            return
        node = os.environ["PYTEST_CURRENT_TEST"].rsplit(" (", 1)[0]
        command = [sys.executable, "-m", "pytest", "-q", "--long", "-p", "no:cacheprovider", node]
        environ = {**{k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}, MARK: "1"}
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=280, cwd=Path(__file__).parents[2], env=environ
        )
        assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout[-4000:]

    return run
