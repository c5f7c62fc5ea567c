"""The cache folder: what is in it is whole, and a read-only one costs only time."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from hazard_ms.spec.storage import cache

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
        "from hazard_ms.spec.storage.cache import kept_folder\n"
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
    assert cache.kept_folder("robots", FILES) == folder, "one for the process, and not one for each reset"


@pytest.mark.parametrize("closed", [0o555, 0o000])
def test_a_home_that_is_closed_to_us_costs_one_folder_that_is_deleted_at_the_end(home: Path, closed: int) -> None:
    """Root may write everywhere, so the process runs without the rights that make root special."""
    if os.geteuid() == 0 and shutil.which("setpriv") is None:
        pytest.skip("no setpriv")
    bare = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"] if os.geteuid() == 0 else []
    temporary = home.parent / "temporary"
    home.mkdir()
    temporary.mkdir()
    home.chmod(closed)
    code = (
        "from pathlib import Path; import tempfile\n"
        "from hazard_ms.spec.storage.cache import kept_folder\n"
        "for _ in range(3): made = kept_folder('robots', {'a': 'text'})\n"
        "print((made / 'a').read_text(), len(list(Path(tempfile.gettempdir()).iterdir())))"
    )
    environ = {**os.environ, "TMPDIR": str(temporary)}
    command = [*bare, sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=environ, check=False)
    home.chmod(0o755)
    assert done.stdout.strip() == "text 1", done.stderr
    assert list(temporary.iterdir()) == list(home.iterdir()) == []
