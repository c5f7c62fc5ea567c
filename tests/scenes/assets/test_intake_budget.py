"""One model may need a gigabyte of memory and some time of a processor, no more, and waits for nothing."""

from __future__ import annotations

import base64
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.scenes.assets.intake import conversion, worker
from hazard_ms.scenes.assets.intake.conversion import convert
from hazard_ms.scenes.assets.intake.reading import read_model
from hazard_ms.scenes.assets.providers.base import read_json
from hazard_ms.scenes.assets.user_models import user_rows
from tests.worlds.files.model_files import glb, gltf, good
from tests.worlds.hostile import models, pictures

HANGING = 120.0  # of wall-clock time [s]


def limited(code: str) -> subprocess.CompletedProcess[str]:
    """Run code in a process that has the worker's limits."""
    start = "from hazard_ms.scenes.assets.intake import worker; worker.PROCESSOR_TIME = 2; worker.limit()\n"
    command = [sys.executable, "-c", start + code]
    return subprocess.run(command, capture_output=True, text=True, cwd=Path.cwd(), timeout=HANGING)


def test_the_worker_gets_no_more_memory_than_its_budget() -> None:
    assert worker.MEMORY < 1e9
    over = limited(f"held = bytearray({worker.MEMORY}); held[::4096] = held[::4096]")
    assert over.returncode == 1 and "MemoryError" in over.stderr
    assert limited(f"held = bytearray({worker.MEMORY} - 200_000_000)").returncode == 0


def test_the_worker_gets_no_more_processor_time_than_its_budget() -> None:
    assert limited("while True: pass").returncode == -signal.SIGXCPU


def test_waiting_costs_no_processor_time() -> None:
    """A machine that is busy with other things refuses no good model."""
    assert limited("import time; time.sleep(3.0)").returncode == 0
    assert conversion.HANGING >= 10 * worker.PROCESSOR_TIME


@pytest.mark.parametrize(
    ("ending", "word"),
    [
        ("kill -XCPU $$", "must be converted within 120 s of processor time, got no result: simplify it first"),
        ("kill -SEGV $$", "could not be converted: the worker ended with exit code -11: no message"),
        (r"printf '\033[31mred\n' >&2; exit 7", r"ended with exit code 7: \\x1b\[31mred"),
    ],
)
def test_how_the_worker_ends_is_said(ending: str, word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another program stands for the worker's Python: it really ends in these ways."""
    program = tmp_path / "python"
    program.write_text(f"#!/bin/sh\n{ending}\n")
    program.chmod(0o755)
    (tmp_path / "m.glb").write_bytes(glb(gltf()))
    monkeypatch.setattr(conversion.sys, "executable", str(program))
    with pytest.raises(ValueError, match=word):
        convert(good(tmp_path / "m.glb"), tmp_path, None)


def test_sixty_materials_of_one_large_picture_are_one_picture(tmp_path: Path) -> None:
    """Decoded for each material, they would take 4 GB."""
    _, files = models.model(8)
    many = files["m.mtl"].count(b"newmtl")
    assert many >= 60
    files["t.png"] = pictures.true_picture(4096)
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    scene = read_model(tmp_path / "m.obj")
    assert len(scene.geometry) == many
    assert {part.visual.material.image.size for part in scene.geometry.values()} == {(512, 512)}


@pytest.mark.parametrize(("times", "most"), [(6, True), (7, False)])
def test_corners_count_as_often_as_they_are_placed(times: int, most: bool, tmp_path: Path) -> None:
    """One triangle among 100,000 corners: its faces are few, and yet copies of it are not."""
    corners, words = np.zeros((100_000, 3), "<f4"), np.array([0, 1, 2], "<u4")
    corners[1:] = np.random.default_rng(1).uniform(size=(99_999, 3))
    inside = base64.b64encode(corners.tobytes() + words.tobytes()).decode()
    tree = models.solid(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        accessors=[
            {"bufferView": 0, "componentType": 5126, "count": 100_000, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
        ],
        bufferViews=[{"buffer": 0, "byteLength": 1_200_000}, {"buffer": 0, "byteOffset": 1_200_000, "byteLength": 12}],
        buffers=[{"uri": f"data:application/octet-stream;base64,{inside}", "byteLength": 1_200_012}],
        nodes=[{"mesh": 0} for _ in range(times)],
        scenes=[{"nodes": list(range(times))}],
    )
    (tmp_path / "m.glb").write_bytes(glb(tree))
    if most:
        assert read_model(tmp_path / "m.glb").geometry
        return
    with pytest.raises(ValueError, match="m.glb must have at most 600000 corners, got 700000: simplify it first"):
        read_model(tmp_path / "m.glb")


def test_pipes_and_devices_are_refused_at_once(tmp_path: Path) -> None:
    """A reader would wait for the other end of a pipe for ever, and read a device without end."""
    os.mkfifo(tmp_path / "m.glb")
    os.mkfifo(tmp_path / "index.json")
    os.mkfifo(tmp_path / "t.png")
    (tmp_path / "rows.json.gz").symlink_to("/dev/zero")
    (tmp_path / "m.obj").write_bytes(models.OBJ)
    (tmp_path / "m.mtl").write_bytes(b"newmtl a\nmap_Kd t.png\n")
    for read in (
        lambda: read_model(tmp_path / "m.glb"),
        lambda: read_model(tmp_path / "m.obj"),
        lambda: user_rows(tmp_path),
        lambda: read_json(tmp_path / "rows.json.gz"),
    ):
        with pytest.raises(ValueError, match="must be a regular file, got a folder, a pipe or a device"):
            read()
