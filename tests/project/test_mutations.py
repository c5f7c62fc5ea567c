"""The list of mutations fits the code of today, and its runner tells what is noticed from what is not."""

from __future__ import annotations

import ast
import subprocess
import time
from pathlib import Path

import pytest

from tests.mutations import __main__ as runner
from tests.mutations import reading
from tests.mutations.choosing import stages
from tests.mutations.reading import Mutation, listed
from tests.project.imports import ROOT, room, rooms

LATER = {"hazards", "sketch"}  # rooms whose mutations are not listed yet
FEWEST = 80
ENTRY = "= sign\nfile: hazard_ms/sum.py\ntests: tests/test_sum.py\nbreaks: Sums are differences.\n- a + b\n+ a - b\n"


@pytest.mark.parametrize("mutation", listed().values(), ids=str)
def test_each_fits_the_code_of_today(mutation: Mutation) -> None:
    """And changes what is run, not only how it is written."""
    text = (ROOT / mutation.file).read_text()
    spoilt = mutation.apply(text)
    if mutation.file.endswith(".py"):
        assert ast.dump(ast.parse(spoilt)) != ast.dump(ast.parse(text))
    else:
        assert subprocess.run(["bash", "-n"], input=spoilt, text=True, check=False).returncode == 0
    file, _, test = mutation.tests.partition("::")
    names = {n.name for n in ast.walk(ast.parse((ROOT / file).read_text())) if isinstance(n, ast.FunctionDef)}
    assert not test or test in names
    assert mutation.breaks.endswith(".")


def test_there_are_many_in_every_room() -> None:
    mutations = listed().values()
    assert len(mutations) >= FEWEST
    held = {room(m.file.removeprefix("hazard_ms/").removesuffix(".py").replace("/", ".")) for m in mutations}
    assert set(rooms()) - held <= LATER | {"__init__", "setup.py", "examples"}


def test_no_two_make_the_same_mistake() -> None:
    mistakes = [(m.file, m.apply((ROOT / m.file).read_text())) for m in listed().values()]
    assert len(set(mistakes)) == len(mistakes)


def test_an_entry_is_read_as_it_is_written() -> None:
    mutation = reading.read("\n" + ENTRY)["sign"]
    assert (mutation.file, mutation.tests) == ("hazard_ms/sum.py", "tests/test_sum.py")
    assert mutation.apply("return a + b") == "return a - b"
    for text, found in (("return a", 0), ("a + b + a + b", 2)):
        with pytest.raises(ValueError, match=f"sign must occur once in hazard_ms/sum.py, got {found} times"):
            mutation.apply(text)


@pytest.mark.parametrize("gone", ["file: hazard_ms/sum.py\n", "breaks: Sums are differences.\n", "- a + b\n"])
def test_an_entry_without_one_of_its_parts_is_refused(gone: str) -> None:
    with pytest.raises(ValueError, match="a mutation must have its own name, file, tests, breaks, an old and a new"):
        reading.read("\n" + ENTRY.replace(gone, ""))


def test_an_entry_that_changes_nothing_or_comes_twice_is_refused() -> None:
    for bad in (ENTRY.replace("a - b", "a + b"), ENTRY + "\n" + ENTRY):
        with pytest.raises(ValueError, match="a mutation must have its own name"):
            reading.read("\n" + bad)


