"""Lines of the package, room by room: `./run python -m tests.project.sizes` prints what docs/size.md must hold.

A line of Python is code, words (docstrings and comments that stand alone) or blank.
"""

from __future__ import annotations

import ast
import io
import subprocess
import sys
import tokenize
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from tests.project.imports import PACKAGE, ROOT, arrows, rooms

DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
PAGES = (".js", ".css", ".html", ".j2")  # of other languages than Python: pages, and prompts of language models
DATA = (".json", ".safetensors", ".typed")
TOP = "top"  # modules directly in the package


class Size(NamedTuple):
    """Numbers of files, lines, lines of code, and lines of words; the rest is blank."""

    files: int
    lines: int
    code: int
    words: int


def size_of(paths: Iterable[Path]) -> Size:
    """The size of Python files together."""
    each = [_lines(path.read_text(encoding="utf-8")) for path in paths]
    return Size(len(each), *(sum(numbers) for numbers in zip(*each, strict=True)))


def _lines(text: str) -> tuple[int, int, int]:
    """Lines of a module, lines of code, and lines of words."""
    told: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            told |= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    told |= {t.start[0] for t in tokens if t.type == tokenize.COMMENT and t.line.lstrip().startswith("#")}
    lines = text.splitlines()
    code = [line for number, line in enumerate(lines, 1) if line.strip() and number not in told]
    return len(lines), len(code), len(told)


def room_sizes() -> dict[str, Size]:
    """The size of each room of the package, by name."""
    made = {folder.name: size_of(folder.rglob("*.py")) for folder in sorted(PACKAGE.glob("[a-z]*/"))}
    return {**made, TOP: size_of(PACKAGE.glob("*.py"))}


def totals() -> dict[str, tuple[int, int]]:
    """Numbers of files and lines of other kinds: Python here and elsewhere, pages, data (whose lines mean nothing)."""
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    paths = [ROOT / name for name in tracked.stdout.split("\0") if name]
    package = [path for path in paths if PACKAGE in path.parents]
    found = {
        "package": [path for path in package if path.suffix == ".py"],
        "pages": [path for path in package if path.suffix in PAGES],
        "data": [path for path in package if path.suffix in DATA],
        **{name: [p for p in paths if ROOT / name in p.parents and p.suffix == ".py"] for name in OTHERS},
    }
    return {name: (len(files), 0 if name == "data" else _sum(files)) for name, files in found.items()}


OTHERS = ("tests", "results", "examples")  # folders beside the package


def _sum(paths: Iterable[Path]) -> int:
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)


def main() -> None:
    """Print the numbers."""
    sizes = room_sizes()
    for name, size in sizes.items():
        print(f"| `{name}/` | " + " | ".join(f"{number:,}" for number in size) + " |")
    every = Size(*(sum(numbers) for numbers in zip(*sizes.values(), strict=True)))
    print("| all | " + " | ".join(f"**{number:,}**" for number in every) + " |")
    for name, (files, lines) in totals().items():
        print(f"{name}: {files:,} files, {lines:,} lines")
    print(f"{len(rooms())} rooms, {len(arrows())} imports between rooms")


if __name__ == "__main__":
    sys.exit(main())
