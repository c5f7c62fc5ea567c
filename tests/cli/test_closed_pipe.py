"""A command whose output nobody reads any more ends quietly."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("words", [["version"], ["--version"], ["scenes", "list"]], ids=" ".join)
def test_a_reader_that_is_gone_is_no_error(words: list[str]) -> None:
    """It is gone before the first line, so that every write meets a closed pipe."""
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(
        [sys.executable, "-m", "hazard_ms.cli", *words], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert (ended.returncode, ended.stderr) == (0, "")
