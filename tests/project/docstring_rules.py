"""Counts public docstrings of the package that break its rules, and prints each with its place.

    python -m tests.project.docstring_rules [--rules a,b,c,d,e] [path prefix ...]

a  Every public module, class, function and method has a docstring that stands alone. A method may leave it to the
   base class whose contract it keeps.
b  Functions that take or return tensors or arrays give a shape, [E, B, 3] say, and a unit, [m] say, unless they are
   about booleans, indices, counts, shares and the like.
c  Functions that raise name the error that callers meet: "Raises ValueError ...".
d  Numeric constants of modules say in a comment what they are.
e  Error messages have one form: "X must be A, got B".
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tests.project.constant_rules import bare_constants, messages

ROOT = Path(__file__).parents[2]
PACKAGE = "hazard_ms"

# Openings of docstrings that continue the name of what they describe, or the text before them.
LEANING = re.compile(
    r"(?:Of|For|That|To|As|With|Without|By|From|In|On|At|Like|Beside|Between|Behind|Into|Onto|Per|Than|Since|Because|"
    r"And|But|Or|Nor|So|Also|Not|Its|It|They|Them|Their|Those|These|This|He|She|His|Her|Which|Who|Whom|Whose|Where|When|"
    r"Why|How|What|Let there|Were|Has|Have|Is|Are|Be|No more|[XYZ] up)\b"
)
SENTENCE = re.compile(r"[^\s.]\S*[.](?=\s|$)|[.][)`\"'](?=\s|$)")
KEPT = re.compile(r"See `?[\w.]+`?\.")  # says no more than that the method keeps the contract of its base
FEWEST_WORDS = 3  # of a first sentence: fewer only repeat the name

ARRAY = re.compile(r"\b(?:Tensor|NDArray|ndarray|ArrayLike)\b")
BRACKETS = re.compile(r"\[([^\[\]]+)\]")
DIMENSION = re.compile(r"\.\.\.|\*\w+|\d+|[A-Z][A-Za-z0-9_]*(?: ?[-+*] ?\w+)?|[a-z]\w*")
UNITS = set(
    "m s rad kg N C K Pa W kW J kJ MJ Hz deg degrees ms us px % ppm g h min km mm cm frame frames pixel pixels byte "
    "bytes GB MB GiB MiB USD SI".split()
)
WITHOUT_UNIT = re.compile(
    r"\b(?:bool(?:ean)?|mask|whether|which|index|indices|counts?|numbers?|how many|shares?|fractions?|ratios?|rows|"
    r"probability|probabilities|chances?|labels?|ids?|codes?|colou?rs?|RGB|RGBA|pixels?|pictures?|images?|quaternions?|"
    r"rotations?|unit vectors?|normals?|directions?|dimensionless|seeds?|rewards?|scores?|noise|faces|order|strength|"
    r"lightness|albedo|steps?|frames?|actions?|features?|names?|state|SI|uint8|matrix|matrices|0 to 1|0\.\.1)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Fault:
    """One thing that breaks a rule."""

    rule: str
    path: str
    line: int
    name: str
    what: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.rule} {self.name}: {self.what}"


@dataclass
class Package:
    """All classes of the package: the bases and the documented methods of each, by name."""

    bases: dict[str, list[str]] = field(default_factory=dict)
    methods: dict[str, dict[str, str]] = field(default_factory=dict)

    def add(self, tree: ast.Module) -> None:
        """Note the classes of one module."""
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                self.bases[node.name] = [ast.unparse(base).split("[")[0].split(".")[-1] for base in node.bases]
                self.methods[node.name] = {f.name: ast.get_docstring(f) or "" for f in node.body if is_function(f)}

    def contract(self, cls: str, method: str) -> str:
        """The docstring of the method of a base that `method` of `cls` overrides; empty where there is none.

        A base outside the package is documented by its own project.
        """
        for base in self.bases.get(cls, ()):
            if base not in self.methods:
                if base not in ("object", "Enum", "IntEnum", "NamedTuple", "ABC", "Protocol", "Generic", "TypedDict"):
                    return f"See {base}."
            elif found := self.methods[base].get(method) or self.contract(base, method):
                return found
        return ""


def is_function(node: ast.AST) -> bool:
    """Whether the node defines a function."""
    return isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)


def stands_alone(doc: str) -> str:
    """What keeps the docstring from standing alone; empty if it does."""
    summary = " ".join(doc.split("\n\n")[0].split())
    if not re.match(r"[A-Z`]", summary):
        return f"begins with neither a capital letter nor a backquoted name: {summary[:60]!r}"
    if not SENTENCE.search(summary):
        return f"first sentence lacks its full stop: {summary[:60]!r}"
    if LEANING.match(summary):
        return f"leans on what is before it: {summary[:60]!r}"
    if len(re.findall(r"[\w`]+", summary.split(". ")[0])) < FEWEST_WORDS:
        return f"too short to stand alone: {summary!r}"
    return ""


def is_unit(text: str) -> bool:
    """Whether a text in brackets is a unit: kg/m^3, say, or -."""
    words = re.findall(r"[A-Za-z%]+", text)
    return (
        text == "-"
        or bool(words)
        and set(words) <= UNITS
        and not re.search(r"(?:^|, )\d|\.\.\.", text.removeprefix("1/"))
    )


def is_shape(text: str) -> bool:
    """Whether a text in brackets is a shape: E, B, 3, say."""
    sizes = text.split(", ")
    if is_unit(text) or not all(DIMENSION.fullmatch(size) for size in sizes):
        return False
    return len(sizes) > 1 or not text[0].islower()


def raised(function: ast.FunctionDef) -> list[str]:
    """Names of public exceptions that the function's own body raises; "" for one made elsewhere."""
    names = []
    todo: list[ast.AST] = list(function.body)
    while todo:
        node = todo.pop()
        if is_function(node) or isinstance(node, ast.ClassDef | ast.Lambda):
            continue
        if isinstance(node, ast.Raise) and node.exc is not None:
            made = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            name = made.id if isinstance(made, ast.Name) else made.attr if isinstance(made, ast.Attribute) else ""
            if isinstance(made, ast.Name) and name[:1].isupper():
                names.append(name)
            elif not isinstance(made, ast.Name) and not name.startswith("_"):
                names.append("")
        todo.extend(ast.iter_child_nodes(node))
    return [name for name in names if name not in ("NotImplementedError", "AssertionError", "StopIteration")]


