"""The examples in README and documents work.

Python blocks of the pages for beginners run, all others compile and what they import exists; command lines are parsed
by the commands themselves; the table of keywords names keywords of the environment.
"""

from __future__ import annotations

import ast
import functools
import inspect
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms.cli import __main__ as cli
from hazard_ms.spec.registry import TASKS
from tests.worlds.files.checkout import ROOT, run
from tests.worlds.files.documents import DOCUMENTS, blocks, command_lines, name_of

RUN = ("README.md", "docs/usage.md", "docs/agents.md", "docs/scenes.md", "docs/adding.md")
LONGEST_README = 80  # lines: about a screen
# commands that have commands of their own: to parse their words is to run them
NESTED = [name for name, command in cli.COMMANDS.items() if "done" in inspect.signature(command).parameters]
INTERPRETERS = ("python", "inspect")  # which are given files of ours
# not ours; tests/lerobot runs the last three
OTHERS = ("pip", "uv", "cd", "export", "lerobot-train", "lerobot-eval", "vla-eval", "docker")


def python_blocks() -> list[object]:
    """Every Python block once, with its document; those that need a renderer, or minutes, are marked."""
    found, seen = [], set()
    for path in DOCUMENTS:
        for number, block in enumerate(blocks(path, "python")):
            if block not in seen:
                seen.add(block)
                draws = "gym.make" in block and 'render_backend="none"' not in block
                marks = [pytest.mark.render] if draws else []
                if "gym.make" in block and name_of(path) != "README.md":
                    marks.append(pytest.mark.long)  # a process each
                found.append(pytest.param(path, block, marks=marks, id=f"{name_of(path)}-{number}"))
    return found


@pytest.mark.parametrize(("path", "block"), python_blocks())
def test_python_blocks_work(path: Path, block: str, tmp_path: Path) -> None:
    if name_of(path) not in RUN:
        imports = [node for node in ast.walk(ast.parse(block)) if isinstance(node, ast.Import | ast.ImportFrom)]
        block = "\n".join(map(ast.unparse, imports))
    if "gym.make" not in block:
        (tmp_path / "block.py").write_text(block)
        runpy.run_path(str(tmp_path / "block.py"))
        return
    done = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, timeout=280, cwd=ROOT)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "print(" not in block or done.stdout.strip()


def lines() -> list[object]:
    """Every command line once, with the document that shows it."""
    first = {line: path for path in reversed(DOCUMENTS) for line in command_lines(path)}
    return [pytest.param(line, id=f"{name_of(path)}-{line[:60]}") for line, path in first.items()]


def check_line(line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Raise unless the command of a line takes its arguments."""
    words = shlex.split(line, comments=True)
    while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
        words.pop(0)
    if words[0] == "./run":
        assert f"\n  ./run {words[1]} " in f"\n{run('--help').stdout}"
        words = words[1:]
    if words[0] == "hazard-ms":
        check_command(words[1:], capsys, monkeypatch)
    elif named := [word for word in words[1:3] if word.startswith("examples/")]:
        assert words[0] in INTERPRETERS and (ROOT / named[0]).is_file(), line
    else:
        assert line.startswith("./run") or words[0] in OTHERS or words[:2] == ["python", "-m"], line


def check_command(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Raise unless the command `hazard-ms` takes these words; nothing is played."""
    if words[0] in NESTED:
        with pytest.raises(SystemExit) as ended:
            cli.main([*words[:2], "--help"])
        said = capsys.readouterr().out
        assert ended.value.code == 0
        for flag in (word for word in words if word.startswith("-")):
            assert re.search(rf"(^|\W){re.escape(flag)}\b", said, re.M), f"{flag} must be an option of {words[1]}"
        return
    # the same signatures, so that the same parser is made, but nothing behind them
    idle = {name: functools.wraps(command)(lambda *a, **k: 0) for name, command in cli.COMMANDS.items()}
    monkeypatch.setattr(cli, "COMMANDS", idle)
    assert cli.main(words) == 0
    if "-e" in words and "--load" not in words:
        assert words[words.index("-e") + 1] in TASKS


@pytest.mark.parametrize("line", lines())
def test_command_lines_are_valid(
    line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    check_line(line, capsys, monkeypatch)


@pytest.mark.parametrize(
    "line",
    ["hazard-ms play --nonsense", "hazard-ms dance", "hazard-ms play -e HazardSnow-v1", "hazard-ms scenes list --x"]
    + ["./run dance", "rm -r x", "./run hazard-ms play --every many"],
)
def test_wrong_command_lines_are_noticed(
    line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises((AssertionError, SystemExit)):
        check_line(line, capsys, monkeypatch)


def test_the_readme_is_short_and_shows_what_matters() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST_README
    assert "./run demo" in text and "docs/demo.jpg" in text and blocks(ROOT / "README.md", "python")


def test_keywords_of_the_table_are_those_of_the_environment() -> None:
    from hazard_ms.env import HazardEnv

    section = (ROOT / "docs/usage.md").read_text(encoding="utf-8").split("## Keywords")[1].split("\n## ")[0]
    named = set(re.findall(r"^\| `(\w+)` \|", section, re.M))
    parameters = inspect.signature(HazardEnv.__init__).parameters.values()
    assert named == {p.name for p in parameters if p.kind is p.KEYWORD_ONLY} - {"task"}  # gym.make fills it in
