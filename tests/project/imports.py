"""Which module of the package imports which: everything counts, inside functions and for type checking, too."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "hazard_ms"


def module_of(path: Path) -> str:
    """Name of a file in the package without "hazard_ms": "scenes.choice", "env" for a folder's own, "__init__"."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


def modules() -> dict[str, Path]:
    """All modules of the package by name."""
    return {module_of(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def imports(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """Modules of the package, out of those that are `known`, that a file imports."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] == "hazard_ms":
                    yield alias.name.removeprefix("hazard_ms").removeprefix(".") or "__init__"
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "hazard_ms":
            assert node.level == 0, f"{path}: relative imports hide where things are"
            base = str(node.module).removeprefix("hazard_ms").removeprefix(".")
            for alias in node.names:
                inner = f"{base}.{alias.name}" if base else alias.name
                yield inner if inner in known else base or "__init__"


@cache
def graph() -> dict[str, set[str]]:
    """Each module of the package -> the others that it imports."""
    known = modules()
    return {name: set(imports(path, known)) - {name} for name, path in known.items()}


def circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Groups of nodes that can be reached from each other (Tarjan's strongly connected components)."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        order[node] = low[node] = len(order)
        stack.append(node)
        for other in sorted(edges.get(node, ())):
            if other not in order:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], order[other])
        if low[node] == order[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                found.append(sorted(group))

    for node in sorted(edges):
        if node not in order:
            visit(node)
    return found


def room(module: str) -> str:
    """The file or folder directly in the package that holds a module."""
    return module.split(".")[0]


def arrows() -> set[tuple[str, str]]:
    """Pairs of rooms of which the first imports from the second; setup.py and examples are rooms, too."""
    known = modules()
    pairs = {(room(a), room(b)) for a, used in graph().items() for b in used}
    for name, files in (("setup.py", [ROOT / "setup.py"]), ("examples", sorted((ROOT / "examples").glob("*.py")))):
        pairs |= {(name, room(b)) for file in files for b in imports(file, known)}
    return {(a, b) for a, b in pairs if a != b}


def rooms() -> list[str]:
    """All rooms."""
    return sorted({room(name) for name in modules()} | {"setup.py", "examples"})
