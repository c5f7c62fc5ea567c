"""What the README shows works: its Python blocks run, its commands exist, and its table of keywords names what the environment takes."""

from __future__ import annotations

import inspect
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms.cli import COMMANDS

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, re.S)
COMMAND_LINES = [line for block in re.findall(r"```bash\n(.*?)```", TEXT, re.S) for line in block.splitlines() if line.strip()]

WITH_COMMANDS = ("scenes", "assets")  # commands that have commands of their own


def needs_pictures(block: str) -> bool:
    return 'render_backend="none"' not in block


@pytest.mark.parametrize(
    "block", [pytest.param(b, marks=[pytest.mark.render] if needs_pictures(b) else []) for b in BLOCKS], ids=range(len(BLOCKS))
)
def test_python_blocks_run(block: str) -> None:
    done = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, timeout=280, cwd=ROOT)
    assert done.returncode == 0, done.stderr[-3000:]
    if "print(" in block:
        assert done.stdout.strip()


def test_there_are_blocks_and_commands() -> None:
    assert len(BLOCKS) >= 3 and "./run demo" in COMMAND_LINES


@pytest.mark.parametrize("line", COMMAND_LINES)
def test_commands_exist(line: str) -> None:
    words = shlex.split(line, comments=True)
    if words[0] == "./run":
        assert re.search(rf"^\s+{re.escape(words[1])}\)|\b{re.escape(words[1])}\b.*\)", (ROOT / "run").read_text(), re.M)
        return
    assert words[0] == "hazard-ms"
    inner = words[2:3] if words[1] in WITH_COMMANDS else []
    help_text = subprocess.run(
        [sys.executable, "-m", "hazard_ms.cli", words[1], *inner, "--help"], capture_output=True, text=True, timeout=100, cwd=ROOT
    )
    assert words[1] in COMMANDS and help_text.returncode == 0
    for flag in (w for w in words[2:] if w.startswith("-")):
        assert re.search(rf"(^|\W){re.escape(flag)}\b", help_text.stdout), f"{flag} is no option of {words[1]}"


def test_keywords_of_the_table_are_those_of_the_environment() -> None:
    from hazard_ms.env import HazardEnv

    named = set(re.findall(r"^\| `(\w+)` \|", TEXT, re.M))
    assert named and named <= set(inspect.signature(HazardEnv.__init__).parameters)
