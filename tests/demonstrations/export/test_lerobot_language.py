"""Sentences as LeRobot reads them from 0.6 on: at every row that of the skill which is running holds."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="pyarrow is not installed; the extra demos brings it")

import pyarrow.parquet as pq

from hazard_ms.demonstrations.export.export import export
from hazard_ms.demonstrations.export.lerobot_language import MOST_SENTENCES, sentences
from hazard_ms.demonstrations.export.options import ExportOptions
from tests.worlds.recorded import dataset, frames_of, subtasks_of

LENGTHS = (5, 8)
# LeRobot 0.6.1, datasets/language.py: PERSISTENT_ROW_FIELDS, and of a style that needs no camera
FIELDS = {"role", "content", "style", "timestamp", "camera", "tool_calls"}


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output = tmp_path_factory.mktemp("export") / "set"
    recorded = dataset(tmp_path_factory.mktemp("recorded"), LENGTHS)
    assert export(ExportOptions(recorded, "lerobot", output, language=True)) == 0
    return output


def test_the_sentence_that_holds_is_that_of_the_skill_that_runs(exported: Path) -> None:
    rows = pq.read_table(exported / "data").to_pylist()
    assert len(rows) == sum(LENGTHS)
    for row in rows:
        episode, frame, told = row["episode_index"], row["frame_index"], row["language_persistent"]
        assert all(set(each) == FIELDS for each in told)
        assert {(each["role"], each["style"], each["camera"]) for each in told} == {("assistant", "subtask", None)}
        now = max((each for each in told if each["timestamp"] <= row["timestamp"]), key=lambda each: each["timestamp"])
        running = frames_of(episode, LENGTHS[episode], False)["subtask"][frame]
        assert now["content"] == subtasks_of(episode)[running]
        assert len(told) == 3  # one for each skill, not one for each frame


def test_the_column_takes_the_place_of_the_numbers_of_skills(exported: Path) -> None:
    info = json.loads((exported / "meta/info.json").read_text())
    assert info["features"]["language_persistent"] == {"dtype": "language", "shape": [1], "names": None}
    assert "subtask_index" not in info["features"] and not (exported / "meta/subtasks.parquet").exists()
    assert "language_persistent" not in json.loads((exported / "meta/stats.json").read_text())


def test_other_formats_refuse_it(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="format must be lerobot for --language, got tar"):
        export(ExportOptions(dataset(tmp_path / "recorded"), "tar", tmp_path / "out", language=True))


def test_an_episode_without_end_is_refused() -> None:
    running = np.arange(MOST_SENTENCES + 1) % 2
    with pytest.raises(ValueError, match="at most 10000 skills, got 10001"):
        sentences(running, np.zeros(len(running), np.float32), ("one", "other"))
