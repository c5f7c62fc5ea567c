"""The tests that can notice a mistake in a file, the likeliest first."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

from tests.mutations.reading import Mutation
from tests.project.imports import PACKAGE, ROOT, imports, module_of, modules, room


def stages(mutation: Mutation) -> list[list[str]]:
    """Files of tests to run one group after the other: the expected one, those of the room, all that import the file.

    Files that import what is mutated, be it through a helper of tests, come first in their group.
    """
    file = ROOT / mutation.file
    module = module_of(file) if file.is_relative_to(PACKAGE) and file.suffix == ".py" else ""
    importing = [str(test.relative_to(ROOT)) for test in tests() if module and module in used_by(test)]
    folder = ROOT / "tests" / room(module)
    beside = [str(test.relative_to(ROOT)) for test in tests() if module and test.is_relative_to(folder)]
    groups = [[mutation.tests], sorted(beside, key=lambda test: test not in importing), importing]
    done: set[str] = set()
    fresh = []
    for group in groups:
        fresh.append([test for test in group if test not in done])
        done.update(group)
    return [group for group in fresh if group]


@cache
def tests() -> tuple[Path, ...]:
    """All files of tests."""
    return tuple(sorted((ROOT / "tests").rglob("test_*.py")))


@cache
def _known() -> dict[str, Path]:
    return modules()


@cache
def used_by(file: Path) -> frozenset[str]:
    """Modules of the package that a file of tests imports, itself or through helpers in tests/."""
    used = set(imports(file, _known()))
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("tests."):
            for name in (str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)):
                helper = ROOT / f"{name.replace('.', '/')}.py"
                used |= used_by(helper) if helper.is_file() and helper != file else frozenset()
    return frozenset(used)
