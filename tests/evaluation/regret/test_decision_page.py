"""The page of a model's decisions: it is whole, stands alone, and says what was asked, said, done and lost."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.regret.causes import PARTS, DecisionRegret, EpisodeRegret
from hazard_ms.evaluation.regret.decision_page import decision_page, read_trace
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from tests.worlds.files.html_pages import Reader

ROW: dict[str, Any] = {
    "frame": 60,
    "asked": [{"role": "system", "content": "You direct <a> robot"}, {"role": "user", "content": "the block"}],
    "options": {"A": "fetch mug_1", "B": "stop"},
    "replies": [
        {"text": "what?", "seconds": 1.0, "tokens": [700, 3], "cached": False, "refused": False, "truncated": True},
        {"text": "Answer: A", "seconds": 0.5, "tokens": [710, 4], "cached": True, "refused": False, "truncated": False},
    ],
    "letter": "A",
    "action": "walk_to mug_1",
    "note": "A: it is near",
    "fallback": True,
}
RESULT = EpisodeResult(
    "HazardFire-v1",
    "llm",
    7,
    "kitchen/07",
    {},
    700,
    1500,
    "budget",
    (Fate("mug_1", "mug", 5.0, True, False, 300), Fate("pen_1", "pen", 1.0, False, False)),
    (DecisionRecord(60, "walk_to", "mug_1", False, "no_path", 40, waited=38),),
    "hazard-ms play -s 7",
)
JUDGED = DecisionRegret(60, "walk_to", "mug_1", 0.9, 0.25, 0.0, 0.0, "format", "an answer could not be read")
REGRET = EpisodeRegret("", "llm", 7, "kitchen/07", 0.9, 0.8, dict.fromkeys(PARTS, 0.0), (JUDGED,))


def shown(*arguments: Any) -> Reader:
    reader = Reader()
    reader.feed(decision_page([ROW], "a trace", *arguments))
    assert not reader.open and not reader.links, "it needs nothing else"
    return reader


def test_the_page_says_what_happened() -> None:
    text = " ".join(shown(RESULT, REGRET).text.split())
    for told in (
        "kitchen/07",
        "ended: budget",
        "Frame 60: walk_to mug_1 in place of an answer",
        "You direct <a> robot",
        "fetch mug_1",
        "0.50 s, 710 tokens read, 4 written, recorded earlier",
        "broke off",
        "failed: no_path after 40 frames, and 38 for thinking",
        "best plan 90.0 % of the value; this choice gives away 25.0 % (format: an answer could not be read)",
        "1410",
        "1.5 s",
        "83.3 %",
    ):
        assert told in text


def test_without_a_result_it_shows_the_trace_alone() -> None:
    text = shown().text
    assert "Answer: A" in text and "Timeline" not in text and "best plan" not in text


def test_pictures_stand_with_their_decision_alone() -> None:
    views = {60: ("data:image/jpeg;base64,SGVhZA==", "data:image/jpeg;base64,TWFw"), 90: ("data:a", "data:b")}
    shown(None, None, views)
    with_pictures = decision_page([{**ROW, "frame": 30}, ROW], "a trace", views=views)
    assert with_pictures.count("<img") == 2 and "data:a" not in with_pictures
    after = with_pictures.partition("Frame 60")[2]
    assert after.index(views[60][0]) < after.index(views[60][1]) and "map of what was seen until frame 60" in after
    assert "<img" not in decision_page([ROW], "a trace", RESULT, REGRET)


def test_a_trace_is_read(tmp_path: Path) -> None:
    (tmp_path / "t.jsonl").write_text(f"{json.dumps(ROW)}\n{json.dumps(ROW)}\n")
    made = json.loads(json.dumps(read_trace(tmp_path / "t.jsonl")))
    assert made == [{**ROW, "replies": [{"thought": "", **reply} for reply in ROW["replies"]]}] * 2


@pytest.mark.parametrize("text", ["no JSON", "3", "{}", "[]", json.dumps({**ROW, "replies": [{}]}), "\0"])
def test_other_files_are_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "t.jsonl").write_text(text)
    with pytest.raises(ValueError, match="trace must be a file that llm:trace=FOLDER wrote"):
        read_trace(tmp_path / "t.jsonl")
    with pytest.raises(ValueError, match="trace must be a file"):
        read_trace(tmp_path / "missing.jsonl")
