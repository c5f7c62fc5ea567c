"""Models that a user has added, built once for all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from tests.worlds.files.model_collections import write_partnet, write_ycb
from tests.worlds.files.user_models import desk, flask

ADD_FLASK = "--category bottle --mass 0.5 --size 0.14 --licence CC-BY-4.0 --author Ada --source somewhere".split()
ADD_DESK = ["--category", "table", "--size", "1.2", "--licence", "own work"]


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two model files."""
    folder = tmp_path_factory.mktemp("files")
    flask().export(folder / "My Flask.glb")
    desk().export(folder / "desk.stl")
    return folder


@pytest.fixture(scope="session")
def user_folder(files: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A user's folder with a flask and a desk, added by the command."""
    folder = tmp_path_factory.mktemp("user") / "deep" / "assets"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HAZARD_MS_ASSETS", str(folder))
        assert main(["assets", "add", str(files / "My Flask.glb"), *ADD_FLASK]) == 0
        assert main(["assets", "add", str(files / "desk.stl"), *ADD_DESK]) == 0
    return folder


@pytest.fixture
def filled(user_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same folder, as the one that models are read from."""
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(user_folder))
    return user_folder


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """ManiSkill's data folder, with a little of everything.

    ManiSkill itself, in this process, keeps reading its own.
    """
    import mani_skill  # noqa: F401  # before the variable is set

    monkeypatch.setenv("MS_ASSET_DIR", str(tmp_path / "ms"))
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path / "mine"))
    for write in (write_ycb, write_partnet):
        write(tmp_path / "ms/data")
    return tmp_path / "ms/data"
