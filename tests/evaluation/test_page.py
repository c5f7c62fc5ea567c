"""The page of an episode: it is whole, stands alone, and says what happened."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.page import address, page
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from tests.worlds.files.html_pages import Reader
from tests.worlds.serving import browsing, needs_browser


@needs_browser
@pytest.mark.timeout(120)
@pytest.mark.parametrize("width", [1300, 500])
def test_no_word_is_broken_beside_a_long_note(tmp_path: Path, width: int) -> None:
    """A result is one line high as long as its words are whole; a note breaks wherever it must."""
    decisions = tuple(
        DecisionRecord(100 * n, "walk_to", "bag_1", False, "max_frames", 100, note)
        for n, note in enumerate(("short", "a word and another " * 20, "x" * 600))
    )
    fates = (Fate("bag_1", "bag", 5.0, False, False),)
    result = EpisodeResult("HazardFire-v1", "greedy", 7, "kitchen/07", {}, 300, 1500, "time", fates, decisions, "play")
    (tmp_path / "page.html").write_text(page(result), encoding="utf-8")
    with browsing(width) as browser:
        browser.get((tmp_path / "page.html").as_uri())
        rows = browser.find_elements("css selector", "table:last-of-type tr")
        cells = [row.find_elements("css selector", "td") for row in rows]
        told = [cell for row in cells for cell in row if cell.text == "unfinished"]
        lines = "const r = document.createRange(); r.selectNodeContents(arguments[0]); return r.getClientRects().length"
        assert [browser.execute_script(lines, cell) for cell in told] == [1, 1, 1]
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width


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
