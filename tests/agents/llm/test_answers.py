"""Answers of models, read by hand-made examples."""

from __future__ import annotations

import math
from typing import Any

import pytest

from hazard_ms.agents.llm.answers import Reply, UnreadableError, read, reply_of, request_of
from hazard_ms.agents.llm.choices import Choice, Menu
from hazard_ms.agents.llm.prompt import estimate
from hazard_ms.skills.decision import Action

MENU = Menu(tuple(Choice(letter, "fetch", f"mug_{letter}", Action("explore")) for letter in "ABCD"), ())
OPTIONS = {choice.letter: f"fetch {choice.thing}" for choice in MENU.choices}


def answered(text: str, **changes: Any) -> Reply:
    return Reply(**{"text": text, "refused": False, "truncated": False, "candidates": None, **changes}, **COSTS)  # type: ignore[arg-type]


COSTS = {"prompt_tokens": 0, "answer_tokens": 0, "seconds": 0.0}


@pytest.mark.parametrize(
    ("text", "letter"),
    [
        ("Answer: B", "B"),
        ("answer: **C**", "C"),
        ("I considered A.\nThe answer is D.", "D"),
        ("Answer: option B", "B"),
        ("A is near.\n\nB\n", "B"),
        ("(C)", "C"),
        ("b", "B"),
        ("Answer: A\nNo, wait.\nAnswer: B", "B"),
        ("Answer: Z is not there, so\nAnswer: A", "A"),
        ("fetch mug_C", "C"),
        ("B.\nA longer text follows", "B"),
        ("<think>Answer: A\nor not</think>\nC", "C"),
    ],
)
def test_the_last_letter_that_stands_alone_counts(text: str, letter: str) -> None:
    assert read("letter", answered(text), MENU, OPTIONS)[0].letter == letter
    assert read("think", answered(text), MENU, OPTIONS)[0].letter == letter


@pytest.mark.parametrize(
    "text", ["", "  ", "Answer: Z", "A mug would be nice", "The answer depends", "fetch mug", "AB"]
)
def test_texts_that_name_nothing_are_unreadable(text: str) -> None:
    with pytest.raises(UnreadableError):
        read("letter", answered(text), MENU, OPTIONS)


@pytest.mark.parametrize(
    ("text", "letter", "reason"),
    [
        ('{"reason": "near", "choice": "B"}', "B", "near"),
        ('```json\n{"choice": " C "}\n```', "C", ""),
        ('{"choice": "fetch mug_D"}', "D", ""),
        ('<think>{"choice": "A"}? {no}</think>\n{"choice": "B"}', "B", ""),
        ('Sure: {"reason": "a {brace}", "choice": "A"} ok', "A", "a {brace}"),
    ],
)
def test_json_is_read(text: str, letter: str, reason: str) -> None:
    choice, why = read("json", answered(text), MENU, OPTIONS)
    assert (choice.letter, why) == (letter, reason)


@pytest.mark.parametrize(
    "text",
    ["B", "{}", '{"choice": 2}', '{"choice": "E"}', '{"choice": "b"', '["B"]', '{"choice": ["B"]}', "{" * 5000, "null"],
)
def test_other_json_is_unreadable(text: str) -> None:
    with pytest.raises(UnreadableError):
        read("json", answered(text), MENU, OPTIONS)


def test_a_refusal_is_unreadable_whatever_it_says() -> None:
    with pytest.raises(UnreadableError, match="refused"):
        read("letter", answered("Answer: B", refused=True), MENU, OPTIONS)


@pytest.mark.parametrize(
    ("candidates", "letter"),
    [
        ((("A", math.log(0.3)), (" B", math.log(0.2)), ("B", math.log(0.15)), ("The", math.log(0.35))), "B"),
        ((("A", math.log(0.3)), (" B", math.log(0.2)), ("B", math.log(0.05))), "A"),
        ((("E", -0.1), ("D", -9.0)), "D"),
    ],
)
def test_the_likeliest_letter_is_with_and_without_a_space(candidates: Any, letter: str) -> None:
    assert read("logprob", answered("", candidates=candidates), MENU, OPTIONS)[0].letter == letter


def test_without_any_letter_the_likeliest_is_unreadable() -> None:
    with pytest.raises(UnreadableError):
        read("logprob", answered("", candidates=(("The", -0.1), ("Z", -1.0))), MENU, OPTIONS)


def test_a_body_is_read() -> None:
    tops = [{"token": "A", "logprob": -0.5}, {"token": "B", "logprob": float("nan")}, {"token": "C", "logprob": 2.0}]
    body = {
        "choices": [
            {"message": {"content": "hm"}, "finish_reason": "length", "logprobs": {"content": [{"top_logprobs": tops}]}}
        ],
        "usage": {"prompt_tokens": 800, "completion_tokens": 40},
    }
    reply = reply_of(body, 1.5, "a prompt")
    assert reply == Reply("hm", False, True, (("A", -0.5),), 800, 40, 1.5)
    filtered = {"choices": [{"message": {"content": None}, "finish_reason": "content_filter"}]}
    assert reply_of(filtered, 0.0, "one two").refused and reply_of(filtered, 0.0, "one two").prompt_tokens == 2


@pytest.mark.parametrize("told", [-1, 10**12, "many", True, None, 3.5])
def test_numbers_of_tokens_that_cannot_be_are_estimated(told: Any) -> None:
    body = {"choices": [{"message": {"content": "four words of text"}}], "usage": {"completion_tokens": told}}
    assert reply_of(body, 0.0, "").answer_tokens == 4


@pytest.mark.parametrize(
    "body", [{}, {"choices": []}, {"choices": [3]}, {"choices": [{"message": None}]}, {"choices": 1}]
)
def test_bodies_without_a_message_are_unreadable(body: Any) -> None:
    with pytest.raises(UnreadableError, match="must have choices"):
        reply_of(body, 0.0, "")


def test_requests_name_the_letters_on_offer() -> None:
    form = request_of("json", MENU, 99, "max_completion_tokens")
    schema = form["response_format"]["json_schema"]["schema"]
    assert schema["properties"]["choice"]["enum"] == ["A", "B", "C", "D"] and form["max_completion_tokens"] == 99
    assert set(schema["required"]) == set(schema["properties"]) and schema["additionalProperties"] is False
    assert request_of("logprob", MENU, 99, "max_tokens")["max_tokens"] == 1
    assert request_of("letter", MENU, 99, "max_tokens") == {"max_tokens": 99}


@pytest.mark.parametrize(
    ("text", "tokens"), [("", 0), ("one two", 2), ("extraordinarily", 3), ("12345", 2), ('["mug_1",2.5]', 9)]
)
def test_tokens_are_estimated(text: str, tokens: int) -> None:
    assert estimate(text) == tokens
