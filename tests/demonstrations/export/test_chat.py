"""Exports for language models: one chat for each choice of an option."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.demonstrations.export import chat
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import dataset, prompts_of


@pytest.mark.parametrize("privileged", [False, True])
def test_a_chat_for_each_choice(tmp_path: Path, privileged: bool) -> None:
    """The second of the three decisions goes on with the option of the first: it is no choice."""
    chat.write(Source(dataset(tmp_path / "recorded"), privileged=privileged), tmp_path)
    rows = [json.loads(line) for line in (tmp_path / "chat.jsonl").read_text().splitlines()]
    assert [(row["seed"], row["frame"], row["completion"]) for row in rows] == [
        (10, 0, "A"),
        (10, 4, "B"),
        (11, 0, "A"),
        (11, 4, "B"),
    ]
    for row, number in zip(rows, [0, 2, 0, 2], strict=True):
        assert row["messages"] == [
            {"role": "user", "content": prompts_of()[number]["text"]},
            {"role": "assistant", "content": row["completion"]},
        ]
        assert (row["letters"], row["options"]) == (["A", "B"], [1, 3])
        assert row.get("values") == ([0.5, None] if privileged else None)
