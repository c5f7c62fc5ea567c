"""Results of strangers: what no episode has is refused in one line, by every command that reads results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import DamagedResultError, EpisodeResult
from tests.worlds.results import result_of

HUGE = 10**400
DECISION: dict[str, Any] = {"frame": 0, "verb": "explore", "target": None, "ok": True, "reason": "", "frames": 50}
FATE: dict[str, Any] = {
    "name": "book_1",
    "category": "book",
    "value": 5,
    "rescued": True,
    "damaged": False,
    "frame": 50,
}


def row(**changes: Any) -> dict[str, Any]:
    return {**result_of(EpisodeOptions(seed=1)).to_dict(), **changes}


ODD: dict[str, dict[str, Any]] = {
    "a huge frame": {"targets": [{**FATE, "frame": HUGE}]},
    "a huge value": {"targets": [{**FATE, "value": HUGE}]},
    "a value of nothing": {"targets": [{**FATE, "value": 0}]},
    "a negative value": {"targets": [{**FATE, "value": -5}]},
    "no targets": {"targets": []},
    "a rescue without a frame": {"targets": [{**FATE, "frame": None}]},
    "a truth value for a seed": {"seed": True},
    "no frames": {"max_frames": 0},
    "more frames than there are": {"frames": 1501},
    "a negative frame": {"decisions": [{**DECISION, "frame": -1}]},
    "a huge wait": {"decisions": [{**DECISION, "waited": HUGE}]},
    "a huge thought": {"decisions": [{**DECISION, "thought": HUGE}]},
    "half a character": {"agent": "\ud800"},
    "a name of a megabyte": {"scene": "x" * 1_000_000},
    "times that are text": {"phase_seconds": {"a": "b"}},
    "counts that are text": {"counters": {"tokens_in": "x"}},
    "settings of a megabyte": {"settings": {"split": ["x" * 1_000_000]}},
    "a list for an object": {"versions": []},
    "an unknown field": {"module": "evil.py"},
}


@pytest.mark.parametrize("change", ODD.values(), ids=list(ODD))
def test_a_result_that_no_episode_has_is_refused(change: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text(json.dumps(row()))
    assert EpisodeResult.read(path).seed == 1
    path.write_text(json.dumps(row(**change)))
    with pytest.raises(DamagedResultError, match=r"a\.json must hold the result of an episode: ") as refusal:
        EpisodeResult.read(path)
    assert len(str(refusal.value)) < 500


@pytest.mark.parametrize("text", ["", "\0" * 99, "[]", "3", "{}", "[" * 10_000, '{"format": NaN}', b"\xff\xfe"])
def test_a_file_without_a_result_is_refused(text: str | bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(DamagedResultError, match="must hold the result of an episode"):
        EpisodeResult.read(path)


def test_a_report_leaves_odd_results_out_and_shows_no_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "results"
    folder.mkdir()
    for number, change in enumerate(ODD.values()):
        (folder / f"odd-{number}.json").write_text(json.dumps(row(**change)))
    (folder / "codes.json").write_text(json.dumps(row(agent="\x1b]0;title\x07\x1b[2J\u202ex")))
    assert main(["report", str(folder), "-o", str(tmp_path / "page.html")]) == 0
    out, err = capsys.readouterr()
    assert out.count("left out: ") == len(ODD)
    assert "\x1b" not in out + err and "\u202e" not in out + err
    assert r"\x1b]0;title\x07\x1b[2J\u202ex" in out


@pytest.mark.parametrize("command", ["replay", "regret", "report"])
def test_commands_end_with_a_line(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.json").write_text(json.dumps(row(settings={"split": "test", "hazards": 5})))
    (tmp_path / "b.json").write_text(json.dumps(row(targets=[])))
    files = [str(tmp_path / "b.json")] if command == "replay" else [str(tmp_path / "b.json.d")]
    (tmp_path / "b.json.d").mkdir()
    assert main([command, *files]) == 2
    assert "Traceback" not in capsys.readouterr().err
    if command == "replay":
        assert main([command, str(tmp_path / "a.json")]) == 2
        assert "settings must be those of an episode" in capsys.readouterr().err
