"""What code and documents cite is there: sections, cases and marks of docs/*.md, and every file that is named."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = next(folder for folder in Path(__file__).parents if (folder / "hazard_ms").is_dir())
WRITTEN = {"validation.md", "page.md", "gone.md"}  # written by a command where the user wants it, or by tests
CASE = r"[FILNW]-\d+"
REFERENCE = rf"(?:\d+(?:\.\d+)*|{CASE}|[RM]\d+)"
CITED = re.compile(rf"docs/([\w-]+)\.md\s+({REFERENCE}(?:(?:,|\s+and|\s+to)\s+{REFERENCE})*)(?![\w-])")
NAMED = re.compile(r"(?<![\w/.*{-])((?:[\w-]+/)*[\w-]+\.md)\b")
LITERAL = re.compile(r'(?<!")"[\w./-]+\.md"(?!")')  # a part of a path, which the code itself needs to be right
LINKED = re.compile(r"\]\((?!\w+:)([^)#\s]+)[^)]*\)")
FENCED = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)


def sources(root: Path) -> Iterator[tuple[str, str]]:
    """Every Python file below the folders of code: its name and its text, comments and docstrings unwrapped."""
    for folder in ("hazard_ms", "tests", "examples"):
        for path in sorted((root / folder).rglob("*.py")):
            if path.name != Path(__file__).name:
                text = path.read_text(encoding="utf-8")
                yield str(path.relative_to(root)), re.sub(r"\n\s*(?:#\s*)?", " ", text)


def pages(root: Path) -> dict[str, str]:
    """Every document, by its path from the root."""
    found = [*root.glob("*.md"), *sorted((root / "docs").rglob("*.md"))]
    return {str(p.relative_to(root)): p.read_text(encoding="utf-8") for p in found}


def anchors(page: str) -> set[str]:
    """What can be cited in a page: numbers of headings, and marks that begin a row of a table."""
    headings = re.findall(r"^#{2,6} (\d+(?:\.\d+)*)\b", page, re.MULTILINE)
    return {*headings, *re.findall(rf"^\| ({CASE}|[RM]\d+) \|", page, re.MULTILINE)}


def wrong_citations(root: Path) -> list[str]:
    """Citations of sections or marks that their document does not have."""
    known = {name: anchors(text) for name, text in pages(root).items()}
    wrong = []
    for name, text in sources(root):
        for page, references in CITED.findall(text):
            for reference in re.findall(REFERENCE, references):
                if reference not in known.get(f"docs/{page}.md", set()):
                    wrong.append(f"{name}: docs/{page}.md {reference}")
    return wrong


def unknown_cases(root: Path) -> list[str]:
    """Cases that the code names and docs/physics.md does not list."""
    known = anchors(pages(root)["docs/physics.md"])
    return [
        f"{n}: {case}" for n, text in sources(root) for case in re.findall(rf"\b{CASE}\b", text) if case not in known
    ]


def missing_documents(root: Path) -> list[str]:
    """Named documents that do not exist: in code from the root, in a document from the root or beside it."""
    wrong = [
        f"{name}: {page}"
        for name, text in sources(root)
        for page in NAMED.findall(LITERAL.sub("", text))
        if page not in WRITTEN and not (root / page).exists()
    ]
    for name, text in pages(root).items():
        prose, beside = FENCED.sub("", text), (root / name).parent
        for page in {*NAMED.findall(prose), *LINKED.findall(prose)}:
            if not (beside / page).exists() and not (root / page).exists():
                wrong.append(f"{name}: {page}")
    return wrong


def cases_of_validate(root: Path) -> set[str]:
    """Cases that code outside the tests gives a number for: those in string literals of their own."""
    names = [
        n for name, text in sources(root) if name.startswith("hazard_ms") for n in re.findall(r'"([^"\n]*)"', text)
    ]
    return {case for name in names if re.fullmatch(rf"{CASE}(?:, {CASE})*", name) for case in name.split(", ")}


def test_every_cited_section_and_mark_exists() -> None:
    assert wrong_citations(ROOT) == []


def test_every_case_that_is_named_stands_in_the_physics() -> None:
    assert unknown_cases(ROOT) == []


def test_every_document_that_is_named_exists() -> None:
    assert missing_documents(ROOT) == []


def test_the_physics_says_which_cases_validate_covers() -> None:
    """The last column of its tables of cases."""
    rows = re.findall(rf"^\| ({CASE}) \|.*\| ([^|]*) \|$", pages(ROOT)["docs/physics.md"], re.MULTILINE)
    assert {case for case, where in rows if "validate" in where} == cases_of_validate(ROOT)
    assert {where for _, where in rows} == {"validate", "validate, tests", "tests", "not covered"}


def test_code_cites_sections_at_all() -> None:
    """Else the tests above would show nothing."""
    assert sum(len(CITED.findall(text)) for _, text in sources(ROOT)) > 80
    assert len(cases_of_validate(ROOT)) > 40


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("# docs/physics.md 1.1, 9.9", ["docs/physics.md 9.9"]),
        ('"""As docs/physics.md\n1.1 and F-1 to F-9 say."""', ["docs/physics.md F-9", "F-9"]),
        ("# docs/physics.md R1, R7", ["docs/physics.md R7"]),
        ("# docs/physics.md\n# 1.2: more", ["docs/physics.md 1.2"]),
        ("# docs/other.md 1", ["docs/other.md 1", "docs/other.md"]),
        ("# physics.md 1.1", ["physics.md"]),
        ("# see W-3", ["W-3"]),
        ("# docs/physics.md 1.1, 1 m away; 2.0 s later; F-1; validation.md", []),
        ('page = folder / "a.md"', []),
    ],
)
def test_what_is_wrong_is_found(code: str, found: list[str], tmp_path: Path) -> None:
    (tmp_path / "hazard_ms").mkdir()
    (tmp_path / "docs").mkdir()
    (tmp_path / "hazard_ms" / "thing.py").write_text(code)
    page = "# Physics\n\n## 1 Models\n\n### 1.1 Fire\n\n| F-1 | one |\n| R1 | two |\n"
    (tmp_path / "docs" / "physics.md").write_text(page)
    wrong = [*wrong_citations(tmp_path), *unknown_cases(tmp_path), *missing_documents(tmp_path)]
    assert wrong == [f"hazard_ms/thing.py: {what}" for what in found]


def test_a_dead_link_is_found(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text(
        "[a](docs/a.md#x), [b](docs/b.md), c.md, ![d](d.png), [e](https://e.org/f.md)\n"
    )
    (tmp_path / "docs" / "a.md").write_text("[home](../README.md), README.md\n\n```\ng.md\n```\n")
    assert sorted(missing_documents(tmp_path)) == ["README.md: c.md", "README.md: d.png", "README.md: docs/b.md"]
