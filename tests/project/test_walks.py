"""The walks of docs/architecture.md go through files that there are, and name what stands in them."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from tests.project.imports import PACKAGE, ROOT

PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
STEP = re.compile(r"^(\d+)\. `([\w/]+\.py)`: (.+)$", re.M)
WALKS = 5


def walks(text: str) -> list[list[tuple[int, str, str]]]:
    """The steps of each walk: number, file, and what is told of it."""
    part = text.partition("\n## Five walks\n")[2].partition("\n## ")[0]
    return [[(int(n), file, told) for n, file, told in STEP.findall(walk)] for walk in part.split("\n**")[1:]]


def names(path: Path) -> set[str]:
    """Functions, classes, variables and fields of a file, and the names of arguments that it gives."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.keyword) and node.arg:
            found.add(node.arg)
    return found


def wrong(text: str) -> list[str]:
    """Steps that are out of order, whose file is not there, or whose first name does not stand in it."""
    found = []
    for walk in walks(text):
        for place, (number, file, told) in enumerate(walk, 1):
            named = re.match(r"`(\w+)`", told)
            path = PACKAGE / file
            if number != place or named is None or not path.is_file() or named[1] not in names(path):
                found.append(f"{number}. {file}: {told}")
    return found


def test_there_are_five_and_they_lead_through_the_code() -> None:
    found = walks(PAGE)
    assert len(found) == WALKS and all(len(walk) > 5 for walk in found)
    assert wrong(PAGE) == []
    for walk in found:
        files = [file for _, file, _ in walk]
        assert len(set(files)) == len(files), "a file is opened once"


def test_a_wrong_turn_is_noticed() -> None:
    head = "\n## Five walks\n\n**A**:\n\n"
    good = "1. `spec/checks.py`: `action` refuses.\n2. `env/inputs.py`: `reset` too.\n"
    assert wrong(head + good) == [] and len(walks(head + good + "\n## B\n1. `c.py`: d\n")) == 1
    for bad in (good.replace("2.", "3."), good.replace("inputs", "outputs"), good.replace("`action`", "`actions`")):
        assert len(wrong(head + bad)) == 1
