"""Budgets end an episode before the call that would go beyond them."""

from __future__ import annotations

from typing import Any

import pytest

from hazard_ms.agents.llm.asking import Budget, Counts, SpentError
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.skills.decision import Action
from tests.agents.llm.conftest import Ground, Made
from tests.worlds.playground import play


def test_calls_end_with_the_budget(llm: Made, server: ScriptedServer) -> None:
    player = llm(most_calls=2)
    taken = play(player, Ground())
    assert taken[-1] == Action("stop") and player.ending == "budget" and "2 calls" in str(player.note)
    assert player.counters["calls"] == server.calls == 2
    play(player, Ground(), most=1)
    assert player.ending == "stopped", "the next episode has a budget of its own"


@pytest.mark.parametrize("limit", [{"most_tokens": 1}, {"most_cost": 1e-9, "price_out": 2.0}])
def test_tokens_and_cost_end_it_too(llm: Made, limit: dict[str, Any]) -> None:
    player = llm(**limit)
    play(player, Ground())
    assert player.ending == "budget" and player.counters["calls"] == 1


def test_cost_is_that_of_the_tokens() -> None:
    """A million read at 0.5 USD and half a million written at 4 USD."""
    budget = Budget(cost=3.0, price_in=0.5, price_out=4.0)
    counts = Counts(tokens_in=1_000_000, tokens_out=500_000)
    assert budget.spent(counts) == 2.5
    budget.check(counts)
    with pytest.raises(SpentError, match="3 USD"):
        budget.check(Counts(tokens_in=2_000_000, tokens_out=500_000))


def test_no_budget_is_no_limit() -> None:
    Budget().check(Counts(calls=10**6, tokens_in=10**9))