def takes_arrays(function: ast.FunctionDef) -> bool:
    """Whether a tensor or an array is among the function's parameters or results."""
    arguments = function.args
    every = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    hints = [argument.annotation for argument in every] + [function.returns]
    return any(hint is not None and ARRAY.search(ast.unparse(hint)) for hint in hints)


def function_faults(function: ast.FunctionDef, cls: str, package: Package) -> Iterator[tuple[str, str]]:
    """Rule and text of what is wrong with one public function or method."""
    doc, contract = ast.get_docstring(function) or "", package.contract(cls, function.name) if cls else ""
    decorators = {ast.unparse(decorator).split("(")[0] for decorator in function.decorator_list}
    if not doc:
        if not contract and not any(name.endswith((".setter", "overload")) for name in decorators):
            yield "a", "no docstring"
        doc = contract
    elif not (contract and KEPT.fullmatch(doc)) and (fault := stands_alone(doc)):
        yield "a", fault
    if takes_arrays(function) and not contract and doc:
        brackets = BRACKETS.findall(doc)
        if not any(map(is_shape, brackets)):
            yield "b", "no shape in brackets"
        if not any(map(is_unit, brackets)) and not WITHOUT_UNIT.search(doc):
            yield "b", "no unit in brackets"
    names = raised(function)
    said = doc + contract
    missing = [name for name in names if not re.search(r"\braises\b", said, re.IGNORECASE) or name not in said]
    if missing:
        yield "c", f"does not say that it raises {missing[0] or 'an error'}"


def public(body: list[ast.stmt], cls: str = "") -> Iterator[tuple[str, ast.FunctionDef | ast.ClassDef]]:
    """Public classes, functions and methods with the name of their class."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield cls, node
            if isinstance(node, ast.ClassDef):
                yield from public(node.body, node.name)
        elif isinstance(node, ast.If | ast.Try):
            yield from public([child for child in ast.iter_child_nodes(node) if isinstance(child, ast.stmt)], cls)


def module_faults(path: str, text: str, package: Package) -> Iterator[Fault]:
    """All faults of one module."""
    tree = ast.parse(text)
    doc = ast.get_docstring(tree)
    if doc is None:
        if tree.body:
            yield Fault("a", path, 1, "module", "no docstring")
    elif fault := stands_alone(doc):
        yield Fault("a", path, 1, "module", fault)
    for cls, node in public(tree.body):
        name = f"{cls}.{node.name}".lstrip(".")
        if isinstance(node, ast.ClassDef):
            doc = ast.get_docstring(node)
            fault = stands_alone(doc) if doc else "no docstring"
            if fault:
                yield Fault("a", path, node.lineno, name, fault)
        else:
            for rule, fault in function_faults(node, cls, package):
                yield Fault(rule, path, node.lineno, name, fault)
    for line, constant in bare_constants(tree, text):
        yield Fault("d", path, line, constant, "constant without unit, meaning or source")
    for line, message in messages(tree):
        yield Fault("e", path, line, "message", f'not "X must be A, got B": {message[:60]!r}')


def faults(texts: dict[str, str], prefixes: tuple[str, ...] = ("",)) -> list[Fault]:
    """Every fault of the modules `texts`, by path, whose path begins with one of `prefixes`."""
    package = Package()
    for text in texts.values():
        package.add(ast.parse(text))
    chosen = [path for path in texts if path.startswith(tuple(prefixes))]
    return [fault for path in chosen for fault in module_faults(path, texts[path], package)]


def package_texts() -> dict[str, str]:
    """The text of every module of the package, by path."""
    return {str(path.relative_to(ROOT)): path.read_text() for path in sorted((ROOT / PACKAGE).rglob("*.py"))}


def main(arguments: list[str]) -> int:
    """Print the faults and how many there are; 1 if there are any."""
    rules = "abcde"
    if arguments[:1] == ["--rules"]:
        rules, arguments = arguments[1], arguments[2:]
    found = [fault for fault in faults(package_texts(), tuple(arguments) or ("",)) if fault.rule in rules]
    for fault in found:
        print(fault)
    print({rule: sum(fault.rule == rule for fault in found) for rule in "abcde"}, len(found), "in all")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
