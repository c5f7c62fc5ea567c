"""The order of numbered names."""

from __future__ import annotations

import random

import pytest

from hazard_ms.spec.names import natural


@pytest.mark.parametrize(
    "names",
    [
        ["scene-2", "scene-10"],
        ["scene2", "scene10", "scene10b"],
        ["room_1-9", "room_1-10", "room_2-1", "room_10-1"],
        ["9", "10", "a"],
        ["a_01", "a_1", "a_2"],
        ["²", "³"],
        ["x" + "9" * 5000, "x9"],
    ],
)
def test_numbers_in_names_count_as_numbers(names: list[str]) -> None:
    shuffled = random.Random(0).sample(names, len(names))
    assert sorted(shuffled, key=natural) == sorted(reversed(shuffled), key=natural) == names
