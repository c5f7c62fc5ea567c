"""Nothing outside of the folders of results is served, and nothing hidden."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.cli.web.files import address, inside


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "results"
    (made / "deep").mkdir(parents=True)
    for name in ("a.json", "deep/b.html", ".serve.key", ".hidden.json", "c.py"):
        (made / name).write_text("x")
    (tmp_path / "secret.json").write_text("x")
    (made / "link.json").symlink_to(tmp_path / "secret.json")
    return made


def test_files_of_the_folder_are_found(folder: Path) -> None:
    assert inside([folder], 0, "a.json") == folder / "a.json"
    assert inside([folder], 0, "deep/b.html") == folder / "deep/b.html"
    assert address([folder], folder / "deep/b.html") == "/files/0/deep/b.html"


@pytest.mark.parametrize(
    "path",
    ["../secret.json", "deep/../../secret.json", ".serve.key", ".hidden.json", "c.py", "link.json", "", "a\0.json"],
)
def test_nothing_else_is(folder: Path, path: str) -> None:
    assert inside([folder], 0, path) is None
    assert inside([folder], 1, "a.json") is None


def test_names_that_no_file_can_have_are_not_found(folder: Path) -> None:
    (folder / "circle.json").symlink_to(folder / "circle.json")
    for path in ("a" * 300 + ".json", "circle.json", "circle.json/a.json"):
        assert inside([folder], 0, path) is None


def test_a_file_elsewhere_has_no_address(folder: Path) -> None:
    with pytest.raises(ValueError, match="path must be in one of the folders"):
        address([folder], folder.parent / "secret.json")
