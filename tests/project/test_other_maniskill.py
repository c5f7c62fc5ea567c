"""The package with another version of ManiSkill, in an environment of its own: docs/maniskill_internals.md.

HAZARD_MS_MANISKILL names it as pip does, for example mani-skill-nightly==2026.8.2.400.
"""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.project.maniskill_names import rooms_by_attribute
from tests.worlds.files.checkout import ROOT, THIS_PYTHON, installed_uv, pins

WANTED = os.environ.get("HAZARD_MS_MANISKILL", "")
PIN = re.compile(r"^mani-skill==(?:[^\n]*\\\n)*[^\n]*\n", re.M)


def lock_without_maniskill() -> str:
    """The lock without ManiSkill and its hashes."""
    text, count = PIN.subn("", (ROOT / "requirements.lock").read_text(encoding="utf-8"))
    assert count == 1 and "mani-skill" not in text
    return text


def test_the_lock_can_be_had_without_maniskill() -> None:
    left, every = (pins(text) for text in (lock_without_maniskill(), (ROOT / "requirements.lock").read_text()))
    assert left == [pin for pin in every if not pin[0].startswith("mani-skill==")] and len(left) == len(every) - 1


@pytest.mark.long
@pytest.mark.setup
@pytest.mark.timeout(3600)
def test_every_task_plays_with_another_maniskill(tmp_path: Path) -> None:
    if not WANTED:
        pytest.skip("HAZARD_MS_MANISKILL names no version")
    folder = installed_uv()
    if folder is None:
        pytest.skip("./run has not installed uv")
    python, lock = tmp_path / "env/bin/python", tmp_path / "lock.txt"
    lock.write_text(lock_without_maniskill(), encoding="utf-8")
    uv = [str(folder / "bin/uv")]
    told = {**os.environ, "VIRTUAL_ENV": str(tmp_path / "env"), "PYTHONPATH": str(ROOT)}
    told |= {"PYTHONPYCACHEPREFIX": str(tmp_path / "pycache"), "OMP_NUM_THREADS": "1"}
    for command in (
        [*uv, "venv", "--quiet", "--python", THIS_PYTHON, str(tmp_path / "env")],
        [*uv, "pip", "sync", "--quiet", "--python", str(python), "--no-build", str(lock)],
        [*uv, "pip", "install", "--quiet", "--python", str(python), "--no-deps", WANTED],
    ):
        subprocess.run(command, env=told, check=True, timeout=1200)
    for words in (["tests.project.maniskill_names", *rooms_by_attribute()], ["tests.project.other_maniskill"]):
        done = subprocess.run(
            [str(python), "-m", *words], cwd=ROOT, env=told, capture_output=True, text=True, check=False, timeout=3000
        )
        print(done.stdout)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
