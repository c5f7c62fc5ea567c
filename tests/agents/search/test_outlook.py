"""What the planner's problem says of the places to search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.outlook import OVERLOOKED, Outlook, Weights, outlook, skill_frames
from tests.worlds.playground import Playground, brief

VALUES = {"known": 1.0, "unseen_0": 5.0, "unseen_1": 5.0}
PLACES = {"table": (2.5, 0.0), "known": (-2.8, 0.0), "unseen_0": (8.0, 8.0), "unseen_1": (9.0, 8.0)}


def believed(looks: bool) -> Outlook:
    """What lies ahead of an agent, with a detector or without, that knows one of three targets."""
    ground = Playground(PLACES, VALUES)
    ground.look()
    told = replace(brief(), looks=looks)
    return outlook(told, ground.decision(), Memory(0), Weights(), give_up=4)


def test_with_a_detector_a_search_is_worth_less_and_takes_less_time() -> None:
    """Of what a look should show, a share is not told of; what is not found needs not be fetched either."""
    plain, detected = believed(False), believed(True)
    places = len(plain.targets)
    assert plain.lookouts and plain.lookouts == detected.lookouts
    assert plain.problem.values[:places] == detected.problem.values[:places]
    values = np.array([each.problem.values[places:] for each in (plain, detected)], float)
    assert values[1] == pytest.approx((1.0 - OVERLOOKED) * values[0])
    fetches = (
        np.array([each.problem.pick[places:] for each in (plain, detected)], float) - skill_frames("fetch").explore
    )
    assert fetches[0].min() > 0.0 and fetches[1] == pytest.approx((1.0 - OVERLOOKED) * fetches[0])
