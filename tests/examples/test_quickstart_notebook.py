"""The notebook has the form of nbformat 4.5 with nothing played in it, and plays from top to bottom."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from IPython.core.inputtransformer2 import TransformerManager

from tests.project.test_readme import check_line
from tests.worlds.files.checkout import ROOT

NOTEBOOK = ROOT / "examples/quickstart.ipynb"
LARGEST = 10_000  # bytes: text alone
# Runs cells as Jupyter does, and ends at the first that fails; a command's code is where IPython puts it.
PLAY = """
import json, sys
from IPython.core.interactiveshell import InteractiveShell

shell = InteractiveShell.instance()
for cell in json.load(open(sys.argv[1])):
    shell.run_cell(cell).raise_error()
    assert not shell.user_ns.get("_exit_code"), cell
pictures = shell.user_ns["pictures"]
print(len(pictures), *pictures[0].shape, int(pictures[-1].std()), int(shell.user_ns["info"]["rescued"]))
"""


def notebook() -> dict[str, Any]:
    """The notebook as data."""
    return json.loads(NOTEBOOK.read_text(encoding="utf-8"))


def code() -> list[str]:
    """The texts of the cells of code."""
    return ["".join(cell["source"]) for cell in notebook()["cells"] if cell["cell_type"] == "code"]


def commands() -> list[str]:
    """The lines that a cell gives to a shell."""
    return [line[1:] for text in code() for line in text.splitlines() if line.startswith("!")]


def test_it_has_the_form_of_a_notebook_and_holds_nothing_played() -> None:
    told = notebook()
    assert (told["nbformat"], told["nbformat_minor"]) == (4, 5) and set(told["metadata"]) >= {"kernelspec"}
    ids = [cell["id"] for cell in told["cells"]]
    assert len(set(ids)) == len(ids) and all(re.fullmatch(r"[\w-]{1,64}", name) for name in ids)
    for cell in told["cells"]:
        played = {"outputs", "execution_count"} if cell["cell_type"] == "code" else set()
        assert set(cell) == {"cell_type", "id", "metadata", "source"} | played
        assert not cell.get("outputs") and cell.get("execution_count") is None
        assert all(isinstance(line, str) for line in cell["source"])
    assert NOTEBOOK.stat().st_size < LARGEST


def test_its_cells_are_python_and_its_links_lead_somewhere() -> None:
    for text in code():
        ast.parse(TransformerManager().transform_cell(text))
    links = re.findall(r"\]\(([^)#]+)", "".join("".join(cell["source"]) for cell in notebook()["cells"]))
    assert links and all((NOTEBOOK.parent / link).resolve().is_file() for link in links)
    magics = [line for text in code() for line in text.splitlines() if line.startswith("%")]
    assert len(magics) == 1 and magics[0].startswith("%pip install -q hazard_ms ")


@pytest.mark.parametrize("line", commands())
def test_its_commands_are_valid(line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    check_line(line, capsys, monkeypatch)


@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(3600)
def test_it_plays_from_top_to_bottom(tmp_path: Path) -> None:
    """All but the installation, with the command `hazard-ms` of this environment, and no root."""
    (tmp_path / "bin").mkdir()
    command = tmp_path / "bin/hazard-ms"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m hazard_ms.cli "$@"\n')
    command.chmod(0o755)
    (tmp_path / "cells.json").write_text(json.dumps([text for text in code() if not text.startswith("%pip")]))
    environ = {
        **os.environ,
        "PATH": f"{tmp_path / 'bin'}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "HAZARD_MS_NO_SYSTEM": "1",
        "IPYTHONDIR": str(tmp_path / "ipython"),
    }
    played = subprocess.run(
        [sys.executable, "-c", PLAY, "cells.json"], cwd=tmp_path, env=environ, capture_output=True, text=True
    )
    assert played.returncode == 0, played.stdout[-3000:] + played.stderr[-3000:]
    number, height, width, colours, contrast, rescued = map(int, played.stdout.split("\n")[-2].split())
    assert number > 3 and (height, width, colours) == (512, 768, 3) and contrast > 20 and rescued > 0
    assert f"rescued {rescued} of " in played.stdout and list((tmp_path / "results").rglob("*.json"))
