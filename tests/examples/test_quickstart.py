"""The first example runs, with a renderer and without."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

ROOT = Path(__file__).parents[2]


def run(folder: Path, **environ: str) -> str:
    words = [sys.executable, str(ROOT / "examples" / "quickstart.py")]
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder, env={**os.environ, **environ}, timeout=250)
    assert done.returncode == 0, done.stderr[-2000:]
    assert re.search(r"rescued 0 of [1-9]\d* targets", done.stdout) and "observations: float32" in done.stdout
    return done.stdout


@pytest.mark.render
def test_it_ends_with_a_picture(tmp_path: Path) -> None:
    assert "picture: quickstart.png" in run(tmp_path)
    picture = cv2.imread(str(tmp_path / "quickstart.png"))
    assert picture is not None and min(picture.shape[:2]) >= 256 and picture.std() > 20


@pytest.mark.long
def test_it_runs_where_nothing_draws(tmp_path: Path) -> None:
    out = run(tmp_path, HAZARD_MS_RENDER="none")
    assert "picture" not in out and not list(tmp_path.iterdir())
