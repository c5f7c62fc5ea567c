"""What words ask for that are told to a command of results/."""

from __future__ import annotations

import pytest

from results.tables import asked

AGENTS = ("greedy", "planner")


def test_words_name_agents_of_tasks_and_how_many_scenes() -> None:
    every = [(task, agent) for task in ("fire", "flood", "wind") for agent in AGENTS]
    assert asked([], AGENTS, 25) == (every, 25)
    assert asked(["3"], AGENTS, 25) == (every, 3)
    assert asked(["wind-planner", "fire-greedy"], AGENTS, 25) == ([("wind", "planner"), ("fire", "greedy")], 25)
    assert asked(["wind-planner", "4"], AGENTS, 25) == ([("wind", "planner")], 4)
    assert asked(["tables"], AGENTS, 25) == ([], 25)


def test_a_name_that_is_none_is_an_error() -> None:
    with pytest.raises(ValueError, match="wind-plannr"):
        asked(["wind-plannr", "4"], AGENTS, 25)
