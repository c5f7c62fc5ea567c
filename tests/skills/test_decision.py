"""What a decision says of the last action."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Result
from tests.worlds.playground import Playground


@pytest.mark.parametrize(
    ("action", "worked", "name"),
    [
        (Action(WALK_TO, "a"), True, "a"),
        (Action(WALK_TO, "a"), False, None),
        (Action(PICK_UP, "a"), True, None),
        (Action(EXPLORE), True, None),
    ],
)
def test_it_knows_what_was_just_walked_up_to(action: Action, worked: bool, name: str | None) -> None:
    first = Playground({"a": (2.0, 0.0)}, {"a": 1.0}).decision()
    assert first.walked_up_to is None
    assert replace(first, last_action=action, last_result=Result(worked, "", 10)).walked_up_to == name
