"""Commands under faults: nothing half-written is taken for whole, and every failure names its path and a remedy."""

from __future__ import annotations

from pathlib import Path

import cv2
import imageio_ffmpeg
import numpy as np
import pytest
import trimesh

from hazard_ms.cli.__main__ import main
from tests.faults import matrix
from tests.faults.commands import COMMANDS, half_written
from tests.faults.starting import can_mount

MAKE = next(c for c in COMMANDS if c.name == "scenes make")
NEEDS_MOUNT = ("full_disk", "read_only")


def whole_files(folder: Path) -> None:
    """One whole file of each kind that commands write."""
    picture = np.random.default_rng(0).integers(0, 255, (64, 64, 3), dtype=np.uint8)
    for suffix in ("png", "jpg"):
        cv2.imwrite(str(folder / f"a.{suffix}"), picture)
    film = imageio_ffmpeg.write_frames(str(folder / "a.mp4"), (64, 64), ffmpeg_log_level="error")
    film.send(None)
    for _ in range(8):
        film.send(picture)
    film.close()
    (folder / "a.html").write_text("<html><body></body></html>\n")
    (folder / "a.glb").write_bytes(trimesh.creation.box().export(file_type="glb"))
    (folder / "out-scenes").mkdir()
    assert main(["scenes", "make", "kitchen_a/00", "-o", str(folder / "out-scenes" / "scene.json")]) == 0


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    whole_files(folder)
    return folder


def test_whole_files_are_taken_for_whole(kinds: Path) -> None:
    assert list(half_written(kinds)) == []


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.mp4", "a.html", "a.glb", "out-scenes/scene.json"])
@pytest.mark.parametrize("share", [0.0, 0.5, 0.95])
def test_a_file_that_was_cut_off_is_noticed(kinds: Path, tmp_path: Path, name: str, share: float) -> None:
    data = (kinds / name).read_bytes()
    cut = tmp_path / name
    cut.parent.mkdir(exist_ok=True)
    cut.write_bytes(data[: int(share * len(data))])
    assert len(list(half_written(tmp_path))) == 1


def test_a_page_of_another_episode_is_noticed(kinds: Path, tmp_path: Path) -> None:
    (tmp_path / "film.json").write_text('{"seed": 1}')
    (tmp_path / "film.html").write_text("<html>hazard-ms play -s 1</html>")
    assert len(list(half_written(tmp_path))) == 1, "there is no film"
    (tmp_path / "film.mp4").write_bytes((kinds / "a.mp4").read_bytes())
    assert list(half_written(tmp_path)) == []
    (tmp_path / "film.json").write_text('{"seed": 12}')
    assert len(list(half_written(tmp_path))) == 1


@pytest.mark.parametrize("fault", [f for f in matrix.FAULTS if f is not matrix.kill], ids=lambda f: f.__name__)
def test_a_scene_is_written_whole_or_not_at_all(fault: matrix.Fault) -> None:
    if fault.__name__ in NEEDS_MOUNT and not can_mount():
        pytest.skip("may not mount")
    assert fault(MAKE) in matrix.WELL


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("fault", matrix.FAULTS, ids=lambda f: f.__name__)
@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: c.name)
def test_every_fault_against_every_command(command: matrix.Command, fault: matrix.Fault) -> None:
    if fault.__name__ in NEEDS_MOUNT and not can_mount():
        pytest.skip("may not mount")
    assert fault(command) in matrix.WELL
