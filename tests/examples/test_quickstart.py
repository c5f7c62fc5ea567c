"""The first example runs, with a renderer and without."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "quickstart.py"


def check(out: str) -> None:
    assert re.search(r"rescued 0 of [1-9]\d* targets", out) and "observations: float32" in out


@pytest.mark.render
def test_it_ends_with_a_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In this process, since the first picture of a new one takes it 10 s."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    out = capsys.readouterr().out
    check(out)
    assert "picture: quickstart.png" in out
    picture = cv2.imread(str(tmp_path / "quickstart.png"))
    assert picture is not None and min(picture.shape[:2]) >= 256 and picture.std() > 20


@pytest.mark.long
def test_it_runs_where_nothing_draws(tmp_path: Path) -> None:
    environ = {**os.environ, "HAZARD_MS_RENDER": "none"}
    done = subprocess.run(
        [sys.executable, str(EXAMPLE)], capture_output=True, text=True, cwd=tmp_path, env=environ, timeout=250
    )
    assert done.returncode == 0, done.stderr[-2000:]
    check(done.stdout)
    assert "picture" not in done.stdout and not list(tmp_path.iterdir())
