"""Films: whole ones only, read back with a decoder that is not the encoder's own."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from hazard_ms.evaluation.video import Video
from hazard_ms.pictures.files import film, save
from hazard_ms.pictures.film import Film
from hazard_ms.skills.decision import WALK_TO, Action, Result
from hazard_ms.spec.storage.files import drafts

SIZE = (160, 90)
LIMIT = 20_000  # of a file that a child may write [bytes]; its film has more
NOISY = """
import sys
from pathlib import Path
import numpy as np
from hazard_ms.spec.storage.files import drafts
from hazard_ms.evaluation.video import Video
try:
    with drafts(Path(sys.argv[1])) as (draft,), Video(draft, (160, 90), 24.0) as video:
        for k in range(60):
            video.add(np.random.default_rng(k).integers(0, 256, (90, 160, 3), dtype=np.uint8))
except ValueError as error:
    sys.exit(f"refused: {error}")
"""


def shade(value: int) -> np.ndarray:
    return np.full((SIZE[1], SIZE[0], 3), value, np.uint8)


def program(folder: Path, lines: str) -> str:
    """A program that stands in for ffmpeg."""
    path = folder / "encoder"
    path.write_text(f"#!/bin/sh\n{lines}\n")
    path.chmod(0o755)
    return str(path)


def test_a_written_film_plays(tmp_path: Path) -> None:
    """As many frames as were written, in their order, H.264, with the index before the data."""
    path = tmp_path / "out.mp4"
    shades = [20, 90, 160, 230]
    with drafts(path) as (draft,), Video(draft, SIZE, 30.0) as video:
        for value in shades:
            video.add(shade(value))
    data = path.read_bytes()
    assert data[4:8] == b"ftyp" and 0 < data.find(b"moov") < data.find(b"mdat") and b"avc1" in data
    reader = cv2.VideoCapture(str(path))
    assert reader.get(cv2.CAP_PROP_FPS) == pytest.approx(30.0)
    means = []
    while (frame := reader.read())[0]:
        assert frame[1].shape == (SIZE[1], SIZE[0], 3)
        means.append(float(frame[1].mean()))
    assert means == pytest.approx(shades, abs=4)
    assert list(tmp_path.iterdir()) == [path]


def test_frames_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    with drafts(tmp_path / "out.mp4") as (draft,):
        with pytest.raises(ValueError, match="positive"):
            Video(draft, SIZE, 0.0)
        with pytest.raises(ValueError, match="even, got 161 x 90"):
            Video(draft, (161, 90), 24.0)
        with Video(draft, SIZE, 30.0) as video:
            with pytest.raises(ValueError, match="float64"):
                video.add(np.zeros((SIZE[1], SIZE[0], 3)))
            with pytest.raises(ValueError, match="uint8"):
                video.add(np.zeros((10, 10, 3), np.uint8))
            video.add(shade(0))


def test_odd_edges_of_pictures_lose_a_pixel(tmp_path: Path) -> None:
    film(tmp_path / "out.mp4", [np.zeros((91, 161, 3), np.uint8)] * 2, (161, 91), 24.0)
    assert cv2.VideoCapture(str(tmp_path / "out.mp4")).read()[1].shape == (90, 160, 3)


@pytest.mark.parametrize(
    ("encoder", "told"),
    [
        ("exit 1", "exit code 1"),
        ("cat > /dev/null; exit 3", "exit code 3"),
        ("cat > /dev/null; exit 0", "exit code 0 and 0 readable pictures of 40"),
        ("kill -9 $$", "exit code -9"),
    ],
)
def test_an_encoder_that_fails_leaves_the_older_film(
    encoder: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out.mp4"
    path.write_bytes(b"older")
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", program(tmp_path / "bin", encoder))
    with pytest.raises(ValueError, match=told) as refused:
        film(path, [shade(0)] * 40, SIZE, 24.0)
    assert str(path) in str(refused.value) and "IMAGEIO_FFMPEG_EXE" in str(refused.value)
    assert path.read_bytes() == b"older" and sorted(p.name for p in tmp_path.iterdir()) == ["bin", "out.mp4"]


def test_an_encoder_that_writes_too_few_pictures_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It ends with 0, and its file is a film: one of another length."""
    film(tmp_path / "short.mp4", [shade(0)] * 3, SIZE, 24.0)
    (tmp_path / "bin").mkdir()
    copy = f'cat > /dev/null; for last; do :; done; cp "{tmp_path}/short.mp4" "$last"'
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", program(tmp_path / "bin", copy))
    with pytest.raises(ValueError, match="3 readable pictures of 4"):
        film(tmp_path / "out.mp4", [shade(0)] * 4, SIZE, 24.0)
    assert not (tmp_path / "out.mp4").exists()


def test_a_program_that_does_not_start_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "nothing"))
    with pytest.raises(ValueError, match="nothing: No such file or directory; IMAGEIO_FFMPEG_EXE names it"):
        film(tmp_path / "out.mp4", [shade(0)], SIZE, 24.0)


def test_a_film_that_the_disk_cannot_hold_is_no_film(tmp_path: Path) -> None:
    """The encoder meets the end of what may be written in the midst of its work."""
    path = tmp_path / "out.mp4"
    path.write_bytes(b"older")
    made = subprocess.run(
        [sys.executable, "-c", NOISY, str(path)],
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT)),
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    assert made.returncode == 1 and "refused: ffmpeg could not write" in made.stderr and str(path) in made.stderr
    assert path.read_bytes() == b"older" and list(tmp_path.iterdir()) == [path]


def test_an_error_while_filming_stops_the_encoder(tmp_path: Path) -> None:
    path = tmp_path / "out.mp4"
    with (
        pytest.raises(ZeroDivisionError),
        drafts(path) as (draft,),
        Video(draft, SIZE, 24.0) as video,
    ):
        video.add(shade(0))
        raise ZeroDivisionError
    assert video._encoder.returncode is not None and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("ending", [".png", ".jpg", ".JPEG"])
def test_a_picture_is_written_as_what_its_name_says(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{ending}"
    save(path, np.dstack([shade(200)[..., 0], shade(100)[..., 0], shade(50)[..., 0]]))
    assert path.read_bytes()[:3] == (b"\x89PN" if ending == ".png" else b"\xff\xd8\xff")
    assert cv2.imread(str(path))[0, 0].tolist() == pytest.approx([50, 100, 200], abs=3), "blue, green, red"


@pytest.mark.parametrize(("reason", "shown"), [("max_frames", ""), ("no_path", "walk to cup: no path")])
def test_a_walk_that_goes_on_is_not_shown_as_a_failure(reason: str, shown: str, tmp_path: Path) -> None:
    with drafts(tmp_path / "out.mp4") as (draft,):
        made = Film(draft, "", 4)
        made._action = Action(WALK_TO, "cup")
        made.ended(Result(False, reason, 100))
        assert made._news.shown() == shown
        Path(draft.path).write_bytes(b"film")
