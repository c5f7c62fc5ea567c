"""Rules for numeric constants and for error messages: see docstring_rules.py."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

ALLOWED_FORM = re.compile(r"\b(?:is|are) (?:all that is )?allowed\b")


def is_numeric(node: ast.expr | None) -> bool:
    """Whether an expression is made of numbers alone."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return is_numeric(node.operand)
    if isinstance(node, ast.BinOp):
        return is_numeric(node.left) and is_numeric(node.right)
    return isinstance(node, ast.Tuple | ast.List) and bool(node.elts) and all(map(is_numeric, node.elts))


def bare_constants(tree: ast.Module, text: str) -> Iterator[tuple[int, str]]:
    """Line and name of numeric constants without any comment on their lines, above them or above their group."""
    lines = text.splitlines()
    said = False  # whether the group of lines above begins with a comment
    for node, after in zip(tree.body, [*tree.body[1:], None], strict=True):
        above = lines[node.lineno - 2].strip() if node.lineno > 1 else ""
        said = above.startswith("#") or (said and bool(above) and isinstance(node, ast.Assign | ast.AnnAssign))
        if not isinstance(node, ast.Assign | ast.AnnAssign):
            continue
        name = ast.unparse(node.targets[0] if isinstance(node, ast.Assign) else node.target)
        documented = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        commented = said or documented or any("#" in line for line in lines[node.lineno - 1 : node.end_lineno])
        if re.fullmatch(r"[A-Z][A-Z0-9_]*", name) and is_numeric(node.value) and not commented:
            yield node.lineno, name


def messages(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of strings that name what is allowed in another form than "X must be A, got B"."""
    docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs:
            if ALLOWED_FORM.search(node.value):
                yield node.lineno, node.value.strip()
