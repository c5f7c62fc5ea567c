"""All that was asked and answered in an episode, one line of JSON for each decision that a model was asked for."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from hazard_ms.agents.llm.answers import Reply
from hazard_ms.agents.llm.choices import Choice
from hazard_ms.agents.llm.prompt import Message
from hazard_ms.agents.llm.scene_text import Block
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision

OTHER_SIGNS = re.compile(r"[^\w-]+")  # that names of files do without
PICTURE = "[picture]"  # what stands for one in a trace


class Trace:
    """Writes the trace of one episode into a file of its own."""

    def __init__(self, folder: Path, player: str, brief: Brief, hide: Callable[[Any], Any]) -> None:
        """Begin the file of the episode of `brief`, played by `player`; `hide` takes out what nobody may read.

        Raises ValueError where it cannot be written.
        """
        self._hide = hide
        self.path = folder / f"{brief.task}-{OTHER_SIGNS.sub('.', player)}-{brief.random_seed:016x}.jsonl"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.path.write_text("", encoding="utf-8")
        except OSError as error:
            raise ValueError(f"trace must be a writable folder, got {folder}: {error.strerror}") from None

    def add(
        self,
        decision: Decision,
        asked: Sequence[Message],
        told: Block,
        replies: Sequence[Reply],
        choice: Choice,
        note: str,
        fallback: bool,
    ) -> None:
        """Add a decision; it is in the file when this returns."""
        row = {
            "frame": decision.frame,
            "asked": [{**message, "content": _without_pictures(message["content"])} for message in asked],
            "options": told["options"],
            "replies": [
                {
                    "text": reply.text,
                    "thought": reply.thought,
                    "seconds": round(reply.seconds, 3),
                    "tokens": [reply.prompt_tokens, reply.answer_tokens],
                    "cached": reply.cached,
                    "refused": reply.refused,
                    "truncated": reply.truncated,
                }
                for reply in replies
            ],
            "letter": choice.letter,
            "action": str(choice.action),
            "note": note,
            "fallback": fallback,
        }
        with self.path.open("a", encoding="utf-8", errors="backslashreplace") as file:
            file.write(json.dumps(self._hide(row), ensure_ascii=False) + "\n")


def _without_pictures(content: Any) -> Any:
    """The content of a message with a word in place of each picture."""
    if isinstance(content, list):
        return "\n".join(str(part.get("text", PICTURE)) for part in content)
    return content
