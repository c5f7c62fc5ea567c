"""The scene of an episode: of its seed, or the one that was asked for, and for how many episodes it stays."""

from __future__ import annotations

import pytest

from hazard_ms.scenes.choice import SceneTurns, by_name, by_seed

NAMES = ("kitchen_a/00", "kitchen_a/01", "kitchen_a/02")


def test_a_seed_chooses_the_scene_of_its_number_and_begins_again_after_the_last() -> None:
    assert by_seed([0, 1, 2, 3, 302], NAMES) == [NAMES[0], NAMES[1], NAMES[2], NAMES[0], NAMES[2]]


def test_one_name_is_for_all_environments_and_a_list_has_one_for_each() -> None:
    assert by_name(NAMES[1], NAMES, 2) == [NAMES[1]] * 2
    assert by_name([NAMES[2], NAMES[0]], NAMES, 2) == [NAMES[2], NAMES[0]]
    for bad in ([NAMES[0]], [*NAMES], 7, None):
        with pytest.raises(ValueError, match="must be a scene's name or a list of 2 names, got"):
            by_name(bad, NAMES, 2)


def test_turns_are_counted_from_the_last_seed() -> None:
    turns = SceneTurns(3)
    assert [turns.next(seeded) for seeded in (True, False, False, False, False)] == [False, False, False, True, False]
    assert [turns.next(seeded) for seeded in (True, False, False, False)] == [False, False, False, True]
    never = SceneTurns(0)
    assert not any(never.next(False) for _ in range(5))
