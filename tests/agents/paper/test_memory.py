"""The worth of targets to the paper's agents, and the levels of hazards that they remember."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.paper.memory import Memory, Worth, changing_value, predicted_value, wetted_value
from hazard_ms.sensing.target_table import Target
from tests.worlds.playground import Playground, brief

BOTTLE = Target(0, "bottle", "bottle", 5.0, True, False, 300.0)
NAN = float("nan")


@pytest.mark.parametrize(
    ("hazard", "before", "last", "share"),
    [
        ("fire", 100.0, 190.0, 1.0),  # 280 C next
        ("fire", 100.0, 210.0, 0.5),  # 320 C next
        ("fire", 310.0, 310.0, 0.5),
        ("fire", 330.0, 310.0, 1.0),  # cools to 290 C
        ("fire", NAN, NAN, 1.0),
        ("flood", 0.0, 0.004, 1.0),  # 0.008 m next
        ("flood", 0.0, 0.006, 0.5),  # 0.012 m next
        ("flood", 0.02, 0.02, 0.5),
        ("wind", 0.0, 1e9, 1.0),  # damages nothing
    ],
)
def test_a_target_counts_half_if_its_last_change_repeated_damages_it(
    hazard: str, before: float, last: float, share: float
) -> None:
    """It ignites at 300 C; in water it is lost at 0.01 m."""
    assert predicted_value(BOTTLE, {hazard: (before, last)}) == 5.0 * share


def test_what_cannot_be_damaged_keeps_its_value() -> None:
    wet, hot = {"flood": (1.0, 1.0)}, {"fire": (900.0, 900.0)}
    assert predicted_value(replace(BOTTLE, waterproof=True), wet) == 5.0
    assert predicted_value(replace(BOTTLE, flammable=False), hot) == 5.0
    assert predicted_value(replace(BOTTLE, waterproof=True), {**wet, **hot}) == 2.5
    assert predicted_value(BOTTLE, {}) == 5.0


def test_where_only_water_counts_a_fire_changes_no_value() -> None:
    hot, wet, dry = {"fire": (310.0, 310.0)}, {"flood": (0.0, 0.006)}, {"flood": (0.0, 0.004)}  # 0.012 and 0.008 m next
    assert [wetted_value(BOTTLE, levels) for levels in (hot, dry, wet, {**hot, **wet})] == [5.0, 5.0, 2.5, 2.5]
    assert wetted_value(replace(BOTTLE, waterproof=True), wet) == 5.0


@pytest.mark.parametrize(
    ("hazard", "before", "last", "factor"),
    [
        ("fire", 20.0, 20.9, 1.0),
        ("fire", 20.0, 21.5, 2.0),
        ("fire", 21.5, 20.0, 2.0),
        ("flood", 0.0, 0.09, 1.0),
        ("flood", 0.0, 0.11, 2.0),
        ("flood", NAN, 0.11, 1.0),
        ("wind", 0.0, 9.0, 1.0),
    ],
)
def test_a_target_counts_twice_where_a_level_changes(hazard: str, before: float, last: float, factor: float) -> None:
    """By more than 1 C or 0.1 m between the last two sightings; whether it is damaged then does not matter."""
    assert changing_value(BOTTLE, {hazard: (before, last)}) == 5.0 * factor


def worth_over(sightings: list[tuple[int, float]], worth: Worth) -> list[float]:
    """The worth of a bottle at decisions at which it was last seen in a frame with a level."""
    ground = Playground({"table": (9.0, 9.0), "bottle": (1.0, 0.0)}, {"bottle": 5.0})
    ground.look()
    memory, made = Memory(brief()), []
    for frame, level in sightings:
        seen = ground.map.objects[1]
        ground.remember(1, replace(seen, frame=frame, levels=(level,), history=((frame, (level,)),)))
        view = memory.view(ground.decision())
        made.append(memory.values(view, worth)[1])
    return made


def test_levels_are_compared_between_the_last_two_sightings_at_decisions() -> None:
    """100, 180 (260 next), not seen, seen again at 240 (300 next), 275 (310 next)."""
    seen = [(0, 100.0), (60, 180.0), (60, 180.0), (300, 240.0), (360, 275.0)]
    assert worth_over(seen, predicted_value) == [5.0, 5.0, 5.0, 5.0, 2.5]
    assert worth_over([(0, 100.0), (60, 100.5), (60, 100.5), (90, 300.0)], changing_value) == [5.0, 5.0, 5.0, 10.0]


def test_a_change_is_remembered_while_a_target_is_out_of_sight() -> None:
    assert worth_over([(0, 20.0), (60, 25.0), (60, 25.0), (60, 25.0)], changing_value) == [5.0, 10.0, 10.0, 10.0]


def test_levels_are_told_apart_by_the_hazard() -> None:
    """In a flood 30 is a depth of water, not a temperature."""
    ground = Playground({"bottle": (1.0, 0.0)}, {"bottle": 5.0})
    ground.look()
    ground.remember(0, replace(ground.map.objects[0], levels=(30.0,)))
    for task, value in (("HazardFlood-v1", 2.5), ("HazardFire-v1", 5.0), ("HazardWind-v1", 5.0)):
        memory = Memory(brief(task))
        assert memory.values(memory.view(ground.decision()), predicted_value) == (1.0, value)


def test_only_targets_have_a_worth() -> None:
    ground = Playground({"cart": (1.0, 0.0), "b": (2.0, 0.0), "a": (0.0, 1.0)}, {"a": 5.0, "b": 1.0}, carts=("cart",))
    ground.look()
    memory = Memory(brief("HazardWind-v1"))
    view = memory.view(ground.decision())
    assert view.names == ("", "b", "a", "cart") and memory.values(view, predicted_value) == (1.0, 1.0, 5.0, 1.0)