def test_the_expected_tests_come_first_then_the_room_then_all_that_import_the_file() -> None:
    mutation = Mutation("x", "hazard_ms/scenes/floor.py", "tests/scenes/test_scenes.py", "It breaks.", "a", "b")
    first, beside, elsewhere = stages(mutation)
    assert first == ["tests/scenes/test_scenes.py"]
    assert set(beside) == {str(p.relative_to(ROOT)) for p in (ROOT / "tests/scenes").rglob("test_*.py")} - set(first)
    assert beside[0] in ("tests/scenes/test_floor.py", "tests/scenes/test_generator_rules.py")  # they import the file
    assert elsewhere and all(not test.startswith("tests/scenes/") for test in elsewhere)


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout with two tests of a sum, of which one is long, and one that fails whatever is done."""
    place = tmp_path / "checkout"
    (place / "hazard_ms").mkdir(parents=True)
    (place / "tests").mkdir()
    (place / "hazard_ms/__init__.py").write_text("")
    (place / "hazard_ms/sum.py").write_text("def add(a, b):\n    return a + b\n")
    (place / "tests/test_sum.py").write_text(
        "import pytest\nfrom hazard_ms.sum import add\n\n"
        "@pytest.mark.parametrize('a', [2], ids=['2 - 2 FAILED?'])\ndef test_sum(a):\n    assert add(a, 2) == 4\n\n"
        "def test_long(request):\n    assert not request.config.getoption('--long') or add(2, 3) == 5\n"
    )
    (place / "tests/conftest.py").write_text(
        "def pytest_addoption(parser):\n    parser.addoption('--long', action='store_true')\n"
    )
    (place / "tests/test_ill.py").write_text("def test_ill():\n    assert False\n")
    return place


def mistake(new: str) -> Mutation:
    return Mutation(f"now {new}", "hazard_ms/sum.py", "tests/test_sum.py", "It breaks.", "a + b", new)


def test_what_no_test_notices_is_printed_and_ends_with_1(
    checkout: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """2 - 2 is not 4, but 2 * 2 is."""
    mutations = [mistake(new) for new in ("a - b", "a * b")]
    monkeypatch.setattr(runner, "ROOT", checkout)
    monkeypatch.setattr(runner, "chosen", lambda names: [m for m in mutations if m.name in names])
    monkeypatch.setattr(runner, "stages", lambda mutation: [[mutation.tests]])
    assert runner.main([m.name for m in mutations]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith(" s  noticed by tests/test_sum.py::test_sum[2 - 2 FAILED?]") and lines[1].endswith(
        "SURVIVED"
    )
    assert lines[2] == "survivor now a * b in hazard_ms/sum.py: It breaks."
    assert lines[3].startswith("2 mutations, 1 survivors, ")
    assert (checkout / "hazard_ms/sum.py").read_text().endswith("a + b\n")  # they were made in copies


def test_a_long_test_that_is_named_is_run(checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """2 * 3 is not 5."""
    monkeypatch.setattr(runner, "stages", lambda mutation: [[mutation.tests], [f"{mutation.tests}::test_long"]])
    assert runner.judge(mistake("a * b"), checkout).noticed_by == "tests/test_sum.py::test_long"


@pytest.mark.long
def test_what_cannot_be_imported_is_noticed(checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "stages", lambda mutation: [[mutation.tests]])
    mutation = Mutation(
        "x", "hazard_ms/sum.py", "tests/test_sum.py", "It breaks.", "a + b\n", "a + b\nimport nothing\n"
    )
    assert runner.judge(mutation, checkout).noticed_by == "tests/test_sum.py"


@pytest.mark.long
def test_what_fails_without_a_mistake_has_noticed_none(
    checkout: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(runner, "ROOT", checkout)
    monkeypatch.setattr(runner, "chosen", lambda names: [mistake("a - b")])
    monkeypatch.setattr(runner, "stages", lambda mutation: [["tests/test_ill.py"]])
    assert runner.main([]) == 1
    said = capsys.readouterr().out
    assert "tests/test_ill.py::test_ill fails without any mutation: what it noticed does not count" in said
    assert "survivor now a - b" in said


@pytest.mark.long
def test_tests_that_hang_are_ended_with_all_that_they_started(
    checkout: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (checkout / "tests/test_sum.py").write_text(
        "import subprocess, pathlib\n\ndef test_sum():\n"
        f"    pathlib.Path('{tmp_path}/began').touch()\n"
        f"    subprocess.run(['sh', '-c', 'sleep 25; touch {tmp_path}/survived'])\n"
    )
    monkeypatch.setattr(runner, "PATIENCE", 15.0)
    assert runner.tried(checkout, ["tests/test_sum.py"]) == (1, "tests/test_sum.py, which hung")
    assert (tmp_path / "began").exists()
    time.sleep(20)
    assert not (tmp_path / "survived").exists()


def test_a_name_that_is_not_listed_is_refused() -> None:
    with pytest.raises(ValueError, match=r"one of \d+ names such as walls-north-inside-out.*list.txt has all"):
        runner.chosen(["wals-north-inside-out"])
    assert {m.file for m in runner.chosen(["hazard_ms/spec/registry"])} == {
        "hazard_ms/spec/registry/__init__.py",
        "hazard_ms/spec/registry/announce.py",
        "hazard_ms/spec/registry/loading.py",
    }
