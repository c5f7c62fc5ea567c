"""The commands `hazard-ms perception ...`: input that is refused, in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["capture", "--per-scene", "0"], "per_scene must be"),
        (["capture", "--size", "10"], "size must be"),
        (["capture", "--lights", "disco"], "lights must be one of varied, day"),
        (["capture", "--effects", "off"], "effects must be left out, got 'off'; use --looks"),
        (["capture", "-e", "HazardQuake-v1"], "env_id must be one of"),
        (["capture", "--split", "nowhere"], "split must be one of"),
        (["check", "{}"], "must be a dataset of `hazard-ms perception capture`"),
        (["show", "{}", "-o", "page.txt"], "must be"),
        (["score", "{}", "{}/none.json"], "must be a dataset"),
        (["train", "-o", "{}"], "DATA must be at least one dataset"),
        (["train", "{}", "-o", "{}"], "must be a dataset"),
        (["calibrate", "{}"], "each of DATA must have one of the splits test"),
        (["calibrate", "{}", "--every", "0"], "every must be a whole number from 1 to 64, got 0"),
        (["calibrate", "{}", "--perception", "truth"], "perception must name a detector that lists its categories"),
        (["calibrate", "{}", "--perception", "noisy"], "perception must name a detector that lists its categories"),
        (["capture", "--fov", "200"], "fov must be from 10 to 150 degrees, got 200.0"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["perception", *(word.replace("{}", str(tmp_path)) for word in words)]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not list(tmp_path.rglob("*.part-*"))
