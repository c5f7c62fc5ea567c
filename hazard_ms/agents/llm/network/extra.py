"""Fields of a request that only some servers know, as a user writes them."""

from __future__ import annotations

import json
from typing import Any

from hazard_ms.spec.foreign.files import printable
from hazard_ms.spec.foreign.json_hooks import HOOKS
from hazard_ms.spec.foreign.plain import parse

OURS = ("model", "messages", "stream", "n", "tools", "response_format")  # fields that the agent itself must know


def extra_of(text: str) -> dict[str, Any]:
    """The fields that `text` names: a JSON object, or name:value;name:value with values of JSON or plain words.

    Raises ValueError for other text, and for fields that are not the user's to set.
    """
    if text.startswith("{"):
        made: dict[str, Any] = parse(text, "extra")
    else:
        pairs = [part.partition(":") for part in filter(None, text.split(";"))]
        if any(not (name.strip() and colon and value.strip()) for name, colon, value in pairs):
            raise ValueError(f"extra must be name:value;name:value or a JSON object, got {printable(text)[:100]!r}")
        made = {name.strip(): _value(value.strip()) for name, _, value in pairs}
    for name in made:
        if name in OURS:
            raise ValueError(f"extra must not set {', '.join(OURS)}, which hazard_ms sets itself, got {name}")
    return made


def _value(word: str) -> Any:
    try:
        return json.loads(word, **HOOKS)
    except (ValueError, RecursionError):
        if word[0] in '{["':
            raise ValueError(f"each value in extra must be JSON or a word, got {printable(word)[:100]}") from None
        return word
