"""The file that the watchdog writes when a simulation breaks, and what happens where it cannot be written."""

from __future__ import annotations

import json
import logging
import os
import shutil
import stat
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode.episode import Episode
from tests.worlds.fire_worlds import room_world

QPOS = torch.zeros(1, 15)


def broken(scene: str = "room/00") -> tuple[World, Episode]:
    """An episode whose book has just left the world."""
    world = room_world([("book", (10.0, 10.0, 0.0))], (), [])
    world.specs = (replace(world.specs[0], name=scene),)
    episode = Episode(world, ())
    episode.begin(torch.arange(1), torch.arange(1) + 7)
    world.position[0, 0, 2] = 1e6
    return world, episode


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary folder of the system that every user may write to."""
    folder = tmp_path / "shared"
    folder.mkdir()
    folder.chmod(0o1777)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    monkeypatch.delenv("HAZARD_MS_DUMPS", raising=False)
    return folder


def files(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file()]


def test_only_we_can_read_it_and_nobody_can_foresee_its_name(temporary: Path, caplog: pytest.LogCaptureFixture) -> None:
    for _ in range(2):
        broken()[1].watch(QPOS)
    first, second = files(temporary)
    assert first.name != second.name and first.parent != second.parent
    for path in (first, second):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600 and stat.S_IMODE(path.parent.stat().st_mode) == 0o700
        assert json.loads(path.read_text())["seed"] == 7
        assert str(path) in caplog.text


def test_links_that_lie_in_wait_are_not_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    victim, folder = tmp_path / "victim", tmp_path / "dumps"
    victim.write_text("mine")
    folder.mkdir()
    for name in ("room_00_7", "room_00_7_"):
        (folder / f"hazard_ms_sim_error_{name}.json").symlink_to(victim)
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(folder))
    broken()[1].watch(QPOS)
    assert victim.read_text() == "mine" and len([p for p in files(folder) if not p.is_symlink()]) == 1


@pytest.mark.parametrize("scene", ["a/" * 300, "../../up", "nul\0", "é" * 200, ""])
def test_any_name_of_a_scene_gives_a_file_in_the_folder(
    scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path / "new" / "dumps"))
    broken(scene)[1].watch(QPOS)
    (dump,) = (tmp_path / "new" / "dumps").iterdir()
    assert json.loads(dump.read_text())["scene"] == scene


def test_a_folder_that_is_a_file_is_a_warning_and_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "dumps").write_text("a file")
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path / "dumps"))
    _, episode = broken()
    episode.watch(QPOS)
    assert episode.sim_error.tolist() == [True]
    assert "not written: File exists; set HAZARD_MS_DUMPS to a folder" in caplog.text
    assert caplog.records[-1].levelno == logging.WARNING


def test_a_full_disk_is_a_warning_and_leaves_no_part_of_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A real, small disk where it can be mounted."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = shutil.which("mount")
    command = [mount or "mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", str(disk)]
    if os.geteuid() != 0 or mount is None or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("no disk can be mounted")
    try:
        monkeypatch.setenv("HAZARD_MS_DUMPS", str(disk))
        world, episode = broken()
        for _ in range(300):
            episode.recorder.keep(world)
        world.specs = (replace(world.specs[0], name="long" * 5000),)
        episode.watch(QPOS)
        assert episode.sim_error.tolist() == [True] and "No space left on device" in caplog.text
        assert files(disk) == []
    finally:
        subprocess.run(["umount", str(disk)], check=True)
