"""An agent that plays several episodes begins each as if it were its first."""

from __future__ import annotations

import pytest

from hazard_ms.agents.base import agent
from tests.worlds.playground import Playground, play

THINGS = {"mug": (2.0, 0.0), "book": (0.0, 2.5), "stone": (1.0, -2.0), "far": (6.0, 0.0)}
VALUES = {"mug": 1.0, "book": 5.0, "stone": 5.0, "far": 1.0}


def ground() -> Playground:
    """One thing cannot be walked to and one slips out of the hand, so that there is much to remember."""
    return Playground(THINGS, VALUES, broken=frozenset({"stone"}), slippery=frozenset({"book"}))


@pytest.mark.parametrize("name", ["greedy", "random"])
def test_the_second_episode_is_played_like_the_first(name: str) -> None:
    player = agent(name)
    first = play(player, ground())
    assert play(player, ground()) == first
    assert len(first) > 5
