"""The page of an episode: it is whole, stands alone, and says what happened."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.page import address, page
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from tests.worlds.files.html_pages import Reader


def test_page_is_whole_and_says_what_happened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = EpisodeResult(
        "HazardFire-v1",
        "package:<Odd>",
        7,
        "kitchen/07",
        {"physics": "paper"},
        700,
        1500,
        "stopped",
        (Fate("bag_1", "bag", 5.0, True, True, 300), Fate("pen_1", "pen", 1.0, False, False)),
        (
            DecisionRecord(0, "walk_to", "bag_1", False, "no_path", 40, "cost 1.0 < 2"),
            DecisionRecord(40, "walk_to", "bag_1", False, "max_frames", 100),
        ),
        "hazard-ms play -s 7",
    )
    video = tmp_path / "draft.mp4"
    video.write_bytes(b"12345")
    reader = Reader()
    reader.feed(page(result, address(video, "out.mp4")))
    assert not reader.open
    assert reader.links == ["data:video/mp4;base64,MTIzNDU="]
    for told in (
        "package:<Odd>",
        "41.7 %",
        "bag_1",
        "left behind",
        "no path",
        "walk_to bag_1 unfinished",
        "cost 1.0 < 2",
        "hazard-ms play -s 7",
        "kitchen/07",
    ):
        assert told in reader.text
    assert "max frames" not in reader.text  # whoever walks on gets there: nothing failed
    monkeypatch.setattr("hazard_ms.evaluation.page.LARGEST_EMBEDDED", 4)
    reader = Reader()
    reader.feed(page(result, address(video, "a film #1 100%.mp4")))
    assert reader.links == ["a%20film%20%231%20100%25.mp4"]
