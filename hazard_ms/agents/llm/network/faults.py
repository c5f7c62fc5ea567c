"""Errors of a model's server: which may pass, and what the server says of one that does not."""

from __future__ import annotations

import re
from typing import Any

from hazard_ms.agents.llm.endpoint import Endpoint
from hazard_ms.spec.foreign.files import printable

PASSING = (408, 409, 425, 429, 500, 502, 503, 504, 507, 520, 521, 522, 523, 524, 529)  # status of faults that may pass
LONGEST_MESSAGE = 300  # characters of a server's message that are shown [ours]
SAMPLING = "send_seed=false,temperature=none,top_p=none"
_SAMPLED = r"\b(seed|temperature|top_p)\b"
REMEDIES = (  # what was sent, the words of a server that does not take it, and what to set
    ("response_format", r"response.?format|json.?schema|json.?object|structured|grammar", "way=letter"),
    ("logprobs", r"log.?prob", "way=json or way=letter"),
    ("seed", _SAMPLED, SAMPLING),
    ("temperature", _SAMPLED, SAMPLING),
    ("max_tokens", r"max_tokens|max_completion_tokens", "limit_field=max_completion_tokens"),
    ("max_completion_tokens", r"max_completion_tokens", "limit_field=max_tokens"),
    ("reasoning_effort", r"reasoning", "extra=reasoning_effort:low, or another value"),
)
REFUSALS = (400, 404, 415, 422, 500, 501)  # status of servers that do not take something that was sent


class NoAnswerError(RuntimeError):
    """Raised where no answer came in time, or none that can be read."""


class RefusedError(RuntimeError):
    """Raised where a server will not answer however often it is asked: a wrong key, an unknown model."""

    def __init__(self, why: str, remedy: str = "", status: int = 0) -> None:
        """Say why; `remedy`: parameters of the agent with which a server of this `status` might answer, if any do."""
        super().__init__(f"{why}; set {remedy}" if remedy else why)
        self.remedy, self.status = remedy, status


class AgainError(Exception):
    """A fault that may pass; `pause`: the time for which the server asks [s]."""

    def __init__(self, why: str, pause: float | None = None) -> None:
        """Say why."""
        super().__init__(why)
        self.pause = pause


def meaning(error: Any, sent: Any, where: Endpoint) -> Exception:
    """The error of ours that an openai.APIStatusError means, for a request with the fields `sent`."""
    status = int(error.status_code)
    if 300 <= status < 400:
        return RefusedError(f"base_url must be the final address of the server, got a redirect from {where.host}")
    words = _words(error, where)
    told = (advice for field, form, advice in REMEDIES if field in sent and re.search(form, words, re.IGNORECASE))
    remedy = next(told, "") if status in REFUSALS else ""
    if status in PASSING and error.code != "insufficient_quota" and not remedy:
        pause = _seconds(error.response.headers.get("retry-after"))
        return AgainError(f"status {status}{words and ': '}{words}", pause)
    return RefusedError(f"{where.host} refused with status {status}: {words}", remedy, status)


def _words(error: Any, where: Endpoint) -> str:
    """What a server says of an error, on one line, without the key."""
    told = error.body
    for _ in range(3):  # {"error": {"message": words}}, {"message": words}, {"detail": words}
        if isinstance(told, dict):
            told = next((told[name] for name in ("message", "detail", "error") if name in told), "")
    shown = told if isinstance(told, str) and told else error.response.text
    return printable(" ".join(where.hide(shown).split()))[:LONGEST_MESSAGE]


def _seconds(header: str | None) -> float | None:
    """The time in a Retry-After header [s]; None where there is none, or a date."""
    try:
        seconds = float(header or "")
    except ValueError:
        return None
    return seconds if 0.0 <= seconds < float("inf") else None
