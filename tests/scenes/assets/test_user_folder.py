"""The user's folder of models: what is removed, interrupted or done twice at a time leaves it whole."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.scenes.assets import shipped, user_models
from hazard_ms.scenes.assets.index import asset_ids
from hazard_ms.scenes.assets.intake import adding
from hazard_ms.scenes.assets.intake.model import model_of_file


def test_nothing_else_lies_in_the_folder(filled: Path) -> None:
    there = {str(p.relative_to(filled)) for p in filled.rglob("*") if p.is_file()}
    models = {
        f"models/{name}/{file}" for name in ("my_flask", "desk") for file in ("model.glb", "hulls.ply", "preview.png")
    }
    assert {"index.json", ".lock"} <= there <= {"index.json", ".lock"} | models


def test_removing_takes_row_and_files(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import shutil

    mine = tmp_path / "copy"
    shutil.copytree(filled, mine)
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(mine))
    assert main(["assets", "remove", "my_flask"]) == 0
    assert not (mine / "models/my_flask").exists() and (mine / "models/desk/model.glb").is_file()
    assert set(asset_ids(users=True)) - set(asset_ids()) == {"desk"}
    assert main(["assets", "remove", "my_flask"]) == 2
    assert main(["assets", "remove", "bottle_1"]) == 2, "shipped ones stay"


def test_an_interrupted_add_leaves_nothing_behind(files: Path, tmp_path: Path) -> None:
    """Killed in the middle: no row, no half model; the next run clears the rest away."""
    env = {**os.environ, "HAZARD_MS_ASSETS": str(tmp_path)}
    words = ["assets", "add", str(files / "My Flask.glb"), "--category", "bottle", "--licence", "own work"]
    job = subprocess.Popen([sys.executable, "-m", "hazard_ms.cli", *words], env=env, start_new_session=True)
    until = time.monotonic() + 250
    while not list(tmp_path.glob(".adding-*")) and time.monotonic() < until:
        time.sleep(0.01)
    os.killpg(job.pid, signal.SIGKILL)  # the whole group: the converter too
    job.wait()
    with pytest.raises(ProcessLookupError):
        while time.monotonic() < until:
            os.killpg(job.pid, 0)
    assert (
        list(tmp_path.glob(".adding-*"))
        and not (tmp_path / "index.json").exists()
        and not (tmp_path / "models").exists()
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
        with pytest.raises(ValueError, match="a model to remove must be"):
            adding.remove("my_flask")
        assert not list(tmp_path.glob(".adding-*"))


def test_two_at_a_time_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
    with adding._locked(tmp_path), pytest.raises(ValueError, match="another hazard-ms"):
        adding.remove("x")


def test_the_package_itself_is_never_written(files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(shipped.root()))
    before = sorted(p.name for p in shipped.root().iterdir())
    model = dataclasses.replace(model_of_file(files / "desk.stl"), category="table", licence="own work")
    with pytest.raises(ValueError, match="belongs to hazard_ms itself"):
        adding.add(model, "desk", size=1.2)
    with pytest.raises(ValueError, match="belongs to hazard_ms itself"):
        adding.remove("bottle_1")
    assert sorted(p.name for p in shipped.root().iterdir()) == before


def test_the_default_folder_is_among_the_users_data(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("HAZARD_MS_ASSETS", raising=False)
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert user_models.user_root() == tmp_path / ".local/share/hazard_ms/assets"
    assert user_models.user_index() == {}


def test_an_index_is_read_again_when_it_changes(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
    assert user_models.user_index() == {}
    (tmp_path / "models").symlink_to(filled / "models")
    (tmp_path / "index.json").write_text((filled / "index.json").read_text())
    with pytest.raises(ValueError, match="leads out of"):
        user_models.user_index()
    (tmp_path / "models").unlink()
    rows = json.loads((filled / "index.json").read_text())
    (tmp_path / "index.json").write_text(json.dumps(rows[:0]))
    assert user_models.user_index() == {}
