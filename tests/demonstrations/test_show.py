"""The page of `hazard-ms demos show`: whole, out of any folder, and true to the episodes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.demonstrations.layout import FAILURES
from hazard_ms.evaluation.result import DecisionRecord
from tests.worlds.courses import course, fate
from tests.worlds.files.html_pages import Reader
from tests.worlds.recordings import RECIPE, stored

OWN = RECIPE | {"agent": "my.py:<Own>"}
VALUES = {0: 0.25, 1: 0.5, 2: 1.0}  # of the episodes by seed; the last rescue of each is in its last frame
REASON = "<4> skills were blocked"
FILM = b"12345"


def decision(frame: int, verb: str, frames: int, reason: str = "", waited: int = 0) -> DecisionRecord:
    return DecisionRecord(frame, verb, "thing", not reason, reason, frames, waited=waited)


DECISIONS = (
    decision(0, "walk_to", 300),
    decision(310, "walk_to", 90, "max_frames", waited=10),
    decision(400, "pick_up", 40),
    decision(440, "drop", 7),
    decision(447, "pick_up", 143, "blocked"),
    decision(590, "explore", 60),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A dataset of three episodes, of which the last was not kept and the first two have films."""
    for seed, value in VALUES.items():
        targets = [fate(value, 1500), *([fate(1.0 - value, None)] if value < 1.0 else [])]
        played = replace(course(OWN["agent"], seed, targets, DECISIONS), scene=f"kitchen/<{seed}>")
        reason = REASON if seed == 2 else ""
        stored(tmp_path / "a #1" / "own", seed, reason, OWN, played=played, film=b"" if reason else FILM)
    return tmp_path


def made(folder: Path, *words: str) -> tuple[str, Reader]:
    """The page of a folder's datasets, and a reader that has read it."""
    output = folder / "pages" / "page.html"
    assert main(["demos", "show", str(folder), "-o", str(output), *words]) == 0
    text, reader = output.read_text(encoding="utf-8"), Reader()
    reader.feed(text)
    return text, reader


def test_the_page_is_whole_and_tells_of_every_episode(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, reader = made(folder)
    assert str(folder / "pages" / "page.html") in capsys.readouterr().out
    assert not reader.open and "<script" not in text and "http" not in text
    for seed, value in VALUES.items():
        assert f"kitchen/<{seed}>, seed {seed}: {100 * value:.1f} % in 3 frames" in reader.text
    assert "my.py:<Own>" in reader.text and f"no: {REASON}" in reader.text and "2 of 3" in reader.text


def test_curves_end_at_the_values_of_the_episodes(folder: Path) -> None:
    text, _ = made(folder)
    chart = text.split("<h2>Value over time</h2>")[1].split("</svg>")[0]
    heights = {words: float(y) - 4.0 for y, words in re.findall(r'<text x="\S+" y="(\S+)"[^>]*>([^<]*)</text>', chart)}
    bottom, top = heights["0 %"], heights["100 %"]
    lines = re.findall(r'points="([^"]*)"[^>]*><title>([^<]*)</title>', chart)
    ends = {name: (bottom - float(points.split(",")[-1])) / (bottom - top) for points, name in lines}
    expected = {f"kitchen-{seed}-s00000{seed}: {100 * value:.1f} %": value for seed, value in VALUES.items()}
    assert ends == pytest.approx(expected | {"mean of all": sum(VALUES.values()) / 3}, abs=2e-3)
    strokes = dict(re.findall(r'stroke="(\S+)" stroke-width="1.0"><title>(\S+):', chart))
    assert len(strokes) == 2 and strokes["#ef5f54"] == "kitchen-2-s000002"  # one colour for those that were not kept


def test_frames_are_told_by_subtask_and_pick_ups_by_their_length(folder: Path) -> None:
    text, _ = made(folder)
    told = text.split("<h2>Where the frames go</h2>")[1].split("<h2>")
    frames, pick_ups = (part.split("</svg>")[0] for part in told[:2])
    assert re.findall(r">([^<]+)</text>", frames) == [
        *("walk", "390 frames", "pick up", "183 frames", "put away", "7 frames", "look around", "60 frames"),
        *("wait", "10 frames"),
    ]
    assert "unfinished: 90 frames an episode, 3 times in all" in frames and "failed: 143 frames" in frames
    rows = re.findall(r">([^<]+)</text>", pick_ups)
    assert dict(zip(rows[::2], rows[1::2], strict=True)) == {
        **{f"{low} to {low + 19} frames": "0 times" for low in range(60, 140, 20)},
        **{"40 to 59 frames": "3 times", "140 to 159 frames": "3 times"},
    }
    assert re.findall(r"<title>([^<]+)</title>", pick_ups) == ["3 done", "3 failed"]


def test_films_are_in_the_page_if_they_are_small_together(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hazard_ms.evaluation.page.LARGEST_EMBEDDED", 2 * len(FILM))
    films = [link for link in made(folder)[1].links if not link.startswith("#")]
    assert films == ["data:video/mp4;base64,MTIzNDU="] * 2
    monkeypatch.setattr("hazard_ms.evaluation.page.LARGEST_EMBEDDED", 2 * len(FILM) - 1)
    links = [link for link in made(folder)[1].links if not link.startswith("#")]
    places = [(folder / "pages" / unquote(link)).resolve() for link in links]
    assert [place.name for place in places] == ["head.mp4"] * 2 and len(set(places)) == 2
    assert all(place.read_bytes() == FILM for place in places)


def test_only_as_many_films_are_shown_as_are_asked_for(folder: Path) -> None:
    text, reader = made(folder, "--films", "1")
    assert "The first 1 of these" in reader.text and text.count("<video") == 1
    assert [link for link in reader.links if link.startswith("#")] == ["#1-kitchen-0-s000000"]
    assert 'id="1-kitchen-0-s000000"' in text and all(f"kitchen/<{seed}>" in reader.text for seed in VALUES)
    assert "<video" not in made(folder, "--films", "0")[0]


def test_failures_are_shown_with_their_dataset_and_alone(tmp_path: Path) -> None:
    stored(tmp_path / "own", 0, REASON)
    assert f"no: {REASON}" in made(tmp_path)[1].text  # though no episode was kept
    stored(tmp_path / "own", 1)
    both, alone = (made(folder)[1].text for folder in (tmp_path, tmp_path / "own" / FAILURES))
    assert "seed 1:" in both and "seed 0:" in both and "seed 1:" not in alone and "seed 0:" in alone


def test_what_cannot_be_shown_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demos", "show", str(tmp_path)]) == 2
    assert "folder must hold a dataset" in capsys.readouterr().err
    (tmp_path / "manifest.jsonl").write_text("torn")
    assert main(["demos", "show", str(tmp_path)]) == 2
    assert "folder must hold a recorded episode, got" in capsys.readouterr().err
    for words, told in ((["-o", "page.mp4"], "output must end in .html"), (["--films", "-1"], "films must be")):
        assert main(["demos", "show", str(tmp_path), *words]) == 2
        assert told in capsys.readouterr().err
