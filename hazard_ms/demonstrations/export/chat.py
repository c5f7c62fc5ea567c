"""Decisions as chats, one line of JSON each, for tuning language models, as TRL's SFTTrainer reads them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hazard_ms.demonstrations.export.source import Source
from hazard_ms.demonstrations.reading import Demonstration

NAME = "chat.jsonl"


def write(source: Source, folder: Path) -> str:
    """Write `chat.jsonl` into `folder`. Returns its name."""
    with (folder / NAME).open("w", encoding="utf-8") as file:
        for one in source:
            for row in chats(one, source.privileged):
                file.write(json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n")
    return NAME


def chats(one: Demonstration, privileged: bool) -> Iterator[dict[str, Any]]:
    """The decisions of an episode at which a new option was chosen; those that go on with one are left out."""
    made, truth = one.decisions, one.privileged() if privileged else {}
    for number, prompt in enumerate(one.meta["prompts"]):
        chosen = int(made["option"][number])
        letters = {letter: option for letter, option in prompt["options"].items() if option == chosen}
        if not made["option_start"][number] or not letters:
            continue
        letter = next(iter(letters))
        row: dict[str, Any] = {
            "messages": [{"role": "user", "content": prompt["text"]}, {"role": "assistant", "content": letter}],
            "completion": letter,
            "letters": list(prompt["options"]),
            "options": list(prompt["options"].values()),  # the number of each letter's option
            "env_id": one.result.env_id,
            "scene": one.result.scene,
            "seed": one.result.seed,
            "frame": int(made["frame"][number]),
            "teacher": one.meta["teacher"],
        }
        if privileged:
            worth = truth["option_value"][number]
            row["values"] = [_known(worth[option]) for option in row["options"]]
        yield row


def _known(value: float) -> float | None:
    """The value of an option, None where it is not known: JSON has no NaN."""
    return None if math.isnan(value) else float(value)
