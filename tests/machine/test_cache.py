"""The cache folder: what is in it is whole, and a read-only one costs only time."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from hazard_ms.machine import cache

FILES = {"pack/a.glsl": "one", "common/b.glsl": "two"}


def texts(folder: Path) -> dict[str, str]:
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def test_the_folder_is_where_the_variables_say(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cache.home() == home and not home.exists()
    monkeypatch.delenv("HAZARD_MS_HOME")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.home() == tmp_path / "xdg/hazard_ms"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path / "me"))
    assert cache.home() == tmp_path / "me/.cache/hazard_ms"


def test_equal_files_share_a_folder_and_others_get_another(home: Path) -> None:
    folder = cache.kept_folder("shaders", FILES)
    assert texts(folder) == FILES and folder.parent == home / "shaders"
    (folder / "pack/a.glsl").touch()
    assert cache.kept_folder("shaders", dict(reversed(FILES.items()))) == folder
    assert cache.kept_folder("shaders", {**FILES, "pack/a.glsl": "three"}) != folder
    assert len(list((home / "shaders").iterdir())) == 2, "no drafts are left"
    assert os.stat(folder).st_mode & 0o755 == 0o755, "other users may read it"


def test_many_processes_at_once_leave_one_whole_folder(home: Path) -> None:
    code = (
        "from hazard_ms.machine.cache import kept_folder\n"
        "print(kept_folder('shaders', {f'{k}.glsl': 'text' * 1000 for k in range(50)}))"
    )
    children = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) for _ in range(6)]
    places = {child.communicate(timeout=60)[0].strip() for child in children}
    assert len(places) == 1 and len(list((home / "shaders").iterdir())) == 1
    assert len(texts(Path(places.pop()))) == 50


def test_without_a_writable_folder_files_are_temporary(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home.write_text("a file where the folder should be")
    folder = cache.kept_folder("robots", FILES)
    assert texts(folder) == FILES and str(folder).startswith(tempfile.gettempdir())


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    place = tmp_path / "answer.json"
    place.write_text("old")
    with place.open() as reader:
        cache.write_whole(place, "new")
        assert reader.read() == "old", "who reads it still has the old file"
    assert place.read_text() == "new" and list(tmp_path.iterdir()) == [place]
