"""docs/size.md holds the sizes of today, and says of every room what it is worth."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.project.sizes import Size, room_sizes, size_of, totals
from tests.worlds.files.checkout import ROOT

PAGE = (ROOT / "docs/size.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| `?([\w/: ,]+?)/?`? \|((?: [\d,]* \|)+)(.*)$", re.M)
OFF = 0.1  # share by which a number may differ
FEW = 3  # or this much, where numbers are small
SHORTEST = 60  # characters of a reason


def rows(text: str) -> dict[str, tuple[list[int], str]]:
    """The rows of all tables: name -> numbers, and what is told in the last column."""
    found = {}
    for name, numbers, rest in ROW.findall(text):
        values = [int(cell.replace(",", "")) for cell in numbers.split("|") if cell.strip()]
        found[name] = values, rest.strip(" |")
    return found


def off(told: list[int], true: Size | tuple[int, ...]) -> list[tuple[int, int]]:
    """Numbers that are told wrongly, with the true ones."""
    pairs = zip(told, true, strict=True)
    return [(one, other) for one, other in pairs if abs(one - other) > max(FEW, OFF * other)]


def test_every_room_has_its_size_and_a_reason() -> None:
    sizes, told = room_sizes(), rows(PAGE)
    assert {name: off(told[name][0], size) for name, size in sizes.items() if off(told[name][0], size)} == {}
    assert [name for name in sizes if len(told[name][1]) < SHORTEST and name != "top"] == []
    assert off(told["all"][0], tuple(map(sum, zip(*sizes.values(), strict=True)))) == []


def test_other_parts_have_theirs() -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("this is not a checkout")
    told, sizes = rows(PAGE), totals()
    for name, row in (("tests", "tests"), ("results", "results"), ("examples", "examples")):
        assert off(told[row][0], sizes[name]) == []
    pages = next(numbers for name, (numbers, _) in told.items() if name.startswith("pages"))
    assert off(pages, sizes["pages"]) == []


def test_lines_are_told_apart(tmp_path: Path) -> None:
    file = tmp_path / "some.py"
    file.write_text('"""A\n\nb."""\n\n# c\nd = 1  # e\n\n\ndef f():\n    """G."""\n    return """h\n\n# i"""\n')
    assert size_of([file]) == Size(files=1, lines=13, code=4, words=5)


def test_wrong_numbers_are_noticed() -> None:
    found = rows("| room | files |\n|---|---|\n| `a/` | 12 | 1,300 | why |\n| all | 5 | 6 | |\n")
    assert found == {"a": ([12, 1300], "why"), "all": ([5, 6], "")}
    assert off([12, 1300], (12, 1190)) == [] and off([12, 1300], (12, 1100)) == [(1300, 1100)]
    assert off([12], (16,)) == [(12, 16)]
