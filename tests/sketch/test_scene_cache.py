"""Scenes of the sketch that are kept on the disk."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms.sketch.recording import LAWS
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.scene_cache import MADE_BY, from_bytes, kept, to_bytes
from hazard_ms.sketch.scenes import scenes_of, sketch_scene
from hazard_ms.tasks import task_of
from tests.worlds.same import same_fields

# rooms that are loaded, too, and do not decide what a scene of the sketch is
ELSEWHERE = {"effects", "machine"}
LATER = {"robots"}  # rooms that matter and are loaded by name


@pytest.fixture(scope="module")
def scene() -> SketchScene:
    return scenes_of("HazardWind-v1", ["parking/03"], [3], max_frames=200)[0]


def test_a_scene_is_the_same_from_its_file(scene: SketchScene) -> None:
    same_fields(scene, from_bytes(to_bytes(scene)))


def test_a_scene_is_made_once(scene: SketchScene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path))
    calls: list[int] = []

    def made() -> SketchScene:
        calls.append(1)
        return scene

    for _ in range(2):
        same_fields(scene, kept("parking/03", "the seed 3", made))
    assert len(calls) == 1
    kept("parking/03", "the seed 4", made)
    assert len(calls) == 2, "what follows from something else is another scene"


@pytest.mark.parametrize("spoilt", [b"", b"nonsense", None])
def test_a_damaged_file_is_replaced(
    scene: SketchScene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, spoilt: bytes | None
) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path))
    kept("parking/03", "", lambda: scene)
    (path,) = (tmp_path / "sketch").iterdir()
    whole = path.read_bytes()
    path.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]) if spoilt is None else spoilt)
    same_fields(scene, kept("parking/03", "", lambda: scene))
    assert path.read_bytes() == whole


def test_a_cache_that_cannot_be_written_to_only_costs_time(
    scene: SketchScene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "file"))
    same_fields(scene, kept("parking/03", "", lambda: scene))


def test_tasks_that_differ_in_their_safe_place_alone_have_scenes_of_their_own() -> None:
    """As tasks of third parties can, in whose name nothing tells it."""
    task = task_of("HazardFire-v1", "paper")
    other = dataclasses.replace(task, safe_place=dataclasses.replace(task.safe_place, containers=("table",)))
    spec = task.build("kitchen_b/00")
    tables = sum(thing.category == "table" for thing in spec.things)
    carts = [len(sketch_scene(each, "paper", spec, 0).cart_site) for each in (task, other)]
    assert tables and carts == [0, tables]


def test_all_code_that_makes_a_scene_is_in_its_name() -> None:
    """Every room that is loaded with the sketch's scenes is either in the digest or known not to matter."""
    words = "import sys, hazard_ms.sketch.scenes; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True).stdout
    rooms = {name.split(".")[1] for name in out.split() if name.startswith("hazard_ms.")}
    assert rooms | LATER == {*MADE_BY, *(name.split("/")[0] for name in LAWS), *ELSEWHERE}
