"""Pictures of a frame: both kinds show the same room, and the command writes them or says what is wrong."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import sapien

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.pictures.frozen_episode import FrozenEpisode
from hazard_ms.pictures.options import IDLE, RenderOptions


def without_cameras(scene: sapien.Scene) -> list[sapien.Entity]:
    return [e for e in scene.entities if e.find_component_by_type(sapien.render.RenderCameraComponent) is None]


@pytest.mark.render
def test_pictures_of_both_kinds(tmp_path: Path) -> None:
    """Ray-traced and raster pictures show the same room, fiery where it burns; the scene is left as it was."""
    options = RenderOptions(output=tmp_path / "x.png", episode=EpisodeOptions(seed=3, agent=IDLE), frame=500)
    with FrozenEpisode(options) as frozen:
        view, scene = frozen.view("third", 48, 32), frozen.env.scene.sub_scenes[0]
        count = len(without_cameras(scene))
        raster, traced = frozen.picture(view, "default", 1), frozen.picture(view, "rt-fast", 1)
        assert len(without_cameras(scene)) == count and frozen.frame == 500
    assert raster.shape == traced.shape == (32, 48, 3)
    small = [cv2.resize(p, (6, 4), interpolation=cv2.INTER_AREA).astype(float).ravel() for p in (raster, traced)]
    assert np.corrcoef(*small)[0, 1] > 0.7
    for picture in (raster, traced):
        red, _, blue = picture.astype(int).transpose(2, 0, 1)
        assert ((red > 180) & (blue < 0.7 * red)).any()


@pytest.mark.render
def test_the_command_writes_the_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "out.png"
    words = "render -s 3 --frame 5 --size 48x32 --light evening --camera head --agent random -o"
    assert main([*words.split(), str(path)]) == 0
    assert cv2.imread(str(path)).shape == (32, 48, 3)
    out = capsys.readouterr().out
    assert re.search(r"48 x 32, raster: \d+\.\d s, \d+\.\d s of processor time", out) and "frame 5: " in out
    assert [p.name for p in tmp_path.iterdir()] == ["out.png"]


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        ([], "output must be given"),
        (["-o", "x.gif"], "got 'x.gif'"),
        (["-o", "no/such/folder/x.png"], "no folder"),
        (["-o", "x.png", "--frame", "-1"], "frame must.*got -1"),
        (["-o", "x.png", "--frame", "1501"], "frame must.*got 1501"),
        (["-o", "x.png", "--size", "big"], "size must.*got 'big'"),
        (["-o", "x.png", "--size", "8"], "width must.*got 8"),
        (["-o", "x.png", "--spp", "0"], "spp must.*got 0"),
        (["-o", "x.png", "--lighting", "nigth"], "did you mean 'night'"),
        (["-o", "x.png", "-e", "HazardFlod-v1"], "did you mean 'HazardFlood-v1'"),
        (["--turntable", "x.avi"], "got 'x.avi'"),
    ],
)
def test_bad_input_is_refused(
    words: list[str], fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["render", *words]) == 2
    assert re.search(fault, capfd.readouterr().err)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("option", "word"), [("--shader", "pretty"), ("--camera", "foot")])
def test_choices_that_are_closed_are_enforced(option: str, word: str, capfd: Any) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["render", "-o", "x.png", option, word])
    assert ended.value.code == 2 and word in capfd.readouterr().err
