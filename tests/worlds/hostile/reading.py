"""Reads part of a corpus in a process of its own, as tests do it."""

from __future__ import annotations

import subprocess
import sys

from tests.worlds.files.machines import environment


def read_corpus(corpus: str, first: int, count: int) -> None:
    """Read `count` hostile files of a corpus; print the sums, and fail if one ended as it must not."""
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "tests.worlds.hostile.corpus", corpus, str(first), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment(**one))
    print(done.stdout)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr[-5000:]}"
