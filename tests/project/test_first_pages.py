"""The pages for the first ten minutes work from top to bottom, as a newcomer types them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.worlds.files.checkout import ROOT
from tests.worlds.files.documents import blocks, command_lines

PAGES = sorted((ROOT / "docs").glob("start_*.md"))
FILES = {"start_decide.md": "nearest.py"}  # that a reader is told to save a page's Python block as
LEAVES = {
    "start_train.md": ("trained/rl_HazardFire-v1.safetensors", "policy.mp4"),
    "start_demonstrate.md": ("demos.html", "lerobot_data", "cloned/bc_HazardFire-v1.safetensors"),
    "start_see.md": ("page.html", "data/fire-yolo/data.yaml", "moment.png", "seen.mp4"),
    "start_decide.md": ("planner.mp4", "model.mp4"),
}


def test_every_page_says_what_it_leaves() -> None:
    assert {path.name for path in PAGES} == set(LEAVES)


@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_a_page_works_from_top_to_bottom(page: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    for code in blocks(page, "python"):
        (tmp_path / FILES.get(page.name, "block.py")).write_text(code, encoding="utf-8")
    for line in command_lines(page):
        assert line.startswith("hazard-ms "), line
        words = [sys.executable, "-m", "hazard_ms.cli", *line.split()[1:]]
        done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, f"{line}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    if page.name not in FILES and blocks(page, "python"):
        done = subprocess.run(
            [sys.executable, "block.py"], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0 and done.stdout.strip(), done.stderr[-3000:]
    assert [name for name in LEAVES[page.name] if not (tmp_path / name).exists()] == []
