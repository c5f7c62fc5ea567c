"""What the table of an evaluation says of language models and of clocks."""

from __future__ import annotations

import dataclasses

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.options import SweepOptions
from hazard_ms.evaluation.report import model_line, title
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult

FATES = (Fate("pen_1", "pen", 1.0, False, False),)
COUNTS = {"decisions": 20, "fallbacks": 1, "calls": 22, "lost": 2, "tokens_in": 9000, "tokens_out": 400, "cost": 0.25}
PLAIN = EpisodeResult("E", "llm", 0, "s", {}, 100, 1500, "time", FATES, (), "", counters=COUNTS)


def test_a_model_with_few_fallbacks_is_not_marked() -> None:
    """Two episodes: 2 of 40 decisions are 5 %, which is the most."""
    line = model_line("llm", [PLAIN, PLAIN])
    assert line == (
        "llm: asked for 40 decisions, 5.0 % of them taken in its place; 44 calls, 4 without an answer; "
        "18000 tokens read, 800 written; 0.50 USD"
    )


def test_a_model_with_many_fallbacks_is_marked() -> None:
    more = dataclasses.replace(PLAIN, counters={**COUNTS, "fallbacks": 2})
    assert "7.5 % of them taken in its place: NOT THE MODEL'S OWN SCORE" in model_line("llm", [PLAIN, more])


def test_other_agents_have_no_such_line() -> None:
    assert model_line("greedy", [dataclasses.replace(PLAIN, counters={})]) == ""


def test_by_a_clock_the_time_of_decisions_is_told() -> None:
    """Thinking took 38 of 100 frames in one decision and none in the other, of 100: 19 %."""
    decisions = (
        DecisionRecord(0, "walk_to", "pen_1", True, "", 62, waited=38, thought=1.26),
        DecisionRecord(100, "pick_up", "pen_1", True, "", 100),
    )
    timed = dataclasses.replace(PLAIN, counters={}, decisions=decisions, clock="tokens")
    assert model_line("llm", [timed]) == "llm: 0.63 s a decision, 19.0 % of the frames"
    assert "clock tokens" in title(SweepOptions(clock="tokens")) and "clock" not in title(SweepOptions())
