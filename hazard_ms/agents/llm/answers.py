"""Four ways in which a model answers with one letter, and how each is asked for and read.

`json`: an object with a reason and a letter, to a schema that names the letters on offer. `letter`: free text that ends
with the letter. `logprob`: one token, the letter to which the model gives the greatest probability. `think`: free text
first; then, in a second call, the letter alone.

A message to other robots stands beside the letter: in the field `message`, or in a line of free text. One token holds
none, so teams do not answer by `logprob`.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import Any

from hazard_ms.agents.llm.choices import Choice, Menu
from hazard_ms.agents.llm.prompt import estimate
from hazard_ms.skills.telling import check_message
from hazard_ms.spec.registry.mitigations import TELL

JSON, LETTER, LOGPROB, THINK = "json", "letter", "logprob", "think"
WAYS = (JSON, LETTER, LOGPROB, THINK)
ASKS = {
    JSON: 'Reply with JSON only: {"reason": "at most 40 words", "choice": "the letter"}.',
    LETTER: 'End your reply with a line "Answer: X", where X is the letter.',
    LOGPROB: "Reply with the letter alone.",
    THINK: "Think about it first, in at most 120 words; you will be asked for the letter afterwards.",
}
TELLING_ASKS = {  # of a robot that may tell others something
    JSON: f'{ASKS[JSON].removesuffix("}.")}, "message": "what you tell, or empty"}}.',
    LETTER: f'{ASKS[LETTER]} If you tell something, write a line "Message: your words" before it.',
    THINK: f'{ASKS[THINK]} If you will tell something, end with a line "Message: your words".',
}
ONLY_LETTER = "Now reply with the letter alone."
CANDIDATES = 20  # tokens whose probabilities are asked for: as many as OpenAI gives at most
SHORT_REPLY = 16  # tokens of a reply that is a letter: some models put signs around it [ours]
MOST_TOKENS = 10**7  # of one call: a server that tells of more is not believed [ours]
AFTER_WORD = re.compile(r"(?i:answer)\W{0,8}(?:(?i:is|option)\W{1,4}){0,2}([A-T])\b(?!['’])")
ALONE = re.compile(r"^\W*([A-T])\W*$", re.MULTILINE)
MESSAGE = re.compile(r"^[^\w\n]*(?i:message)[^\w\n]*:[^\w\n]*(\w.*?)[\"*\s]*$", re.MULTILINE)
THOUGHT, END_OF_THOUGHT = "<think>", "</think>"  # between which many models put their reasoning
BYTE_ORDER_MARK = "\ufeff"
SPENT = "raise reply_tokens, or let it think less: extra=reasoning_effort:none"  # what to do about long thoughts
CUT = 2  # times fewer tokens read than were sent: the server has cut the prompt [ours]
OBJECT = re.compile(r"\{.*\}", re.DOTALL)
LONGEST_QUOTE = 200  # characters of an answer that errors quote [ours]


class UnreadableError(ValueError):
    """Raised for an answer that names no option."""


@dataclass(frozen=True)
class Reply:
    """The answer to one call."""

    text: str
    refused: bool  # by the model, or by a filter before it
    truncated: bool  # at the greatest number of tokens
    candidates: tuple[tuple[str, float], ...] | None  # first tokens with log-probabilities; None where none were sent
    prompt_tokens: int
    answer_tokens: int
    seconds: float  # until it was there
    cached: bool = False  # whether it was asked for earlier
    thought: str = ""  # what servers send apart from the text, in `reasoning` or `reasoning_content`
    called: bool = False  # whether a function was called, which nobody offered
    cut: bool = False  # whether the server has read less than half of the prompt


def reply_of(body: Any, seconds: float, prompt: str, cached: bool = False) -> Reply:
    """The reply in the `body` of a server's answer, which took `seconds` [s].

    Where the server tells no numbers of tokens, they are estimated, of `prompt`, too. Raises UnreadableError for a body
    that is no chat completion.
    """
    try:
        choice = body["choices"][0]
        message = choice["message"]
        finish, text, refusal = choice.get("finish_reason"), message.get("content"), message.get("refusal")
    except (LookupError, TypeError, AttributeError):
        raise UnreadableError(f"a chat completion must have choices with a message, got {body!r:.100}") from None
    text, thought = _text(text), _text(message.get("reasoning") or message.get("reasoning_content"))
    usage = body.get("usage") if isinstance(body.get("usage"), dict) else {}
    read = _count(usage.get("prompt_tokens"), prompt)
    return Reply(
        text=text,
        refused=bool(refusal) or finish == "content_filter",
        truncated=finish == "length",
        candidates=_candidates(choice),
        prompt_tokens=read,
        answer_tokens=_count(usage.get("completion_tokens"), thought + text),
        seconds=seconds,
        cached=cached,
        thought=thought,
        called=bool(message.get("tool_calls")),
        cut=0 < CUT * read < estimate(prompt),
    )


def _text(told: Any) -> str:
    """The text of a message: a text, or a list of parts of which some are; empty for anything else."""
    if isinstance(told, list):
        parts = (part.get("text") if isinstance(part, dict) else part for part in told)
        told = "".join(part for part in parts if isinstance(part, str))
    return told.lstrip(BYTE_ORDER_MARK) if isinstance(told, str) else ""


def request_of(way: str, menu: Menu, tokens: int, limit_field: str) -> dict[str, Any]:
    """The part of a request that depends on the way: the greatest length of the reply, and its form."""
    if way == LOGPROB:
        return {limit_field: 1, "logprobs": True, "top_logprobs": CANDIDATES, "temperature": 0}
    if way != JSON:
        return {limit_field: tokens}
    letters = [choice.letter for choice in menu.choices]
    fields: dict[str, Any] = {"reason": {"type": "string"}, "choice": {"type": "string", "enum": letters}}
    if menu.letter(TELL, None) is not None:
        fields["message"] = {"type": "string"}
    schema = {"type": "object", "properties": fields, "required": list(fields), "additionalProperties": False}
    form = {"type": "json_schema", "json_schema": {"name": "choice", "strict": True, "schema": schema}}
    return {limit_field: tokens, "response_format": form}


def read(way: str, reply: Reply, menu: Menu, options: dict[str, str]) -> tuple[Choice, str]:
    """The choice that a reply names, and the reason that it gives; `options` are their texts by letter.

    Raises UnreadableError for a reply that names none.
    """
    if way == LOGPROB:
        return _likeliest(reply, menu), ""
    if reply.refused:
        raise UnreadableError("the model refused to answer")
    said = _said(reply)
    if way == JSON:
        answer = _from_json(said)
        named, reason = answer["choice"], str(answer.get("reason", ""))
    else:
        named, reason = _letter(said, menu), said
    for choice in menu.choices:
        if named is not None and (named.strip() in (choice.letter, options[choice.letter])):
            return choice, reason
    letters = ", ".join(choice.letter for choice in menu.choices)
    shown = (named or reply.text)[:LONGEST_QUOTE]
    raise UnreadableError(f"the answer must name one of {letters}, got {shown!r}")


def message_of(way: str, reply: Reply) -> str:
    """The message in a `reply` that tells something. Raises UnreadableError where there is none, or none to be sent."""
    said = _said(reply)
    found = _from_json(said).get("message") if way == JSON else (MESSAGE.findall(said) or [""])[-1]
    text = found.strip() if isinstance(found, str) else ""
    try:
        check_message(text)
    except ValueError as error:
        raise UnreadableError(str(error)) from None
    return text


def _said(reply: Reply) -> str:
    """What a reply says after its thought. Raises UnreadableError where it says nothing."""
    before, ended, said = reply.text.rpartition(END_OF_THOUGHT)
    inside = said.lstrip().startswith(THOUGHT)
    if said.strip() and not inside:
        return said
    thought = reply.thought or (said if inside else before)
    if thought.strip():
        shown = f"got only a thought that ends in {thought.strip()[-LONGEST_QUOTE:]!r}"
        if reply.truncated:
            raise UnreadableError(f"the model thought until its tokens were spent: {SPENT}; {shown}")
        raise UnreadableError(f"the answer must be a text, {shown}")
    if reply.called:
        raise UnreadableError("the answer must be a text, got a call of a function that was not offered")
    raise UnreadableError("the answer was empty")


def _from_json(text: str) -> dict[str, Any]:
    """The object in a reply, which has a "choice"; there may be signs around the JSON."""
    found = OBJECT.search(text)
    try:
        answer = json.loads(found[0]) if found else None
    except (ValueError, RecursionError):
        answer = None
    if not isinstance(answer, dict) or not isinstance(answer.get("choice"), str):
        raise UnreadableError(f'the answer must be JSON with a "choice", got {text[:LONGEST_QUOTE]!r}')
    return answer


def _letter(text: str, menu: Menu) -> str | None:
    """The last letter on offer that stands after the word answer or alone on a line; else the text, if it is short."""
    offered = {choice.letter for choice in menu.choices}
    if text.strip().upper() in offered:
        return text.strip().upper()
    found = [match for form in (AFTER_WORD, ALONE) for match in form.finditer(text) if match[1] in offered]
    if found:
        return max(found, key=lambda match: match.start(1))[1]
    return text.strip() if len(text) < LONGEST_QUOTE else None


def _likeliest(reply: Reply, menu: Menu) -> Choice:
    """The choice whose letter has the greatest probability, with and without a space before it."""
    scores: dict[str, float] = {}
    for token, score in reply.candidates or ():
        letter = token.strip()
        scores[letter] = _log_sum(scores.get(letter, -math.inf), score)
    best = max(menu.choices, key=lambda choice: scores.get(choice.letter, -math.inf))
    if best.letter not in scores:
        raise UnreadableError(f"no letter on offer was among the first tokens, got {sorted(scores)!r:.100}")
    return best


def _log_sum(first: float, second: float) -> float:
    """The logarithm of the sum of two numbers given by their logarithms."""
    high, low = max(first, second), min(first, second)
    return high if low == -math.inf else high + math.log1p(math.exp(low - high))


def _candidates(choice: dict[str, Any]) -> tuple[tuple[str, float], ...] | None:
    """The first tokens that a server offers with their log-probabilities; None where it sends none."""
    try:
        tops = choice["logprobs"]["content"][0]["top_logprobs"]
        made = tuple((str(top["token"]), float(top["logprob"])) for top in tops)
    except (LookupError, TypeError, ValueError):
        return None
    return tuple(each for each in made if each[1] <= 0.0) or None  # neither NaN nor a nonsense


def _count(told: Any, text: str) -> int:
    """The number of tokens that a server told, or that of `text` where it told none that can be believed."""
    if isinstance(told, int) and not isinstance(told, bool) and 0 <= told <= MOST_TOKENS:
        return told
    return estimate(text)
